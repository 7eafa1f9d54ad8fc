"""The folders of the core's compiled kernels: a folder for each version of the core's sources.

Numba's cache detects a change of the kernel's own file, but not a change of an inlined kernel in another file. After an
update of the checkout, Numba would therefore use stale kernels. A folder whose name contains the digest of the core's
sources prevents the use of stale kernels. NumPy 1, which an old engine may need, has folders of its own, because NumPy
1 cannot load kernels from NumPy 2.
"""

from __future__ import annotations

import importlib.metadata
import os
import tempfile
from pathlib import Path

from bench.machine.source_digest import ROOT, sources_digest

_VARIABLE = "NUMBA_CACHE_DIR"
_CORE = ROOT / "stability_core"


def keep_kernels_apart() -> None:
    """Set Numba's cache folder to the folder for this version of the core, unless the user has set a cache folder.

    The function replaces the choice of a parent process, because this process may have another release of NumPy. If
    the function cannot create the folder, it creates a temporary folder. Call this function before the first import of
    Numba.
    """
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    kernels = home / "stillstack" / "kernels"
    if _VARIABLE in os.environ and Path(os.environ[_VARIABLE]).parent != kernels:
        return
    older = "-numpy1" if importlib.metadata.version("numpy").startswith("1.") else ""
    folder = kernels / (sources_digest([_CORE]) + older)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # the home is read-only: use a temporary folder, so that each session compiles
        folder = Path(tempfile.mkdtemp(prefix="stillstack-kernels-"))
    os.environ[_VARIABLE] = str(folder)
