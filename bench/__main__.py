"""The entry point of ``uv run -m bench COMMAND``."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # while modules load, an interrupt ends the process without a traceback

from bench.cli.app import app  # noqa: E402
from bench.cli.completion import complete_if_asked  # noqa: E402

if __name__ == "__main__":
    complete_if_asked(app)
    app()
