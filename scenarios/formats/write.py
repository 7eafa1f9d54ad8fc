"""Text of a scene in the format of another simulator."""

from __future__ import annotations

from scenarios.model import Scene

FORMATS = {"mjcf": ".xml", "urdf": ".urdf", "usd": ".usda"}
"""Suffix of a file of each format."""


def scene_text(scene: Scene, name: str) -> str:
    """Return a scene as the text of a file in the format ``name``, a key of ``FORMATS``.

    Raises:
        ExportRefusedError: if the format cannot hold a body of the scene, or OpenUSD is missing for ``usd``; the
            message names the fix.
    """
    if name == "mjcf":
        from scenarios.formats.mjcf_export import to_mjcf

        return to_mjcf(scene)
    if name == "urdf":
        from scenarios.formats.urdf_export import to_urdf

        return to_urdf(scene)
    from scenarios.formats.usd_export import to_usd  # here, because OpenUSD is in an optional group

    return to_usd(scene)
