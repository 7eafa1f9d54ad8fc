"""Removal of terminal control sequences from the text of engines: colours, cursor moves, titles and links."""

from __future__ import annotations

import re

_ESCAPE = re.compile(
    r"""
      (?: \x1b\[ | \x9b ) [0-?]* [ -/]* (?: [@-~] | $ )                                  # CSI: colours, cursor
    | (?: \x1b[\]PX^_] | [\x90\x98\x9d-\x9f] ) [^\x07\x1b\x9c\n]* (?: \x07 | \x1b\\ | \x9c )?  # strings: titles, links
    | \x1b [ -/]* (?: [0-~] | $ )                                                       # other sequences
    """,
    re.VERBOSE | re.MULTILINE,
)
"""Pattern of ECMA-48 control sequences, complete or cut off by the end of a line or of the text."""


def plain_text(text: str) -> str:
    """Remove terminal control sequences, and replace every other unprintable character by U+FFFD.

    Tabs and line feeds stay. Each CR LF or CR becomes a line feed.
    """
    lines = _ESCAPE.sub("", text).replace("\r\n", "\n").replace("\r", "\n")
    return "".join(
        letter if letter.isprintable() or letter in "\n\t" else "\N{REPLACEMENT CHARACTER}" for letter in lines
    )
