"""The places of a page to which the documents lead a reader: families, tables without a box, commands and documents."""

from pathlib import Path

import pytest

from reports.page.more_builds import difference_note, share_note
from reports.page.study_page import write_page
from reports.statistics.groups import groups_of
from tests.reports.studies import FALLS, STANDS, record, write_study

ROOT = Path(__file__).parents[3]


def page_of(folder: Path, records) -> Path:
    return write_page(write_study(folder / "study", records), records)


def families(engine: str = "bullet"):
    """A pair of tables and two towers, of which one falls."""
    table = {"pair": "table-1", "engine": engine}
    return [
        record(scene="table-1-stand", expectation=STANDS, **table),
        record(scene="table-1-fall", expectation=FALLS, verdict="false_stand", **table),
        record(scene="tower-1", engine=engine),
        record(scene="tower-2", engine=engine, verdict="false_collapse"),
        record(scene="table_top", engine=engine),
    ]


def test_one_family_is_chosen_at_the_heat_map(tmp_path, open_page) -> None:
    """The map shows the scenes of the family alone, and the column “right” counts its pairs and other scenes."""
    opened = open_page(page_of(tmp_path, [*families(), *families("dart"), record(engine="pymunk", scene="tower-1")]))
    heat = opened.locator(".heat table")

    def heads() -> list[str]:
        return heat.locator("thead th.scene:visible").evaluate_all("heads => heads.map(head => head.title)")

    def rights() -> dict[str, str]:
        rows = heat.locator("tbody tr").all()
        return {row.get_attribute("data-engine"): row.locator("td.figure").inner_text() for row in rows}

    assert rights() == {"bullet": "2/4", "dart": "2/4", "pymunk": "1/4"}
    opened.select_option("#families select", "tower")
    assert heads() == ["tower-1", "tower-2"]
    assert rights() == {"bullet": "1/2", "dart": "1/2", "pymunk": "1/2"}
    heat.locator("tbody td:visible:not(.figure)").first.focus()
    for key, scene in (("End", "tower-2"), ("ArrowRight", "tower-2"), ("Home", "tower-1"), ("ArrowLeft", "tower-1")):
        opened.keyboard.press(key)
        assert f"on {scene} " in opened.locator(".cell").inner_text(), "keys stay in the family"
    opened.select_option("#families select", "table")
    assert rights() == {"bullet": "0/1", "dart": "0/1", "pymunk": "-"}
    opened.locator("#families a").click()
    opened.wait_for_function("document.querySelector('#filters [name=family]').value === 'table'")
    rows = opened.locator("#table tbody tr:visible th").all_inner_texts()
    assert set(rows) == {"table-1-stand", "table-1-fall"}, "table_top is another family"
    opened.select_option("#families select", "")
    assert len(heads()) == 5
    assert rights()["bullet"] == "2/4"


def test_a_family_of_a_page_with_many_scenes_unfolds_its_scenes(tmp_path, open_page) -> None:
    towers = [record(scene=f"tower-{number}") for number in range(30)]
    opened = open_page(page_of(tmp_path, [*towers, record(scene="wall-1"), record(scene="wall-2")]))
    by_family, by_scene = opened.locator(".heat table").all()
    assert by_family.locator("thead small").all_inner_texts() == ["30 scenes", "2 scenes"]
    assert not by_scene.is_visible()
    opened.select_option("#families select", "wall")
    assert by_scene.locator("thead th.scene:visible").count() == 2
    assert not by_family.is_visible(), "the scenes of the family take the place of the families"
    opened.select_option("#families select", "")
    by_family.locator("tbody td:not(.figure)").last.click()
    opened.locator("#map .cell a").first.click()
    opened.wait_for_function("document.querySelector('#filters [name=family]').value === 'wall'")
    assert opened.locator("#table tbody tr:visible").count() == 2


def test_no_table_scrolls_in_a_box_on_a_wide_screen(tmp_path, open_page) -> None:
    set_ups = [{"engine": f"engine{number % 4}", "profile": f"p{number // 4}"} for number in range(40)]
    records = [record(scene=scene, **set_up) for set_up in set_ups for scene in ("wall", "tower")]
    opened = open_page(page_of(tmp_path, records), viewport={"width": 1400, "height": 900})
    opened.wait_for_function("[...document.querySelectorAll('.wide')].every(box => box.matches('.whole'))")
    hidden = "boxes => boxes.filter(box => getComputedStyle(box).overflowY !== 'visible').map(box => box.ariaLabel)"
    assert opened.locator(".wide").evaluate_all(hidden) == []
    places = opened.locator(".ranking tbody tr:visible")
    assert places.count() == 12
    opened.get_by_role("button", name="Show all 40").click()
    assert places.count() == 40
    assert opened.get_by_role("button", name="Show all 40").count() == 0
    opened.locator(".ranking tbody tr").last.scroll_into_view_if_needed()
    head, navigation = opened.locator(".ranking thead th").first.bounding_box(), opened.locator("nav").bounding_box()
    assert head is not None
    assert navigation is not None
    assert head["y"] == pytest.approx(navigation["y"] + navigation["height"], abs=3.0), "the head sticks below it"


def test_a_page_printed_has_all_places_of_the_ranking(tmp_path, open_page) -> None:
    opened = open_page(page_of(tmp_path, [record(engine=f"engine{number}") for number in range(20)]))
    opened.emulate_media(media="print")
    assert opened.locator(".ranking tbody tr:visible").count() == 20


def test_the_documents_are_links_to_files(tmp_path) -> None:
    page = page_of(tmp_path, [record()])
    output = page.read_text(encoding="utf-8")
    for path in ("docs/results/sleep/tables.md", "docs/using_it_in_your_engine.md"):
        link = output.partition(f'"><code>{path}</code></a>')[0].rpartition('href="')[2]
        assert (page.parent / link).resolve() == ROOT / path


def test_the_command_for_surer_shares_stands_beside_them(tmp_path, open_page) -> None:
    note = open_page(page_of(tmp_path, families())).locator("#verdicts > .note").first
    assert "n = 1 build of each: no intervals. Builds with placement noise give intervals:" in note.inner_text()
    command = note.locator("code").inner_text()
    assert command.startswith("uv run -m bench run ")
    assert command.endswith("study.toml --seeds 20")


@pytest.mark.parametrize(("seeds", "wanted"), [(1, 20), (3, 20), (30, 120)])
def test_more_builds_are_more_than_there_are(seeds: int, wanted: int) -> None:
    groups = groups_of([record(seed=seed) for seed in range(seeds)])
    assert share_note(groups, False, "RUN").endswith(f"`RUN --seeds {wanted}`.")
    assert ("no intervals" in share_note(groups, True, "RUN")) == (seeds == 1)


@pytest.mark.parametrize(
    ("policies", "options"),
    [
        (["none"], " --policy none --policy equilibrium"),
        (["paper"], " --policy none --policy paper"),
        (["none", "paper"], ""),
    ],
)
def test_a_difference_from_the_engine_alone_takes_both_and_several_seeds(policies: list[str], options: str) -> None:
    groups = groups_of([record(policy=policy) for policy in policies])
    assert difference_note(groups, policies, "RUN").endswith(f"`RUN{options} --seeds 20`.")
