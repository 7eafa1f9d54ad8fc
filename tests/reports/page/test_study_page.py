"""The page of a study, made from records and opened in a real browser."""

import csv
import itertools
import re
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe

from reports.page.study_page import write_page
from reports.records.trial import TrialRecord
from scenarios.threads import threads
from tests.reports.studies import FALLS, STANDS, failed, fallen, record, write_study

DOCS = Path(__file__).parents[3] / "docs"
TIMES = "\N{MULTIPLICATION SIGN}"
SEEDS = range(6)
RECORDS = [
    *(fallen(4 + seed, seed=seed, frame_ms_p50=9.0) for seed in SEEDS),
    *(record(policy="paper", seed=seed, frame_ratio=0.1 + 0.01 * seed) for seed in SEEDS),
    *(record(policy="paper", engine="mujoco", profile="tuned", seed=seed) for seed in SEEDS),
    record(scene="leaning_tower", policy="paper", verdict="false_stand", expectation=FALLS, frame_ms_p50=0.5),
    failed("crashed", engine="dart", message="last words <b>of</b> an engine"),
    failed("unsupported", engine="pymunk"),
    failed("out_of_memory", engine="dart", policy="paper"),
    record(engine="dart", seed=1, status="timeout", verdict="undecided", height_levels=12),
]


def page_of(folder: Path, records: list[TrialRecord], **options) -> Path:
    missing = options.pop("missing", ())
    return write_page(write_study(folder / "study", records, **options), records, missing)


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Path:
    lost = [RECORDS[0].trial]
    return page_of(tmp_path_factory.mktemp("page"), RECORDS, without_frames=lost, missing=["dart.game.x.none.s9.r0"])


def shown(page) -> list[str]:
    return [row.inner_text() for row in page.locator("#table tbody tr:visible").all()]


def heads(page) -> list[str]:
    return [head.split()[0] for head in page.locator("#table thead th").all_inner_texts()]


def test_it_opens_without_a_complaint_or_a_request_and_shows_every_engine(page, open_page) -> None:
    opened = open_page(page)
    cards = opened.locator(".card h4").all_inner_texts()
    assert [card.split()[0] for card in cards] == ["bullet", "dart", "pymunk", "mujoco"]
    assert opened.locator("#verdicts h3 code").all_inner_texts() == ["game", "tuned"]
    assert opened.locator("#survival svg").count() == 2
    assert opened.locator("#plot path").count() > 0


def test_a_card_shows_how_its_profile_is_set_up(tmp_path) -> None:
    varied = page_of(tmp_path, [record(), record(engine="dart", profile="game@scale=10"), record(profile="tuned")])
    output = re.findall(r'<p class="set-up">(.*?)</p>', varied.read_text(encoding="utf-8"))
    assert output == ["one step a frame", "one step a frame; scale=10"], "nothing is known of tuned"
    assert "(<code>bench check</code>)" in varied.read_text(encoding="utf-8"), "backticks of a note mark code"


def test_pairs_are_the_headline_where_there_are_any(tmp_path, open_page) -> None:
    sides = (("stand", STANDS, "right"), ("fall", FALLS, "false_stand"))
    frozen = [
        record(scene=f"table-{n}-{side}", pair=f"table-{n}", expectation=theory, verdict=verdict)
        for n in range(2)
        for side, theory, verdict in sides
    ]
    opened = open_page(page_of(tmp_path, frozen))
    assert opened.locator(".card .headline").inner_text() == "At best 0 % of the pairs right, alone."
    assert (
        opened.locator("#verdict .answer").inner_text().startswith("No set-up is right in both pairs; the nearest is")
    )
    shares = ["0", "%", "100", "%", "0", "%", "-", "0", "%"]  # creep was not measured
    assert opened.locator(".card tbody tr").inner_text().split() == ["none", *shares]
    assert opened.locator("#pairs table").count() == 3
    assert "The 2 pairs judge 4 of 4 scenes." in opened.locator("#pairs").inner_text()
    opened.locator("#pairs summary").click()
    assert "table-0-stand, table-0-fall" in opened.locator("#pairs details").inner_text()
    assert opened.locator("#pairs svg").count() == 1
    report = tmp_path / "study" / "report"
    assert {"pairs.csv", "pairs.tex"} <= {path.name for path in report.iterdir()}
    assert (report / "figures" / "pairs.pdf").exists()


