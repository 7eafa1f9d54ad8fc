"""Files that anybody may have written: a clear error, status 2, and nothing written or overwritten."""

import html
import json

import pytest
from typer.testing import CliRunner

from bench.cli.app import app
from bench.compare import strict_json
from bench.compare.baseline import read_baseline, write_baseline
from bench.compare.side import BaselineError
from bench.compare.strict_json import JsonError, parse


def call(*arguments: object, status: int) -> str:
    result = CliRunner().invoke(app, list(map(str, arguments)))
    assert result.exit_code == status, result.output
    return " ".join(result.output.split())


@pytest.fixture
def good(make, tmp_path):
    path = tmp_path / "good.json"
    write_baseline(make.side(), path)
    return path


def edited(good, **changes: object) -> str:
    return json.dumps(json.loads(good.read_text()) | changes)


def trial(good, **changes: object) -> str:
    content = json.loads(good.read_text())
    content["trials"][0] |= changes
    return json.dumps(content)


HOSTILE = {
    "empty": (lambda _: "", "not valid JSON, or cut off"),
    "cut off": (lambda good: good.read_text()[:-20], "not valid JSON, or cut off"),
    "no text": (lambda _: b"\xff\xfe\x00\x01", "not a text in UTF-8"),
    "foreign": (lambda _: '{"machine_info": {}, "packages": []}', "not a baseline"),
    "of pytest-benchmark": (lambda _: '{"machine_info": {}, "benchmarks": []}', "is a file of pytest-benchmark"),
    "a list": (lambda _: "[1, 2, 3]", "not a baseline"),
    "another format": (lambda good: edited(good, format="stillstack-baseline-2"), "not a baseline"),
    "deep": (lambda _: "[" * 200_000, "nests too deeply"),
    "deep and closed": (lambda _: '{"a":' * 50_000 + "1" + "}" * 50_000, "nests too deeply"),
    "deep inside": (lambda good: edited(good, machines=0).replace("0}", "[" * 900 + "]" * 900 + "}"), ""),
    "huge integer": (lambda good: trial(good, seed=0).replace('"seed": 0', f'"seed": {"9" * 5000}'), "digits"),
    "huge float": (lambda good: trial(good, sink_m=0).replace('"sink_m": 0', '"sink_m": 1e999'), "sink_m"),
    "NaN": (lambda good: trial(good, sink_m=float("nan")), "every number must be finite, got NaN"),
    "infinity": (lambda good: trial(good, creep_m_s=float("-inf")), "every number must be finite, got -Infinity"),
    "key twice": (
        lambda good: good.read_text().replace('"study":', '"study": "x", "study":'),
        "key 'study' must occur once in an object, but occurs again",
    ),
    "wrong type": (lambda good: trial(good, height_levels="three"), "height_levels"),
    "number as text": (lambda good: trial(good, height_levels="3"), "height_levels"),
    "unknown field": (lambda good: trial(good, __class__="os.system"), "__class__"),
    "unknown status": (lambda good: trial(good, status="won"), "status"),
    "no trial": (lambda good: edited(good, trials=[]), "trials"),
    "trial twice": (
        lambda good: edited(good, trials=json.loads(good.read_text())["trials"] * 2),
        "must occur once, but occurs again; remove",
    ),
    "negative share": (lambda good: edited(good, shares={"x": {"engine": 1, "readback": 1, "core": -1}}), "shares"),
    "half a share": (lambda good: edited(good, shares={"x": {"core": 1}}), "must be exactly the parts"),
    "negative tolerance": (lambda good: edited(good, tolerances={"x": {"levels": -1}}), "tolerances"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_a_file_that_is_no_baseline_is_refused_on_either_side(case, good, tmp_path) -> None:
    content, message = HOSTILE[case][0](good), HOSTILE[case][1]
    bad = tmp_path / "bad.json"
    bad.write_bytes(content if isinstance(content, bytes) else content.encode())
    before = sorted(tmp_path.iterdir())
    for sides in ((good, bad), (bad, good)):
        output = call("compare", *sides, "--markdown", tmp_path / "m.md", "--junit", tmp_path / "j.xml", status=2)
        assert output.startswith("error:")
        assert "bad.json" in output
        assert message in output
        assert len(output) < 1000  # no megabyte of somebody else's text on the terminal
    assert sorted(tmp_path.iterdir()) == before


def test_a_file_that_is_too_large_or_endless_is_not_read_whole(good, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(strict_json, "MOST_BYTES", 2**20)
    large = tmp_path / "large.json"
    with large.open("wb") as file:
        file.truncate(2**30)  # a gigabyte of nothing
    for endless in (large, "/dev/zero"):
        assert "at most 1 MiB, but is larger" in call("compare", good, endless, status=2)


@pytest.mark.parametrize("missing", ["no-such-file.json", "no-such-folder/"])
def test_what_is_not_there_is_reported(missing, good, tmp_path) -> None:
    assert "cannot read this file" in call("compare", good, tmp_path / missing, status=2)


def test_a_gate_that_does_not_exist_is_reported(good) -> None:
    assert "unknown gate 'outcom'; did you mean 'outcome'?" in call(
        "compare", good, good, "--fail-on", "outcom", status=2
    )


def test_a_baseline_replaces_a_baseline_and_nothing_else(make, good, tmp_path) -> None:
    write_baseline(make.side(make.record(height_levels=2)), good)
    assert read_baseline(good).trials[0].height_levels == 2
    other = tmp_path / "notes.json"
    other.write_text("{}")
    with pytest.raises(BaselineError, match="but is unreadable, damaged or of another kind: name another file"):
        write_baseline(make.side(), other)
    assert other.read_text() == "{}"
    with pytest.raises(BaselineError, match="must be a file, but is a folder"):
        write_baseline(make.side(), tmp_path)


def test_text_of_a_file_does_nothing_in_a_terminal_a_page_or_xml(make, good, tmp_path) -> None:
    """Names and messages may hold anything that JSON can hold."""
    nasty = "<img src=x> [link](http://x) [/red] | `x` @team \x1b[31m\u202e\nline" + "y" * 10_000
    names = {"trial": nasty, "message": nasty, "scene": nasty, "status": "crashed"}
    base = make.side(make.record(trial=nasty, scene=nasty), make.record())
    write_baseline(base, tmp_path / "base.json")
    write_baseline(make.side(make.record(**names), make.record()), tmp_path / "head.json")
    write_baseline(make.side(make.record(**names)), tmp_path / "failed.json")
    failed = call("compare", tmp_path / "base.json", tmp_path / "failed.json", status=2)
    assert "the only trial has no result" in failed
    assert not {"\x1b", "\u202e"} & set(failed)
    page, xml = tmp_path / "m.md", tmp_path / "j.xml"
    sides = (tmp_path / "base.json", tmp_path / "head.json")
    output = call("compare", *sides, "--markdown", page, "--junit", xml, status=1)
    message = page.read_text()
    for word in ("<img", "[link]", "](", "`x`", "@team", "\x1b", "\u202e"):
        assert word not in message
    assert "<img src=x> [link](http://x) [/red]" in html.unescape(message)  # and reads as it was written
    assert "\x1b" not in output
    assert "\u202e" not in output
    assert len(message) < 3000
    assert b"\x1b" not in xml.read_bytes()


def test_a_number_of_many_digits_a_deep_nest_and_a_lone_surrogate_are_no_surprise() -> None:
    assert parse(b'{"a": [1, 2.5, null, "x"]}', "") == {"a": [1, 2.5, None, "x"]}
    for content in (b"9" * 5000, b"[" * 5000, b"-Infinity", b"{"):
        with pytest.raises(JsonError):
            parse(content, "x")


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        ("trials.jsonl", "", "needs at least one trial, but the file contains none"),
        ("trials.jsonl", "[]\n", "not a trial record"),
        ("trials.jsonl", "{RECORD}\n{RECORD}\n", "must occur once, but occurs again; remove"),
        ("trials.jsonl", '{"seed": 1, {RECORD_BODY}\n', "key 'seed' must occur once in an object, but occurs again"),
        ("study.toml", "name = 1", "not the study file of a run"),
        ("study.toml", "a = " + "[" * 50_000, "not valid TOML"),
        ("environment.json", "[]", "not the environment file of a run"),
        ("environment.json", '{"processor": "P1"}', "not the environment file of a run"),
        ("frames/TRIAL.parquet", "PAR1", "not the frames of a trial"),
    ],
)
def test_a_results_folder_that_somebody_edited_is_refused(make, tmp_path, file, content, message) -> None:
    record = make.record(core_ms=0.1, timed_frames=100)
    line = record.model_dump_json()
    (tmp_path / "frames").mkdir()
    (tmp_path / "trials.jsonl").write_text(line + "\n")
    (tmp_path / "study.toml").write_text(
        'name = "ci"\n[limits]\ntrial_wall_s = 60\n[[scenario]]\nname = "four_stack"\n'
    )
    assert read_baseline(tmp_path).trials == [record]
    content = content.replace("{RECORD}", line).replace("{RECORD_BODY}", line[1:])
    (tmp_path / file.replace("TRIAL", record.trial)).write_text(content)
    with pytest.raises(BaselineError, match=message):
        read_baseline(tmp_path)
