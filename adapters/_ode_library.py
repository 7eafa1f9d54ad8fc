"""ODE's C API: Debian's library in double precision, else the library of Panda3D's wheel in single precision.

Python calls the functions of ``lib``, a ctypes library with declared types. Compiled code calls the same functions
through the result of ``c_call``. Handles are addresses, as integers.
"""

from __future__ import annotations

import ctypes
import importlib.metadata
import importlib.util
from ctypes import POINTER, c_int, c_size_t, c_ulong
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from adapters._ode_knobs import KNOBS, WHOLE_NUMBERS

_DEBIAN = "libode.so.8"
_PANDA = "libpandaode.*"
"""Pattern of the file name of Panda3D's library, whose ending depends on the platform."""


def _opened() -> tuple[ctypes.CDLL, str]:
    """Return the library with its origin: a file name, or the name and version of a package.

    Raises:
        ImportError: if neither library is installed, or Panda3D's library does not export ODE's functions.
    """
    try:
        library = ctypes.CDLL(_DEBIAN)
    except OSError:
        return _opened_panda()
    mapped = Path("/proc/self/maps").read_text(encoding="utf-8").splitlines()
    return library, next(Path(line.split()[-1]).name for line in mapped if _DEBIAN in line)


def _opened_panda() -> tuple[ctypes.CDLL, str]:
    spec = importlib.util.find_spec("panda3d")
    folders = (spec.submodule_search_locations if spec else None) or ()
    files = [file for folder in folders for file in sorted(Path(folder).glob(_PANDA))]
    if not files:
        raise ImportError(
            f"ODE needs the library {_DEBIAN}, or {_PANDA} of the package 'panda3d', but neither is installed; install "
            f"{_DEBIAN}, or the version of panda3d in uv.lock (uv sync --group ode)"
        )
    library = ctypes.CDLL(str(files[0]))
    if not hasattr(library, "dWorldCreate"):
        raise ImportError(f"{files[0]} must export ODE's functions, but does not on this platform; install {_DEBIAN}")
    return library, f"panda3d {importlib.metadata.version('panda3d')}"


lib, _origin = _opened()
lib.dGetConfiguration.restype = ctypes.c_char_p
_is_double = b"ODE_double_precision" in lib.dGetConfiguration()
VERSION = f"{_origin}, {'double' if _is_double else 'single'} precision"
"""Origin and precision of the library, because ODE does not report its own version."""

REAL = np.dtype(np.float64 if _is_double else np.float32)
"""Type of ODE's numbers (``dReal``)."""
_real: Any = ctypes.c_double if _is_double else ctypes.c_float
_handle, _address = c_size_t, c_size_t

_SURFACE = np.dtype([("mode", "i4"), ("mu", REAL), ("others", REAL, 13)], align=True)
_CONTACT_GEOM = np.dtype(
    [("position", REAL, 4), ("normal", REAL, 4), ("depth", REAL), ("geoms", np.uintp, 2), ("sides", "i4", 2)],
    align=True,
)
CONTACT = np.dtype([("surface", _SURFACE), ("geom", _CONTACT_GEOM), ("friction_direction", REAL, 4)], align=True)
"""ODE's structure ``dContact``: a contact point and its surface."""
FEEDBACK = np.dtype([("force_1", REAL, 4), ("torque_1", REAL, 4), ("force_2", REAL, 4), ("torque_2", REAL, 4)])
"""ODE's structure ``dJointFeedback``: forces and torques of a joint on its two bodies."""


class Mass(ctypes.Structure):
    """ODE's structure ``dMass``: mass, centre and inertia."""

    _fields_ = (("mass", _real), ("center", _real * 4), ("inertia", _real * 12))