def test_rows_are_filtered_by_choice_and_by_word(page, open_page) -> None:
    opened = open_page(page)
    everything = len(shown(opened))
    opened.select_option("#filters [name=engine]", "bullet")
    assert all("bullet" in row for row in shown(opened))
    assert opened.locator("#count").inner_text() == f"{len(shown(opened))} of {everything}"
    opened.fill("#filters [name=text]", "leaning")
    assert len(shown(opened)) == 1
    opened.click("#filters [type=reset]")
    opened.wait_for_function(f"document.querySelectorAll('#table tbody tr:not([hidden])').length === {everything}")


def test_headings_sort_up_then_down_and_what_does_not_exist_stays_last(page, open_page) -> None:
    opened = open_page(page)
    heading = opened.get_by_role("button", name=re.compile("^p50"))

    def times() -> list[str]:
        return [row.split("\t")[heads(opened).index("p50")] for row in shown(opened)]

    heading.focus()
    opened.keyboard.press("Enter")
    up = times()
    assert opened.locator("th[aria-sort=ascending]").inner_text().startswith("p50")
    heading.click()
    down = times()
    numbers = [float(text.split()[0]) for text in up if text != "-"]
    assert numbers == sorted(numbers)
    assert [text for text in down if text != "-"] == [text for text in up if text != "-"][::-1]
    assert up[-1] == down[-1] == "-"


def test_a_phone_needs_no_sideways_scrolling_and_the_dark_is_dark(page, open_page) -> None:
    phone = open_page(page, viewport={"width": 390, "height": 844}, color_scheme="dark")
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    background = "getComputedStyle(document.body).backgroundColor"
    assert phone.evaluate(background) == "rgb(20, 23, 27)"
    phone.click("#theme")
    assert phone.evaluate(background) == "rgb(251, 251, 249)"


def test_what_went_wrong_or_is_missing_is_said_first(page) -> None:
    output = page.read_text(encoding="utf-8").partition('id="verdicts"')[0]
    for words in (
        "1 of 23 trials was stopped by the time limit: its levels are lower bounds",
        "1 of 23 trials crashed the engine&#39;s process",
        "1 of 23 trials ran out of memory",
        "1 of 23 trials was not possible on its engine",
        "1 planned trial has no record (not yet run, or interrupted): dart.game.x.none.s9.r0",
        f"Frames of 1 trial are missing or incomplete: {RECORDS[0].trial}",
    ):
        assert words in output


def test_a_run_without_measured_creep_says_so_and_names_the_command(tmp_path) -> None:
    made = [record(mean_motion_m_s=1e-6), record(policy="paper", creep_m_s=0.0), fallen(4, scene="card_house")]
    output = page_of(tmp_path, made).read_text(encoding="utf-8")
    assert "Creep not measured: 1 trial stood in records from before format 3" in output
    assert re.search(r"Measure it: <code>uv run -m bench run \S+study.toml</code>", output)
    assert "The other 2 trials measured it, or fell, stopped or were not played." in output
    shares = re.findall(r"<tbody><tr><th scope=.row.>.+?</tbody>", output.partition('class="card"')[2])[0]
    assert [re.findall("<td>(.*?)</td>", row)[3] for row in shares.split("</tr>")[:2]] == ["-", "0 %"], "none, paper"


def test_a_published_folder_without_frames_is_not_called_incomplete_trial_by_trial(tmp_path) -> None:
    made = [record(), record(policy="paper")]
    folder = write_study(tmp_path / "study", made, without_frames=[one.trial for one in made])
    output = write_page(folder, made).read_text(encoding="utf-8").partition('id="ranking"')[0]
    assert "No trial has its frames here (published folders keep none)" in output
    assert made[0].trial not in output


