"""Generated blocks of the documents, made from adapters, scenes, published results and the tutorial's example.

``uv run python -m bench.publishing.doc_blocks`` fills the blocks. The publication of a study fills the blocks, too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

from adapters import ENGINES, Profile, capabilities, engine_version, profiles
from bench.machine.core_digest import present_core
from bench.machine.source_digest import PUBLISHED, ROOT
from bench.publishing.catalogue import PUBLICATIONS
from bench.publishing.holdings import differences, holdings
from bench.publishing.page_marks import NOT_USED, core_of, pages, warning
from bench.publishing.rounds import rounds_block
from reports import load
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.statistics.groups import GroupKey, groups_of
from reports.statistics.intervals import paired_ratio
from reports.statistics.pairs import ALL, pair_rows
from reports.tables.capabilities import capability_table
from reports.tables.correctness import correctness_table
from reports.tables.outcomes import outcomes_table
from reports.tables.pairs import right_of_judged
from reports.tables.separation import STUDIES, separation_table
from reports.tables.table import NOTHING, Table, to_markdown
from reports.tables.wording import ratio_text
from scenarios.registry import SCENARIOS, build
from scenarios.scenario import Scenario


def capabilities_block() -> str:
    """Return the table of the capabilities of all engines."""
    described = {
        name: {
            "version": VERSIONS_OF_LIBRARIES.get(name) or engine_version(name),
            "capabilities": asdict(capabilities(name)),
        }
        for name in ENGINES
    }
    return _untitled(capability_table(described))


def profiles_block() -> str:
    """Return every profile of every engine: its author, its description, and each knob with value and reason."""
    return "\n".join(_engine(name) for name in ENGINES)


def headline_block() -> str:
    """Return the picture and the table of outcomes of the publication ``paper``."""
    gallery = PUBLICATIONS[HEADLINE].gallery
    assert gallery is not None, "the headline has a picture"
    shown = f"Final states on {gallery.engine}: a row a stack, a column a policy"
    picture = f"![{shown}]({PUBLISHED.name}/{HEADLINE}/stills.png)"
    return f"{picture}\n\n{_rows(outcomes_table(_records(HEADLINE)))}{_caveat(HEADLINE)}"


def many_seeds_block() -> str:
    """Return the table of correct trials of the publication ``publish``, which runs its scenes with twenty seeds."""
    return f"{_rows(correctness_table(load(PUBLISHED / 'publish').trials))}{_caveat('publish')}"


def separation_block() -> str:
    """Return the table that compares engines without and with the extension, by figures from several studies."""
    table = separation_table({name: ResultsFolder(PUBLISHED / name) for name in STUDIES})
    return _untitled(table) + "".join(dict.fromkeys(map(_caveat, STUDIES)))


def pairs_block() -> str:
    """Return the table of pairs with both outcomes correct in profile ``tuned``, by engine and policy."""
    tuned = [record for record in _records("truth") if record.profile == "tuned"]
    rows = [row for row in pair_rows(groups_of(tuned)) if row.family == ALL]
    counted = {(row.set_up.engine, row.set_up.policy): right_of_judged(row.success_rates) for row in rows}
    engines, policies = (tuple(dict.fromkeys(getattr(row.set_up, key) for row in rows)) for key in ("engine", "policy"))
    cells = ((engine, *(counted[engine, policy] for policy in policies)) for engine in engines)
    return _untitled(Table("", ("engine", *policies), tuple(cells))) + _caveat("truth")


def ratios_block() -> str:
    """Return the table of the frame ratios of policy ``paper``: a row per scene and profile, a column per engine.

    The table leaves out groups with fewer ratios than ``paired_ratio`` needs.
    """
    groups = [group for name in RATIOS for group in groups_of(_records(name)) if group.key.policy == "paper"]
    estimates = {group.key: paired_ratio(group.measured("frame_ratio")) for group in groups}
    timed = {key: estimate for key, estimate in estimates.items() if estimate is not None}
    engines = tuple(dict.fromkeys(key.engine for key in timed))
    scenes = dict.fromkeys((key.scene, key.profile) for key in timed)
    rows = tuple(
        (scene, profile, *(ratio_text(timed.get(GroupKey(scene, engine, profile, "paper"))) for engine in engines))
        for scene, profile in scenes
    )
    table = _untitled(Table("", ("scene", "profile", *engines), rows))
    return table + "".join(dict.fromkeys(map(_caveat, RATIOS)))


def results_block() -> str:
    """Return the table of the published studies: content, trials, command, and differences from a run today."""
    there = {name: one for name, one in PUBLICATIONS.items() if ResultsFolder(PUBLISHED / name).trials_file.exists()}
    rows = tuple(
        (
            f"`{name}/`",
            one.shows,
            holdings(PUBLISHED / name),
            f"`{one.command}`",
            differences(PUBLISHED / name, one) or NOTHING,
        )
        for name, one in there.items()
    )
    return _untitled(Table("", ("Folder", "Study", "Holds", "Command", "A run today differs"), rows))


def cores_block() -> str:
    """Return the table of the published pages, with the digest of the core that made each page."""
    present = present_core()
    rows = tuple((f"[`{name}`]({name})", *_core(page, present)) for name, page in _published_pages())
    return _untitled(Table("", ("Page", "Core", "Claims"), rows))


def example_block(part: str) -> str:
    """Return the tutorial's example between the marks ``# begin PART`` and ``# end PART``, as a code block.

    Raises:
        ValueError: if the example has no such part.
    """
    found = re.search(rf"# begin {part}\n(.*?)\n# end {part}\n", EXAMPLE.read_text(encoding="utf-8"), re.DOTALL)
    if not found:
        raise ValueError(
            f"{EXAMPLE}: part '{part}' is missing; mark this part with '# begin {part}' and '# end {part}'"
        )
    return f"```python\n{found[1].strip()}\n```\n"


def _core(page: Path, present: str) -> tuple[str, str]:
    core = core_of(page)
    if core == NOT_USED:
        return NOTHING, "of engines alone"
    return f"`{core}`", "hold for that core only: not yet made again" if warning(core, present) else "present core"


def claims_block() -> str:
    """Return a note that names the pages of an earlier core, or says that there are none."""
    present = present_core()
    earlier = [name for name, page in _published_pages() if warning(core_of(page), present)]
    if not earlier:
        return "Every published page was made with the present core.\n"
    names = ", ".join(f"`{name}`" for name in earlier)
    return f"**Made with an earlier core and not yet made again: {names}.** Claims from them hold for that core only.\n"


def _published_pages() -> list[tuple[str, Path]]:
    return [(page.relative_to(PUBLISHED).as_posix(), page) for page in pages(PUBLISHED)]


def _caveat(name: str) -> str:
    """Return the caveat to write below a publication's table if an earlier core made the page; else an empty string."""
    caveat = warning(core_of(PUBLISHED / name / "tables.md"), present_core())
    return f"\n*{caveat}*\n" if caveat else ""


