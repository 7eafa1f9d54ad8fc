"""Blocks of the documents that the adapters write themselves: ``uv run python -m bench.generated`` fills them anew."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from adapters import ENGINES, Profile, profiles
from bench.environment import describe_engine
from bench.sources import ROOT
from reports.capabilities import capability_table
from reports.tables import Table, to_markdown


def capabilities_block() -> str:
    """What the engines show to the core, side by side; without a title."""
    table = capability_table({name: describe_engine(name) for name in ENGINES})
    return _untitled(table)


def profiles_block() -> str:
    """Every profile of every engine: who set it up, and each knob with its reason."""
    return "\n".join(_engine(name) for name in ENGINES)


def _engine(name: str) -> str:
    return "\n".join([f"## {name}\n", *(_profile(profile) for profile in profiles(name).values())])


def _profile(profile: Profile) -> str:
    head = f"**{profile.name}** ({profile.tuned_by}): {profile.description}.\n"
    if not profile.knobs:
        return head
    rows = tuple((f"`{name}`", f"`{knob.value}`", knob.reason) for name, knob in profile.knobs.items())
    return f"{head}\n{_untitled(Table('', ('knob', 'value', 'reason'), rows))}"


def _untitled(table: Table) -> str:
    return to_markdown([table]).partition("\n\n")[2]


BLOCKS: Mapping[str, tuple[str, Callable[[], str]]] = {
    "capabilities": ("README.md", capabilities_block),
    "profiles": ("docs/profiles.md", profiles_block),
}
"""Of each block, the document that it stands in, and what writes it."""


def filled(document: str, block: str, content: str) -> str:
    """The document with ``content`` between the two marks of a block.

    Raises:
        ValueError: if the document has no such marks.
    """
    marks = re.compile(rf"(<!-- begin {block}\b[^>]*-->\n).*?(<!-- end {block} -->)", re.DOTALL)
    if not marks.search(document):
        raise ValueError(f"no block '{block}': mark it with <!-- begin {block} --> and <!-- end {block} -->")
    return marks.sub(lambda found: f"{found[1]}\n{content}\n{found[2]}", document)


def main() -> None:
    """Fill every block anew."""
    for block, (name, write) in BLOCKS.items():
        path = ROOT / name
        path.write_text(filled(path.read_text(encoding="utf-8"), block, write()), encoding="utf-8")


if __name__ == "__main__":
    main()
