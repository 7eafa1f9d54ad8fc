"""The entry point of ``uv run python -m bench.publishing``: see ``publish``."""

import typer

from bench.publishing.publish import main

if __name__ == "__main__":
    typer.run(main)
