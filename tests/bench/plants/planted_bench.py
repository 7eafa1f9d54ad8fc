"""The command line of the suite with a regression planted in it, that of the module that PLANT names.

Every trial's process runs this file's upper part too. Changed code has another digest.
"""

import importlib
import os

PLANT = os.environ.get("PLANT")
if PLANT:
    importlib.import_module(PLANT)

if __name__ == "__main__":
    from bench import command_line
    from bench.environment import describe

    if PLANT:
        command_line.describe = lambda engines: describe(engines) | {"sources": PLANT}
    command_line.app()
