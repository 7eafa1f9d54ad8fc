"""Compile all kernels before their first use, and log a long compilation.

Numba compiles a kernel on its first call. Numba's cache is beside the sources, in the user's cache folder, or in
``NUMBA_CACHE_DIR``. Only this module of the core reads a clock and files. Neither the clock nor a file affects a
verdict.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from stability_core.compiled import KEPT, NOT_KEPT
from stability_core.frame import observe
from stability_core.script import ScriptedExtension, ScriptedPort, play_script

_LOG = logging.getLogger("stability_core")
_SILENT_S = 2.0
"""Time [s] of ``compile_policy`` above which the function logs this time, because a user notices a longer pause."""
_COMPILED: set[str] = set()
"""Names of the policies whose kernels this process has compiled."""


def compile_policy(policy: str, extension_of: Callable[[ScriptedPort], ScriptedExtension]) -> float:
    """Compile all kernels of a policy, or read them from Numba's cache, and return the time [s].

    A further call for the same policy in the same process only returns 0.

    Args:
        policy: name of the policy.
        extension_of: function that returns an extension of this policy for a port.
    """
    if policy in _COMPILED:
        return 0.0
    _COMPILED.add(policy)
    begin = time.perf_counter()
    if NOT_KEPT:
        _LOG.warning(
            "Numba cannot cache compiled kernels: set NUMBA_CACHE_DIR to a folder in which you can write files"
        )
    elif not _is_kept(observe):
        _LOG.warning("compiling the kernels of policy %r: one to two minutes, once per version", policy)
    try:
        _play(extension_of)
    except (ImportError, AttributeError):  # a cached kernel of an earlier version names a removed module or class
        _forget_kept()
        _play(extension_of)
    seconds = time.perf_counter() - begin
    if seconds > _SILENT_S:
        _LOG.warning("compiled the kernels of policy %r in %.0f s, or read them from Numba's cache", policy, seconds)
    return seconds


def _play(extension_of: Callable[[ScriptedPort], ScriptedExtension]) -> None:
    port = ScriptedPort()
    play_script(extension_of(port), port)


def _is_kept(kernel: Any) -> bool:
    """Return True if the cache on disk contains ``kernel``, of this version or an earlier version."""
    folder = Path(kernel.stats.cache_path or "")
    return any(folder.glob(f"*.{kernel.py_func.__qualname__}-*.nbi"))


def _forget_kept() -> None:
    """Delete the index file of every kernel in the cache on disk, so that Numba compiles the kernels again."""
    for kernel in KEPT:
        for index in Path(kernel.stats.cache_path).glob(f"*.{kernel.py_func.__qualname__}-*.nbi"):
            index.unlink(missing_ok=True)
