"""``uv run -m bench VERB``."""

import signal

signal.signal(signal.SIGINT, signal.SIG_DFL)  # while modules load, an interrupt ends the process without a trace

from bench.cli.app import app  # noqa: E402

if __name__ == "__main__":
    app()