def test_the_verdict_is_the_first_words_and_the_ranking_next(page) -> None:
    output = page.read_text(encoding="utf-8")
    sections = re.findall(r'<section id="(\w+)"', output)
    assert sections[:5] == ["verdict", "ranking", "map", "policies", "verdicts"]
    assert output.index("No set-up is right in both scenes (7 builds)") < output.index("Read this first")


def test_the_verdict_leads_to_the_settings_that_it_names(tmp_path, open_page) -> None:
    opened = open_page(page_of(tmp_path, [record()]))
    assert "game: one step a frame (each setting of bullet, with its reason)" in opened.locator("#verdict").inner_text()
    settings = opened.locator("#set-bullet-game")
    assert not settings.is_visible(), "it is folded"
    opened.locator("#verdict a").click()
    settings.wait_for()


def questions() -> list[list[str]]:
    """The questions of ``docs/reading_a_page.md`` and the places of their answers."""
    lines = (DOCS / "reading_a_page.md").read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return [row for row in rows if row[0].endswith("?")]


def with_pairs() -> list[TrialRecord]:
    """Fifty tables in pairs on two engines, and towers of several seeds and policies."""
    tables = [
        record(
            scene=f"table-{n}-{side}",
            pair=f"table-{n}",
            engine=engine,
            expectation=theory,
            verdict=verdict,
            collapse_level=None,
        )
        for n in range(25)
        for side, theory, verdict in (("stand", STANDS, "creeps"), ("fall", FALLS, "false_stand"))
        for engine in ("bullet", "mujoco")
    ]
    towers = [record(policy=policy, seed=seed, frame_ms_p50=1.0) for policy in ("none", "paper") for seed in range(6)]
    return [*tables, *towers, *(fallen(4, scene="leaning_tower", seed=seed) for seed in range(6))]


def without_pairs() -> list[TrialRecord]:
    """A tower that creeps, one that stands and must fall, and one that falls and must stand: one seed, one engine."""
    return [
        record(verdict="creeps", creep_m_s=1e-6),
        record(scene="leaning_tower", verdict="false_stand", expectation=FALLS),
        fallen(4, scene="card_house"),
    ]


@pytest.mark.parametrize("records", [with_pairs(), without_pairs()], ids=["pairs", "no pairs"])
def test_every_question_of_the_documents_is_answered_by_a_place_on_the_page(records, tmp_path, open_page) -> None:
    """Each place is a section with its heading, and what the document names in it is there: columns, signs, buttons."""
    opened = open_page(page_of(tmp_path, records))
    names = {link.get_attribute("href"): link.inner_text() for link in opened.locator("nav a").all()}
    names["#ends"] = "Pictures"  # only a renderer draws stills, and the section needs them
    assert len(questions()) == 20
    for question, answer in questions():
        for part in answer.split("; "):
            matched = re.fullmatch(r"([A-Z][\w ]+) `(#\w+)`(?:[:,] (.+))?|[a“].+|the note [\w ]+", part)
            assert matched is not None, question
            heading, place, named = matched.groups()
            if place is None or place == "#ends":  # a part of the section named before, or a document
                continue
            assert names[place] == heading, question
            text = opened.locator(f"section{place}").text_content()
            words = re.findall("“(.+?)”", named or "")
            column = re.match(r"columns? ([\w ]+?)(?::|$)", named or "")
            words += column[1].split(" and ") if column else []
            assert [word for word in words if word not in text] == [], question
    signs = opened.evaluate(
        "[...document.querySelectorAll('#map .legend i')].map(sign => getComputedStyle(sign, '::before').content[1])"
    )
    assert set(signs) >= {"▲", "▼", "→"}
    summaries = opened.locator("#map summary").all_inner_texts()
    assert summaries == (["Scene by scene"] if len({one.scene for one in records}) > 30 else [])


