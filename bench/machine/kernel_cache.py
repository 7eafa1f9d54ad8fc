"""The folder of the core's compiled kernels: one for each version of the core's sources.

Numba's cache notices a changed file, but not a changed kernel of another file that was inlined: after an update of the
checkout, stale kernels would go on deciding. A folder named after all sources prevents that.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from bench.machine.source_digest import ROOT, sources_digest

_VARIABLE = "NUMBA_CACHE_DIR"
_CORE = ROOT / "stability_core"


def keep_kernels_apart() -> None:
    """Point Numba to this version's folder, unless the user chose one; call it before Numba is imported."""
    if _VARIABLE in os.environ:
        return
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = home / "stillstack" / "kernels" / sources_digest([_CORE])
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: compile in each session rather than fail
        folder = Path(tempfile.mkdtemp(prefix="stillstack-kernels-"))
    os.environ[_VARIABLE] = str(folder)
