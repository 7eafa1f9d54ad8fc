"""Compile all kernels before they are needed, and tell how long that took.

Numba compiles a kernel when it is first called, and keeps it beside the sources, in the user's own cache, or in
``NUMBA_CACHE_DIR``. The only module of the core that looks at a clock and at files: neither has a part in a verdict.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from stability_core.compiled import NOT_KEPT
from stability_core.frame import observe
from stability_core.script import ScriptedExtension, ScriptedPort, play_script

_LOG = logging.getLogger("stability_core")
_SILENT_S = 2.0
"""Time [s] from which compiling is worth a line."""
_COMPILED: set[str] = set()
"""Policies that are compiled in this process."""


def compile_policy(policy: str, extension_of: Callable[[ScriptedPort], ScriptedExtension]) -> float:
    """Compile all that a policy runs, once in a process; returns the seconds it took.

    Args:
        policy: its name.
        extension_of: makes an extension of this policy that watches a port.
    """
    if policy in _COMPILED:
        return 0.0
    _COMPILED.add(policy)
    begin = time.perf_counter()
    if NOT_KEPT:
        _LOG.warning("compiled kernels cannot be kept: set NUMBA_CACHE_DIR to a folder that can be written")
    elif not _is_kept(observe):
        _LOG.warning("compiling for policy %r: a minute or two, once per version", policy)
    port = ScriptedPort()
    play_script(extension_of(port), port)
    seconds = time.perf_counter() - begin
    if seconds > _SILENT_S:
        _LOG.warning("compiled for policy %r in %.0f s, once per version", policy, seconds)
    return seconds


def _is_kept(kernel: Any) -> bool:
    """Tell whether a kernel lies compiled in the cache on disk, of this version or of one before."""
    folder = Path(kernel.stats.cache_path or "")
    return any(folder.glob(f"*.{kernel.py_func.__qualname__}-*.nbi"))
