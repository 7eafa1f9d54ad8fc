"""The error of pictures, videos and exports."""

from __future__ import annotations


class ExportError(ValueError):
    """A picture, video or export that cannot be made; the message names the reason and, if known, the fix."""