QUATERNION: Any = _real * 4
"""ODE's ``dQuaternion``: w, x, y, z."""
_VECTOR = (_real, _real, _real)
_TYPES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "dInitODE": (None, ()),
    "dRandSetSeed": (None, (c_ulong,)),
    "dRandGetSeed": (c_ulong, ()),
    "dWorldCreate": (_handle, ()),
    "dWorldDestroy": (None, (_handle,)),
    "dWorldSetGravity": (None, (_handle, *_VECTOR)),
    "dWorldQuickStep": (c_int, (_handle, _real)),
    "dBodyCreate": (_handle, (_handle,)),
    "dBodyDestroy": (None, (_handle,)),
    "dBodySetMass": (None, (_handle, POINTER(Mass))),
    "dBodySetKinematic": (None, (_handle,)),
    "dBodySetPosition": (None, (_handle, *_VECTOR)),
    "dBodySetQuaternion": (None, (_handle, QUATERNION)),
    "dBodySetLinearVel": (None, (_handle, *_VECTOR)),
    "dBodySetAngularVel": (None, (_handle, *_VECTOR)),
    "dBodyGetPosition": (_address, (_handle,)),
    "dBodyGetQuaternion": (_address, (_handle,)),
    "dBodyGetLinearVel": (_address, (_handle,)),
    "dBodyGetAngularVel": (_address, (_handle,)),
    "dBodyAddForce": (None, (_handle, *_VECTOR)),
    "dBodyEnable": (None, (_handle,)),
    "dBodyDisable": (None, (_handle,)),
    "dBodyIsEnabled": (c_int, (_handle,)),
    "dBodyGetMass": (None, (_handle, POINTER(Mass))),
    "dMassSetBoxTotal": (None, (POINTER(Mass), _real, *_VECTOR)),
    "dSimpleSpaceCreate": (_handle, (_handle,)),
    "dSpaceDestroy": (None, (_handle,)),
    "dSpaceCollide": (None, (_handle, _address, _address)),
    "dCreateBox": (_handle, (_handle, *_VECTOR)),
    "dGeomDestroy": (None, (_handle,)),
    "dGeomSetBody": (None, (_handle, _handle)),
    "dGeomSetData": (None, (_handle, c_size_t)),
    "dGeomSetPosition": (None, (_handle, *_VECTOR)),
    "dGeomSetQuaternion": (None, (_handle, QUATERNION)),
    "dJointGroupCreate": (_handle, (c_int,)),
    "dJointGroupDestroy": (None, (_handle,)),
    "dJointGroupEmpty": (None, (_handle,)),
}
for _name, (_result, _arguments) in _TYPES.items():
    _function = getattr(lib, _name)
    _function.restype, _function.argtypes = _result, _arguments
lib.dInitODE()

for _name in KNOBS:
    _number = c_int if _name in WHOLE_NUMBERS else _real
    _set, _get = getattr(lib, f"dWorldSet{_name}"), getattr(lib, f"dWorldGet{_name}")
    _set.restype, _set.argtypes = None, (_handle, _number)
    _get.restype, _get.argtypes = _number, (_handle,)


def reals_at(address: int, count: int) -> npt.NDArray[Any]:
    """Return a view of ``count`` numbers in ODE's own memory, shape (count,)."""
    memory: Any = (_real * count).from_address(address)
    return np.ctypeslib.as_array(memory)


def address_of(name: str) -> int:
    """Return the address of one of ODE's functions, for compiled code."""
    address: int | None = ctypes.cast(getattr(lib, name), ctypes.c_void_p).value
    assert address is not None, "a function that was found has an address"
    return address


def c_call(signature: Any) -> Any:
    """Return a function that compiled code calls with the address of a C function and a tuple of its arguments.

    The function does not use Numba's own ways to call a C function, for two reasons. A first-class function costs 30 us
    as an argument, and Numba does not cache compiled code that names a C function of ctypes. Clear Numba's cache after
    a change of this function, because Numba does not detect the change.

    Args:
        signature: signature of the C function, in Numba's types; handles and addresses are ``intp``.
    """

    @intrinsic
    def call(typing: Any, address: Any, arguments: Any) -> Any:  # noqa: ARG001 - Numba reads their names
        def generate(context: Any, builder: Any, _: Any, values: Any) -> Any:
            taken = [context.get_value_type(kind) for kind in signature.args]
            returned = (
                ir.VoidType() if signature.return_type == types.void else context.get_value_type(signature.return_type)
            )
            function = builder.inttoptr(values[0], ir.FunctionType(returned, taken).as_pointer())
            result = builder.call(function, [builder.extract_value(values[1], place) for place in range(len(taken))])
            return context.get_dummy_value() if signature.return_type == types.void else result

        taken_all = types.Tuple(signature.args)  # type: ignore[no-untyped-call]
        return signature.return_type(types.intp, taken_all), generate

    return call
