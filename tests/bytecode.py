"""Keep the bytecode of modules where the environment forbids it, as containers often do (PYTHONDONTWRITEBYTECODE).

The tests start dozens of processes, and each imports up to 1,800 modules. Without bytecode each process compiles them
anew, which takes longer than most tests. The bytecode is kept beside the core's kernels, so that nothing is written
into the checkout or the environment. A prefix that the user chose stays.
"""

import os
import sys
from pathlib import Path

if sys.dont_write_bytecode and sys.pycache_prefix is None:
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    sys.pycache_prefix = os.environ["PYTHONPYCACHEPREFIX"] = str(home / "stillstack" / "bytecode")
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # for the processes that tests start
