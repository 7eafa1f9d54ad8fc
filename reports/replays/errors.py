"""The error of pictures, videos and exports."""

from __future__ import annotations


class ExportError(ValueError):
    """A failure to make a picture, video or export; the message names the reason and, if known, the fix."""
