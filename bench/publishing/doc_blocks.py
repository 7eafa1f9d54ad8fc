"""Parts of the documents that adapters, scenes and published results write themselves.

``uv run python -m bench.publishing.doc_blocks`` fills them anew; publishing a study does so, too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from adapters import ENGINES, Profile, profiles
from bench.machine.core_digest import present_core
from bench.machine.environment import describe_engine
from bench.machine.source_digest import ROOT
from bench.publishing.catalogue import PUBLICATIONS, PUBLISHED
from bench.publishing.page_marks import NOT_USED, core_of, pages, warning
from reports.records.folder import ResultsFolder
from reports.statistics.groups import groups_of
from reports.statistics.pairs import ALL, pair_rows
from reports.tables.capabilities import capability_table
from reports.tables.correctness import TITLE as CORRECTNESS
from reports.tables.outcomes import TITLE as OUTCOMES
from reports.tables.pairs import right_of_judged
from reports.tables.table import NOTHING, Table, to_markdown
from scenarios.registry import SCENARIOS, build
from scenarios.scenario import Scenario


def capabilities_block() -> str:
    """What the engines show to the core, side by side; without a title."""
    table = capability_table({name: describe_engine(name) for name in ENGINES})
    return _untitled(table)


def profiles_block() -> str:
    """Every profile of every engine: who set it up, and each knob with its reason."""
    return "\n".join(_engine(name) for name in ENGINES)


def headline_block() -> str:
    """What stood and what fell in the paper's study, with its picture."""
    gallery = PUBLICATIONS[HEADLINE].gallery
    assert gallery is not None, "the headline has a picture"
    shown = f"Final states on {gallery.engine}: a row a stack, a column a policy"
    picture = f"![{shown}]({PUBLISHED.name}/{HEADLINE}/stills.png)"
    return f"{picture}\n\n{_published_rows(HEADLINE, OUTCOMES)}\n{_caveat(HEADLINE)}"


def many_seeds_block() -> str:
    """How many of the trials by twenty hands ended as theory demands, of those that must stand and that must fall."""
    return f"{_published_rows('publish', CORRECTNESS)}\n{_caveat('publish')}"


def pairs_block() -> str:
    """Of how many pairs each policy got both sides right on each engine."""
    rows = [row for row in pair_rows(groups_of(ResultsFolder(PUBLISHED / "truth").records)) if row.family == ALL]
    counted = {(row.set_up.engine, row.set_up.policy): right_of_judged(row.success_rates) for row in rows}
    engines, policies = (tuple(dict.fromkeys(getattr(row.set_up, key) for row in rows)) for key in ("engine", "policy"))
    cells = ((engine, *(counted[engine, policy] for policy in policies)) for engine in engines)
    return _untitled(Table("", ("engine", *policies), tuple(cells))) + _caveat("truth")


def results_block() -> str:
    """Every study that is published so far, and the command that makes its numbers."""
    there = {name: one for name, one in PUBLICATIONS.items() if ResultsFolder(PUBLISHED / name).trials_file.exists()}
    rows = tuple((f"`{name}/`", one.shows, f"`{one.command}`") for name, one in there.items())
    return _untitled(Table("", ("Folder", "Study", "Command"), rows))


def cores_block() -> str:
    """Every published page, and the core that its claims hold for."""
    present = present_core()
    rows = tuple((f"[`{name}`]({name})", *_core(page, present)) for name, page in _published_pages())
    return _untitled(Table("", ("Page", "Core", "Claims"), rows))


def _core(page: Path, present: str) -> tuple[str, str]:
    core = core_of(page)
    if core == NOT_USED:
        return NOTHING, "of engines alone"
    return f"`{core}`", "hold for that core only: not yet made again" if warning(core, present) else "present core"


def claims_block() -> str:
    """Which pages are of an earlier core, in a sentence for documents that quote them."""
    present = present_core()
    earlier = [name for name, page in _published_pages() if warning(core_of(page), present)]
    if not earlier:
        return "Every published page was made with the present core.\n"
    told = ", ".join(f"`{name}`" for name in earlier)
    return f"**Made with an earlier core and not yet made again: {told}.** Claims from them hold for that core only.\n"


def _published_pages() -> list[tuple[str, Path]]:
    return [(page.relative_to(PUBLISHED).as_posix(), page) for page in pages(PUBLISHED)]


def _caveat(name: str) -> str:
    """What stands below a publication's table if it is of an earlier core; else nothing."""
    told = warning(core_of(PUBLISHED / name / "tables.md"), present_core())
    return f"\n*{told}*\n" if told else ""


def scenes_block() -> str:
    """Each scene as it is built by default, in three lines."""
    return "\n".join(_scene(name, scenario) for name, scenario in SCENARIOS.items())


def _scene(name: str, scenario: Scenario[...]) -> str:
    scene = build(name)
    told = f"- Theory: {scene.expectation.theory}\n- Look for: {scene.look_for}\n"
    return f"**`{name}`**: {scenario.description}\n\n{told}"


def _published_rows(name: str, title: str) -> str:
    """The table of a title in the tables of a publication, without its notes."""
    tables = (PUBLISHED / name / "tables.md").read_text(encoding="utf-8")
    return tables.partition(f"## {title}\n\n")[2].partition("\n\n")[0]


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


HEADLINE = "paper"
"""The publication whose table and picture ``docs/findings.md`` shows."""
BLOCKS: Mapping[str, tuple[str, Callable[[], str]]] = {
    "headline": ("docs/findings.md", headline_block),
    "many_seeds": ("docs/findings.md", many_seeds_block),
    "pairs": ("README.md", pairs_block),
    "results": ("docs/results/README.md", results_block),
    "cores": ("docs/results/README.md", cores_block),
    "claims": ("docs/reproducing_the_paper.md", claims_block),
    "capabilities": ("docs/choosing_an_engine.md", capabilities_block),
    "scenes": ("docs/truth.md", scenes_block),
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
