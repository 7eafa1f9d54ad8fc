"""The optional package OpenUSD: a test for the package, and the message if the package is missing."""

from __future__ import annotations

import importlib.util


def has_openusd() -> bool:
    """Return whether OpenUSD's Python package is installed."""
    return importlib.util.find_spec("pxr") is not None


MISSING = 'OpenUSD is not installed: run "uv sync --group usd"'
