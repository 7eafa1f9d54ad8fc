"""The command line of the suite with a regression planted in it, that of the module that PLANT names.

Every trial's process runs this file's upper part too. Changed code has another digest. The page and its pictures, which
no comparison reads, take as long as the trials: they are left out.
"""

import importlib
import os

PLANT = os.environ.get("PLANT")
if PLANT:
    importlib.import_module(PLANT)

if __name__ == "__main__":
    from bench.cli import run
    from bench.cli.app import app
    from bench.machine.environment import describe

    if PLANT:
        run.describe = lambda engines: describe(engines) | {"sources": PLANT}
    run.make_report = lambda _: None
    run.show = lambda _: None
    app()