def test_the_heat_map_is_walked_by_keys_and_leads_to_the_numbers(page, open_page) -> None:
    opened = open_page(page)
    heat = opened.locator(".heat table")
    assert heat.locator("thead th[scope=col]").count() == 2 + len({one.scene for one in RECORDS})
    states = heat.locator("tbody tr", has_text="bullet game paper").locator("td:not(.figure)").all_inner_texts()
    assert [state.strip() for state in states] == ["6 correct of 6", "false stand"]
    heat.locator("tbody td:not(.figure)").first.focus()
    opened.keyboard.press("ArrowDown")
    opened.keyboard.press("End")
    where = opened.locator(".cell").inner_text()
    row = opened.evaluate("Object.values({...document.activeElement.parentElement.dataset})")
    assert where.startswith(" ".join(row) + " on ")
    opened.keyboard.press("Enter")
    opened.wait_for_function(f"document.querySelector('#filters [name=policy]').value === {row[2]!r}")
    assert all(all(word in text for word in row) for text in shown(opened))


def test_a_run_without_the_engines_sleeping_says_where_sleeping_is_shown(tmp_path, open_page) -> None:
    notes = {
        policy: open_page(page_of(tmp_path / policy, [record(policy=policy)])).locator("#policies").inner_text()
        for policy in ("none", "native")
    }
    assert "docs/results/sleep/tables.md" in notes["none"]
    assert "docs/results/sleep/tables.md" not in notes["native"]


def test_a_clicked_cell_keeps_its_line_while_the_pointer_crosses_other_cells(page, open_page) -> None:
    opened = open_page(page)
    cells = opened.locator(".heat tbody td:not(.figure)")
    cells.last.hover()
    chosen = opened.locator(".cell").inner_text()
    cells.first.hover()
    assert opened.locator(".cell").inner_text() != chosen, "without a click the line follows the pointer"
    cells.last.click()
    cells.first.hover()
    assert opened.locator(".cell").inner_text() == chosen


def test_many_scenes_have_a_map_by_family_first(tmp_path, open_page) -> None:
    towers = [record(scene=f"tower-{n}", verdict="false_stand" if n < 3 else "right") for n in range(29)]
    opened = open_page(page_of(tmp_path, [*towers, record(scene="wall"), record(scene="arch")]))
    maps = opened.locator(".heat table")
    assert [one.get_attribute("data-by") for one in maps.all()] == ["family", "scene"]
    assert maps.first.locator("tbody td b").all_inner_texts() == ["3 false stands of 29", "correct", "correct"]
    assert maps.first.locator("tfoot").inner_text().split("\t") == ["set-ups right, of 1", "", "0", "1", "1"]
    assert not maps.last.is_visible()


def test_a_column_of_the_heat_map_has_a_name_also_where_its_scene_is_the_family_itself(tmp_path, open_page) -> None:
    scenes = ["four_stack-levels5", "four_stack", "leaning_tower"]
    opened = open_page(page_of(tmp_path, [record(scene=scene, scenario=scene.split("-")[0]) for scene in scenes]))
    names = [" ".join(head.split()) for head in opened.locator(".heat .scene").all_inner_texts()]
    assert [name.removesuffix(" stands") for name in names] == [
        "four_stack levels5",
        "four_stack unvaried",
        "leaning_tower",
    ]


def test_a_column_without_an_entry_is_left_out(tmp_path, open_page) -> None:
    always = ["scene", "theory", "engine", "profile", "policy", "seeds", "levels", "right"]
    assert heads(open_page(page_of(tmp_path / "rested", [record()]))) == [*always, "p50", "p99", "again"]
    opened = open_page(page_of(tmp_path / "crept", [record(creep_m_s=1e-6)]))
    assert "creep" in heads(opened)
    note = opened.locator("#matrix > .note").last.inner_text()
    assert re.search(r"left out: sink \(.+ratio \(.+against none \(pairs of a seed, two or more", note)


