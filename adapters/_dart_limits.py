"""DART's limit on the number of contacts: the Python interface reads the limit, but has no call that sets it.

In dartpy 6.20 ``getCollisionOption`` returns a copy, so that an assignment to its fields changes nothing. The library
exports the C++ method of the same name, which returns the solver's own option. This module writes the field of that
option. The module compares the old and the new value with the values in dartpy, so that another memory layout raises an
error.
"""

from __future__ import annotations

import ctypes
from typing import Any

import dartpy

SHIPPED = 1000
"""DART's shipped limit on the number of contacts of a world."""
PER_PAIR = 8
"""Number of contacts allowed per pair of bodies, because the contact area of two faces has at most eight corners."""
_GETTER = "_ZN4dart10constraint16ConstraintSolver18getCollisionOptionEv"
"""Symbol of ``dart::constraint::ConstraintSolver::getCollisionOption()``."""


class _CollisionOption(ctypes.Structure):
    """The first fields of ``dart::collision::CollisionOption``."""

    _fields_ = (("enable_contact", ctypes.c_bool), ("max_num_contacts", ctypes.c_size_t))


def contacts_for(bricks: int) -> int:
    """Return an upper bound of the number of contacts among ``bricks`` bricks and the ground, at least ``SHIPPED``."""
    return max(SHIPPED, PER_PAIR * bricks * (bricks + 1) // 2)


def raise_limit(solver: Any, contacts: int) -> None:
    """Raise the limit of a world's constraint solver to a number of contacts; keep a higher limit.

    Raises:
        NotImplementedError: if this build of dartpy has another memory layout or does not export the method.
    """
    before = solver.getCollisionOption().maxNumContacts
    if before >= contacts:
        return
    option = _option_of(solver)
    if option is None or option.max_num_contacts != before:
        raise NotImplementedError(_refusal(before, contacts))
    option.max_num_contacts = contacts
    if solver.getCollisionOption().maxNumContacts != contacts:
        option.max_num_contacts = before
        raise NotImplementedError(_refusal(before, contacts))


def _option_of(solver: Any) -> _CollisionOption | None:
    """Return the solver's option in DART's memory; None if the library does not export the C++ method."""
    getter = getattr(ctypes.CDLL(dartpy.__file__), _GETTER, None)
    if getter is None:
        return None
    getter.restype, getter.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
    held = ctypes.c_void_p.from_address(id(solver) + object.__basicsize__)  # pybind11 keeps the C++ pointer first
    return _CollisionOption.from_address(getter(held))


def _refusal(before: int, contacts: int) -> str:
    return (
        f"dart: the adapter sets a limit of {contacts} contacts for this scene, but dartpy {dartpy.__version__} keeps "
        f"DART's limit of {before} contacts: install the version of dartpy in uv.lock (uv sync --group engines)"
    )
