"""Files of pytest-benchmark: frame ratios are compared, everything else is message."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from bench.cli.app import app
from bench.compare.baseline import write_baseline
from bench.compare.benchmarks import FORMAT, MOST, read_benchmarks

ROOT = Path(__file__).parents[3]
ALONE = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
"""The environment without the variables of a worker process, in which pytest-benchmark times nothing."""
SECONDS, FRAMES = 4, 5
PROCESSOR = """
def pytest_benchmark_update_machine_info(config, machine_info):
    machine_info["cpu"] = {"brand_raw": "P1"}
"""
TIMED = f"""
import os

import pytest

NOW = [0.0]


@pytest.mark.benchmark(timer=lambda: NOW[0])
@pytest.mark.parametrize("policy", ["none", "equilibrium"])
@pytest.mark.parametrize("levels", [5, 25])
def test_a_frame(benchmark, levels, policy):
    speeds = iter([1.0, 2.0, 1.5, 1.2] * 100)  # of the machine, from second to second
    alone_ms = []

    def frame():
        if frame.count % {FRAMES} == 0:
            frame.speed = next(speeds)
            alone_ms.append(2.0 * frame.speed)
        frame.count += 1
        NOW[0] += 1e-3 * frame.speed * (2.0 if policy == "none" else float(os.environ["FRAME_MS"]))

    frame.count = 0
    benchmark.pedantic(frame, rounds={SECONDS * FRAMES})
    benchmark.extra_info |= {{
        "format": "{FORMAT}", "engine": "bullet", "version": "1.0", "profile": "game", "scene": "plank_tower",
        "levels": levels, "policy": policy, "frames_per_second": {FRAMES},
    }}
    if policy != "none":
        benchmark.extra_info["alone_ms"] = alone_ms