def test_own_scenes_have_the_names_of_their_files(tmp_path) -> None:
    file = {"scenario": "own_scene", "parameters": {"file": "my/lintel.toml", "size": 3.0, "mass": 1.0, "yaw": 0.0}}
    output = page_of(tmp_path, [record(scene="own_scene-lintel-0eb37ace", **file)]).read_text(encoding="utf-8")
    assert "<title>lintel, size 3: Stillstack</title>" in output
    assert '<th scope="row">lintel, size 3</th>' in output


def test_a_row_of_a_public_thread_names_it(tmp_path, open_page) -> None:
    """The flag is a link beside the scene's name, which filters, commands and copies use without it."""
    thread = threads()["issue_bullet3_3049"]
    file = {"scenario": "own_scene", "parameters": {"file": "issue_bullet3_3049.toml"}}
    records = [record(scene="own_scene-issue_bullet3_3049-f0507a7e", **file), record()]
    opened = open_page(page_of(tmp_path, records))
    flags = opened.locator("#table .flag")
    assert flags.all_inner_texts() == [thread.name]
    assert flags.get_attribute("href") == thread.url
    opened.select_option("#filters [name=scene]", "issue_bullet3_3049")
    assert [row.split("\t")[0].split() for row in shown(opened)] == [["issue_bullet3_3049", thread.name]]
    opened.locator("#table tr:visible summary").click()
    opened.locator("#table details[open] .command").first.wait_for()  # the page writes commands once a row is opened
    details = opened.locator("#table details[open]").inner_text()
    assert f"Reported in {thread.name}, of its own engine and settings: {thread.reported}." in details
    assert "--scenario own_scene" in details
    opened.evaluate("navigator.clipboard.writeText = async text => { window.copied = text; }")
    opened.locator("#copy").get_by_role("button", name="CSV").click()
    opened.wait_for_function("window.copied")
    assert opened.evaluate("window.copied").splitlines()[1].startswith("issue_bullet3_3049,stands,bullet,")
    table = (tmp_path / "study" / "report" / "comparison.csv").read_text(encoding="utf-8")
    header, *rows = csv.reader(table.splitlines())
    assert [row[header.index("thread")] for row in rows] == [thread.name, "-"]


def test_a_row_that_shows_a_known_fault_of_its_engine_names_the_thread(tmp_path, open_page) -> None:
    """The flag is a link below the engine's name, which filters, commands and copies use without it."""
    records = [record(engine="mujoco", verdict="creeps"), record(engine="mujoco", policy="paper"), record()]
    opened = open_page(page_of(tmp_path, records))
    flags = opened.locator("#table .flag")
    assert flags.all_inner_texts() == ["mujoco#3328"]
    assert flags.get_attribute("href") == "https://github.com/google-deepmind/mujoco/issues/3328"
    opened.select_option("#filters [name=engine]", "mujoco")
    assert len(shown(opened)) == 2
    opened.select_option("#filters [name=base]", "mujoco game paper")
    assert shown(opened)[0].count(TIMES) == 2, "the row with the flag has a ratio of each time"
    opened.locator("#table summary").first.click()
    opened.locator("#table details[open] .command").wait_for()
    details = opened.locator("#table details[open]").inner_text()
    assert "Known fault of mujoco, google-deepmind/mujoco#3328: regularised friction never sticks" in details
    assert "--engine mujoco --profile game" in details
    opened.evaluate("navigator.clipboard.writeText = async text => { window.copied = text; }")
    opened.locator("#copy").get_by_role("button", name="CSV").click()
    opened.wait_for_function("window.copied")
    assert opened.evaluate("window.copied").splitlines()[1].startswith("four_stack,stands,mujoco,game,none,")
    table = (tmp_path / "study" / "report" / "comparison.csv").read_text(encoding="utf-8")
    header, *rows = csv.reader(table.splitlines())
    assert [row[header.index("known fault")] for row in rows] == ["google-deepmind/mujoco#3328", "-", "-"]


