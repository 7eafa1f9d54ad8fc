"""The page as one file that contains all stills and replays, so that a reader needs no other file."""

from __future__ import annotations

import base64
import html
import io
import json
import re
import zlib
from pathlib import Path
from urllib.parse import unquote

from PIL import Image

from reports.records.atomic import write_atomic

SINGLE = "single.html"
"""Name of the file in the report."""
_STILL_PX = 320
"""Greatest edge of a still [px]: twice its size on the page, so that the still is sharp on dense screens."""
_SCRIPT = re.compile(r'<script src="([\w.-]+)"></script>')
_PLAYER = (Path(__file__).parent / "templates" / "single.html").read_text(encoding="utf-8")


def write_single(page: Path) -> Path:
    """Write ``single.html`` beside a page, with the page's stills and replays inside, and return the new path.

    Args:
        page: ``index.html`` of a report.

    Raises:
        OSError: if the page, or a still or replay of the page, is unreadable.
    """
    text = page.read_text(encoding="utf-8")
    text = re.sub(r'src="(stills/[^"]+)"', lambda found: f'src="{_still(page.parent / _path(found[1]))}"', text)
    replays = sorted(set(re.findall(r'href="(replays/[^"]+)"', text)))
    if replays:
        text = text.replace("</body>", f"{_packed_replays(page.parent, replays)}</body>")
    write_atomic(page.parent / SINGLE, text.encode())
    return page.parent / SINGLE


def _packed_replays(report: Path, links: list[str]) -> str:
    """Return the HTML of a player that contains the compressed replays, and one copy of the scripts of all replays."""
    pages = {link: (report / _path(link)).read_text(encoding="utf-8") for link in links}
    scripts = {name for page in pages.values() for name in _SCRIPT.findall(page)}
    shared = {name: _deflated((report / "replays" / name).read_text(encoding="utf-8")) for name in sorted(scripts)}
    packed = {"pages": {link: _deflated(page) for link, page in pages.items()}, "scripts": shared}
    return _PLAYER.replace("{{ packed }}", json.dumps(packed))


def _path(link: str) -> str:
    return unquote(html.unescape(link))


def _still(path: Path) -> str:
    """Return a still as a data URI, reduced to edges of at most ``_STILL_PX`` pixels."""
    with Image.open(path) as still:
        still.thumbnail((_STILL_PX, _STILL_PX))
        data = io.BytesIO()
        still.save(data, "WEBP", quality=85)
    return f"data:image/webp;base64,{base64.b64encode(data.getvalue()).decode()}"


def _deflated(text: str) -> str:
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()