def test_a_kernel(benchmark):
    benchmark.pedantic(lambda: None, rounds=3)
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Times frames by pytest-benchmark, with a scripted clock."""
    folder = tmp_path_factory.mktemp("benchmarks")
    (folder / "test_timed.py").write_text(TIMED)
    (folder / "conftest.py").write_text(PROCESSOR)

    def run(frame_ms: float) -> Path:
        path = folder / f"{frame_ms}.json"
        if not path.exists():
            command = [sys.executable, "-m", "pytest", "-q", "--rootdir", str(folder), f"--benchmark-json={path}"]
            environment = ALONE | {"FRAME_MS": str(frame_ms)}
            subprocess.run([*command, str(folder)], cwd=folder, env=environment, check=True, capture_output=True)
        return path

    return run


@pytest.fixture
def base(run) -> Path:
    return run(0.1)


def compare(*arguments: object, status: int) -> str:
    result = CliRunner().invoke(app, ["compare", *map(str, arguments)])
    assert result.exit_code == status, result.output
    return " ".join(result.output.split())


def judged(base: Path, head: Path, *options: str, status: int = 0) -> dict[str, tuple[str, str]]:
    """Judgement and reason of each finding."""
    found = json.loads(compare(base, head, *options, "--json", status=status))
    assert {one["gate"] for one in found["findings"]} == {"time"}
    return {one["trial"]: (one["judgement"], one["message"]) for one in found["findings"]}


def edited(path: Path, folder: Path, change) -> Path:
    """A copy of a file after ``change(content)``."""
    content = json.loads(path.read_text())
    change(content)
    copy = folder / "edited.json"
    copy.write_text(json.dumps(content))
    return copy


def steered(content) -> list[dict]:
    return [one for one in content["benchmarks"] if one["extra_info"].get("policy") == "equilibrium"]


# -- what is compared --------------------------------------------------------------------------------


def test_the_frame_ratio_does_not_depend_on_the_speed_of_the_machine(base) -> None:
    (low, high) = read_benchmarks(base).ratios.values()
    assert [*low, *high] == pytest.approx([0.05] * 2 * SECONDS)


def test_the_same_times_are_no_alarm(base) -> None:
    assert judged(base, base) == {
        "bullet.game.equilibrium / none": (
            "same",
            "1.00 (1.00-1.00) times the base (plank_tower-5 0.050, was 0.050; plank_tower-25 0.050, was 0.050)",
        )
    }
    assert "Frame ratio: time of a frame with the extension" in compare(base, base, status=0)


def test_a_planted_slowdown_is_found_and_fails_the_time_gate(base, run) -> None:
    slower = run(0.2)
    ((judgement, message),) = judged(base, slower, status=1).values()
    assert judgement == "worse"
    assert message.startswith("2.00 (2.00-2.00) times the base (plank_tower-5 0.100, was 0.050;")
    assert "1 alarm: 1 by time" in compare(base, slower, status=1)
    compare(base, slower, "--fail-on", "outcome", status=0)
    assert [judgement for judgement, _ in judged(slower, base).values()] == ["better"]


def test_a_machine_of_half_the_speed_is_no_slowdown(base, tmp_path) -> None:
    def slow_down(content) -> None:
        for one in content["benchmarks"]:
            one["stats"]["data"] = [2 * time for time in one["stats"]["data"]]
            if "alone_ms" in one["extra_info"]:
                one["extra_info"]["alone_ms"] = [2 * time for time in one["extra_info"]["alone_ms"]]

    assert [judgement for judgement, _ in judged(base, edited(base, tmp_path, slow_down)).values()] == ["same"]


def test_an_interrupted_frame_counts_for_little(base, tmp_path) -> None:
    def interrupt(content) -> None:
        for one in steered(content):
            one["stats"]["data"][FRAMES] *= 1000

    (low, _) = read_benchmarks(edited(base, tmp_path, interrupt)).ratios.values()
    assert max(low) < 0.05 * (1 + MOST / FRAMES)


# -- what is not -------------------------------------------------------------------------------------


def test_a_missing_pair_is_reported_and_the_rest_is_judged(base, tmp_path) -> None:
    fewer = edited(base, tmp_path, lambda content: content["benchmarks"].remove(steered(content)[1]))
    found = judged(base, fewer)
    name = "bullet.game.plank_tower-25.equilibrium"
    assert found[name] == ("open", "missing in the head")
    assert found["bullet.game.equilibrium / none"][0] == "same"
    assert judged(fewer, base)[name] == ("open", "new: not in the base")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda one: one["machine_info"].update(cpu={"brand_raw": "P2"}), "on P2, was on P1"),
        (lambda one: one["machine_info"].update(cpu={}), "its processor is unknown"),
    ],
)
def test_times_of_another_processor_are_not_compared(base, tmp_path, change, message) -> None:
    assert set(judged(base, edited(base, tmp_path, change)).values()) == {("open", message)}


def test_another_version_of_the_engine_is_compared_only_if_asked_for(base, tmp_path) -> None:
    def renew(content) -> None:
        for one in steered(content):
            one["extra_info"]["version"] = "2.0"

    newer = edited(base, tmp_path, renew)
    message = "bullet 2.0, was 1.0 (--across-versions compares them)"
    assert set(judged(base, newer).values()) == {("open", message)}
    assert [judgement for judgement, _ in judged(base, newer, "--across-versions").values()] == ["same"]


# -- files that cannot be used -----------------------------------------------------------------------


def _drop_rounds(content) -> None:
    for one in steered(content):
        del one["stats"]["data"]


def _drop_alone(content) -> None:
    for one in steered(content):
        del one["extra_info"]["alone_ms"]


def _only_kernels(content) -> None:
    content["benchmarks"] = [one for one in content["benchmarks"] if not one["extra_info"]]


def _rename_engine(content) -> None:
    for one in content["benchmarks"]:
        one["extra_info"]["engine"] = "other"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            _drop_rounds,
            "must contain the time of each round, but does not; create the file again with 'uv run pytest "
            "--benchmark-only --benchmark-save-data'",
        ),
        (_drop_alone, "must contain at least a second of frames with and without the extension, got "),
        (
            _only_kernels,
            "needs frame times with the extension, but the file contains none; create a file of frame times with",
        ),
        (
            lambda content: content["benchmarks"].append(steered(content)[0]),
            "must occur once, but occur again in benchmark",
        ),
        (lambda content: content.update(benchmarks=[1]), "not a complete file of pytest-benchmark"),
        (lambda content: content.update(benchmarks=1), "not a complete file of pytest-benchmark"),
        (lambda content: content["benchmarks"][0].pop("extra_info"), "not a complete file of pytest-benchmark"),
        (lambda content: steered(content)[0]["stats"].update(data=[-1.0]), "benchmarks.1.stats.data.0"),
        (_rename_engine, "must contain frame times of a common stack with the extension"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_with_the_reason(base, tmp_path, change, message) -> None:
    bad = edited(base, tmp_path, change)
    for sides in ((base, bad), (bad, base)):
        output = compare(*sides, status=2)
        assert output.startswith("error:")
        assert message in output


def test_benchmarks_and_trials_are_not_mixed(base, make, tmp_path) -> None:
    trials = tmp_path / "baseline.json"
    write_baseline(make.side(), trials)
    for other in (trials, tmp_path):  # a file, a folder
        for sides in ((base, other), (other, base)):
            message = f"{base} is a file of pytest-benchmark and {other} is not: name two files of pytest-benchmark"
            assert message in compare(*sides, status=2)


# -- the suite's own ---------------------------------------------------------------------------------


def test_the_suites_own_benchmarks_are_run_and_saved_by_benchmark_only(tmp_path) -> None:
    command = [sys.executable, "-m", "pytest", "-q", "--benchmark-only", f"--benchmark-storage={tmp_path}"]
    command += ["-p", "no:cacheprovider", "tests/benchmarks/test_frame_speed.py", "-k", "mujoco-5-"]
    subprocess.run(command, cwd=ROOT, env=ALONE, check=True, capture_output=True)
    (path,) = tmp_path.rglob("*.json")
    (cell,) = read_benchmarks(path).ratios
    assert str(cell) == "mujoco.game.plank_tower-5.equilibrium"
    (message,) = [one["extra_info"] for one in steered(json.loads(path.read_text()))]
    assert set(message["mean_ms"]) == {"engine", "readback", "core", "port"}
    assert len(message["calibration_ms"]) == len(message["alone_ms"])
    compare(path, path, status=0)