def test_words_of_an_engine_are_no_part_of_the_page(page) -> None:
    assert "last words &lt;b&gt;of&lt;/b&gt; an engine" in page.read_text(encoding="utf-8")


def test_every_row_shows_the_command_that_makes_it_again(page, open_page) -> None:
    opened = open_page(page)
    assert len(shown(opened)) == len({(one.scene, one.engine, one.profile, one.policy) for one in RECORDS})
    opened.locator("#table summary").first.click()
    line = opened.locator("#table tbody tr").first.locator(".command")
    command = line.locator("code").inner_text()
    assert command.startswith("uv run -m bench run ")
    assert command.endswith("study.toml --engine bullet --profile game --scenario four_stack --policy none --seeds 6")
    line.get_by_role("button", name="copy").click()
    said = opened.wait_for_function(
        "document.querySelector('.copy').textContent.match(/copied|selected/)?.[0]"
    ).json_value()
    selected = opened.evaluate("getSelection().toString()")
    assert selected == (command if said == "selected" else ""), "selected where a page may not copy"


def test_the_selection_is_copied_as_text_for_other_programs(page, open_page, browser) -> None:
    opened = open_page(page)
    opened.evaluate("navigator.clipboard.writeText = async text => { window.copied = text; }")
    opened.select_option("#filters [name=engine]", "pymunk")
    copies = {}
    for name in ("CSV", "Markdown", "LaTeX"):
        opened.locator("#copy").get_by_role("button", name=name).click()
        opened.wait_for_function(f"document.getElementById('copied').textContent === '1 rows copied as {name}'")
        copies[name] = opened.evaluate("window.copied").splitlines()
    assert [copies["CSV"][0][:35], copies["CSV"][1][:39]] == [
        "scene,theory,engine,profile,policy,",
        "four_stack,stands,pymunk,game,none,1,n/",
    ]
    assert copies["Markdown"][1].count(" --- |") == copies["Markdown"][0].count("|") - 1
    assert copies["LaTeX"][0].startswith(r"\begin{tabular}{l")
    assert copies["LaTeX"][3].startswith(r"four\_stack & stands & pymunk & game & none & ")


def test_frame_times_are_compared_with_a_set_up_that_the_reader_chooses(page, open_page) -> None:
    opened = open_page(page)
    opened.select_option("#filters [name=base]", "mujoco tuned paper")
    [alone] = [row for row in shown(opened) if "four_stack" in row and "bullet\tgame\tnone" in row]
    time = alone.split("\t")[heads(opened).index("p50")]
    assert time.endswith(f" {TIMES}7.2"), "9.0 ms over the median of 1.0 to 1.5 ms"
    opened.select_option("#filters [name=base]", "")
    assert TIMES not in "".join(shown(opened))


def test_the_address_keeps_filters_and_order(page, open_page) -> None:
    opened = open_page(page)
    opened.select_option("#filters [name=policy]", "paper")
    opened.fill("#filters [name=text]", "four")
    opened.get_by_role("button", name=re.compile("^p50")).click()
    expected = shown(opened)
    address = opened.evaluate("location.hash")
    linked = open_page(page)
    linked.evaluate(f"location.hash = {address!r}")
    linked.wait_for_function("document.querySelector('#filters [name=policy]').value === 'paper'")
    assert shown(linked) == expected
    assert linked.locator("th[aria-sort=ascending]").inner_text().startswith("p50")


def test_a_fresh_opening_and_a_reload_of_a_link_show_its_section(tmp_path, browser) -> None:
    """The section begins below the navigation, although tables above it become taller after the first layout."""
    made = page_of(tmp_path, [record(scene="tower-1", engine=f"engine{e}", policy="paper") for e in range(50)])
    views = (("#rows:policy=paper", "matrix"), ("#families:family=tower", "map"))
    for (address, section), width in itertools.product(views, (1400, 1920, 390)):
        opened = browser.new_page(viewport={"width": width, "height": 900})
        opened.goto(made.as_uri() + address)
        for _ in ("fresh", "reloaded"):
            opened.wait_for_timeout(300)
            top = opened.evaluate(f"document.getElementById('{section}').getBoundingClientRect().top")
            assert 0 <= top <= 60, f"{address} at {width} px: the navigation is about 50 px high"
            opened.evaluate("scrollTo({ top: 0, behavior: 'instant' })")
            opened.reload()
        opened.close()


