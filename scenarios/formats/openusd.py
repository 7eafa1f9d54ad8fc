"""Test for the optional package OpenUSD, and the message for a missing package."""

from __future__ import annotations

import importlib.util


def has_openusd() -> bool:
    """Return whether OpenUSD's Python package is installed."""
    return importlib.util.find_spec("pxr") is not None


MISSING = 'OpenUSD is not installed: run "uv sync --group usd"'