def scenes_block() -> str:
    """Return the description of each scenario, and the theory and the hint "Look for" of its default scene."""
    return "\n".join(_scene(name, scenario) for name, scenario in SCENARIOS.items())


def _scene(name: str, scenario: Scenario[...]) -> str:
    scene = build(name)
    lines = f"- Theory: {scene.expectation.theory}\n- Look for: {scene.look_for}\n"
    return f"**`{name}`**: {scenario.description}\n\n{lines}"


def _rows(table: Table) -> str:
    """Return the table as Markdown without title and notes."""
    return _untitled(replace(table, notes=()))


def _records(name: str) -> list[TrialRecord]:
    return ResultsFolder(PUBLISHED / name).records


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


VERSIONS_OF_LIBRARIES = {"ode": "panda3d 1.10.16 (single precision), or libode8 where installed (double)"}
"""Versions that documents state for engines whose library depends on the machine, so that the text is the same on every
machine."""
HEADLINE = "paper"
"""Publication whose table and picture ``docs/findings.md`` shows."""
RATIOS = ("ratio", "publish")
"""Publications whose frame ratios ``docs/findings.md`` shows."""
EXAMPLE = ROOT / "docs" / "examples" / "toy_engine.py"
"""File with the example of the tutorial."""
EXAMPLE_PARTS = ("imports", "engine", "port", "check", "main")
"""Parts of the example, in the order of the tutorial."""
BLOCKS: Mapping[str, tuple[str, Callable[[], str]]] = {
    "headline": ("docs/findings.md", headline_block),
    "ratios": ("docs/findings.md", ratios_block),
    "many_seeds": ("docs/findings.md", many_seeds_block),
    "separation": ("README.md", separation_block),
    "pairs": ("docs/findings.md", pairs_block),
    "results": ("docs/results/README.md", results_block),
    "cores": ("docs/results/README.md", cores_block),
    "rounds": ("docs/results/README.md", rounds_block),
    "claims": ("docs/reproducing_the_paper.md", claims_block),
    "capabilities": ("docs/choosing_an_engine.md", capabilities_block),
    "scenes": ("docs/truth.md", scenes_block),
    "profiles": ("docs/profiles.md", profiles_block),
    **{f"toy_{part}": ("docs/tutorial.md", partial(example_block, part)) for part in EXAMPLE_PARTS},
}
"""Document of each block and function that returns its content, by the name of the block."""


def filled(document: str, name: str, block: str, content: str) -> str:
    """Return the text ``document`` with ``content`` between the begin and end marks of a block.

    Args:
        document: text of the document.
        name: path of the document, for the message.
        block: name of the block.
        content: content of the block.

    Raises:
        ValueError: if the document has no marks of this block.
    """
    marks = re.compile(rf"(<!-- begin {block}\b[^>]*-->\n).*?(<!-- end {block} -->)", re.DOTALL)
    if not marks.search(document):
        raise ValueError(
            f"{name}: block '{block}' is missing: mark its place with <!-- begin {block} --> and <!-- end {block} -->, "
            "and run 'uv run python -m bench.publishing.doc_blocks'"
        )
    return marks.sub(lambda found: f"{found[1]}\n{content}\n{found[2]}", document)


def main() -> None:
    """Write the present content of each block into the document of the block."""
    for block, (name, write) in BLOCKS.items():
        path = ROOT / name
        path.write_text(filled(path.read_text(encoding="utf-8"), name, block, write()), encoding="utf-8")


if __name__ == "__main__":
    main()