def test_the_view_is_copied_as_a_link_that_names_the_file_it_needs(page, open_page) -> None:
    opened = open_page(page)
    opened.evaluate("navigator.clipboard.writeText = async text => { window.copied = text; }")
    opened.select_option("#filters [name=policy]", "paper")
    opened.get_by_role("button", name="Copy link").click()
    opened.wait_for_function("window.copied")
    assert opened.evaluate("window.copied").endswith("index.html#rows:policy=paper")
    assert "--single" in opened.locator("#copied").inner_text()


def test_pairs_are_tested_and_medians_are_bounds_where_most_stood(page, open_page) -> None:
    [none] = [row for row in shown(open_page(page)) if "bullet\tgame\tnone" in row]
    [paper] = [row for row in shown(open_page(page)) if "four_stack" in row and "bullet\tgame\tpaper" in row]
    assert "6 of 6 fell" in none
    assert "none fell, ≥30" in paper
    assert "6 / 0; p = 0.031" in paper, "as unlikely as six equal tosses"


def test_one_seed_has_no_interval_and_no_survival_curve(tmp_path) -> None:
    output = page_of(tmp_path, [fallen(9), record(policy="paper")]).read_text(encoding="utf-8")
    assert "n = 1 build of each: no intervals" in output
    assert "a single build of each stack has no survival curve" in output
    assert not re.search(r"\d \[\d", output.partition("<main>")[2].partition("<script")[0])


def test_a_study_of_failures_alone_has_a_page_too(tmp_path) -> None:
    output = page_of(tmp_path, [failed("crashed"), failed("unsupported", engine="pymunk")]).read_text(encoding="utf-8")
    assert "1 of 2 trials crashed" in output


@pytest.mark.parametrize(("width", "scheme"), [(1400, "light"), (390, "dark")])
def test_axe_finds_no_violation(page, open_page, width, scheme) -> None:
    opened = open_page(page, viewport={"width": width, "height": 900}, color_scheme=scheme)
    opened.locator("#table summary").first.click()
    opened.locator(".heat td:not(.figure)").first.focus()
    found = Axe().run(opened).response["violations"]
    assert [(one["id"], one["nodes"][0]["html"]) for one in found] == []


def test_print_is_light_and_keeps_every_column(page, open_page) -> None:
    opened = open_page(page, color_scheme="dark", viewport={"width": 760, "height": 1000})
    opened.emulate_media(media="print")
    assert opened.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    for part in (".heat table", "#table", ".ranking"):
        box = opened.locator(part).first.bounding_box()
        assert box is not None
        assert box["x"] + box["width"] <= 761, f"{part} is cut at the edge of the paper"


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [1, 20])
def test_ten_thousand_trials_make_a_page_of_less_than_five_megabytes_painted_within_two_seconds(
    tmp_path, launch, seeds
) -> None:
    """The browser emulates no graphics card, because the emulation alone delays the paint of an empty page by 0.4 s."""
    made = [
        record(scene=f"scene-{scene}", engine=f"engine{engine}", policy=policy, seed=seed, timed_frames=None)
        for scene in range(200 // seeds)
        for engine in range(10)
        for policy in ("none", "native", "at_rest", "paper", "equilibrium")
        for seed in range(seeds)
    ]
    page = page_of(tmp_path, made)
    assert page.stat().st_size < 5e6
    browser = launch()
    opened = browser.new_page(viewport={"width": 1280, "height": 900})
    opened.goto(page.as_uri())
    paint = opened.wait_for_function("performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
    paint_ms = paint.json_value()
    browser.close()
    assert paint_ms < 2000
