"""Command that installs the engines of ``package-lock.json``, in this folder, with the npm of Node's wheel."""

from __future__ import annotations

import os
import subprocess
import sys

from adapters.wasm import FOLDER, INSTALL, node


def main() -> int:
    """Run ``npm ci`` and return its exit status; return 2 if Node is missing."""
    try:
        program = node()
    except ImportError as error:
        sys.stderr.write(f"error: {error}; run '{INSTALL}'\n")
        return 2
    npm = program.parents[1] / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    command = [str(program), str(npm), "ci", "--ignore-scripts", "--no-audit", "--no-fund"]
    path = os.pathsep.join((str(program.parent), os.environ.get("PATH", os.defpath)))
    return subprocess.run(command, cwd=FOLDER, env=os.environ | {"PATH": path}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
