"""Thousands of trials: what the harness itself costs. By hand, on a machine that does nothing else.

uv run pytest -m slow tests/bench/execution/test_scale.py --junit-xml=figures.xml
"""

import subprocess
import time

import psutil
import pytest

from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord, read_records
from reports.report import write_tables
from reports.tables.repeatability import repeat_tables
from reports.tables.study import study_tables
from scenarios.model import Expectation

OVERHEAD_S = 0.05
"""Wall time a trial [s] that the harness may take on two cores."""
READ_S = 30.0
"""Time [s] in which a hundred thousand records are read and tabulated."""


@pytest.mark.slow
def test_ten_thousand_trials_cost_little_time_and_no_memory(rogue_suite, record_testsuite_property) -> None:
    count = 10_000
    rogue_suite.write_study(seeds=count)
    path = rogue_suite.out / "trials.jsonl"
    sizes, begin, first = [], None, 0
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with rogue_suite.start("--jobs", "2", "--json", **silent) as run:
        while run.poll() is None:
            kept = path.read_bytes().count(b"\n") if path.exists() else 0
            if kept and begin is None:
                begin, first = time.perf_counter(), kept
            if kept >= count:
                break
            if kept > count // 10:
                sizes.append(psutil.Process(run.pid).memory_info().rss)
            time.sleep(1.0)
        assert begin is not None
        wall_s = (time.perf_counter() - begin) / (count - first)
    records = read_records(path)
    inside_s = sum(record.wall_s or 0 for record in records) / 2 / count  # two at a time
    figures = {"wall_s": wall_s, "inside_s": inside_s, "first_mib": sizes[0] >> 20, "most_mib": max(sizes) >> 20}
    for name, value in figures.items():
        record_testsuite_property(name, value)
    assert len(records) == count
    assert wall_s - inside_s <= OVERHEAD_S, figures
    assert max(sizes) - sizes[0] <= 16 * 2**20  # the ids of what is finished, and what is left to do


@pytest.mark.slow
def test_a_hundred_thousand_records_are_read_and_tabulated(tmp_path, record_testsuite_property) -> None:
    path = tmp_path / "trials.jsonl"
    lines = [record(number).model_dump_json() for number in range(100_000)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    begin = time.perf_counter()
    records = read_records(path)
    read = time.perf_counter()
    write_tables(ResultsFolder(tmp_path), [*study_tables(records), *repeat_tables(tmp_path, records)])
    end = time.perf_counter()
    record_testsuite_property("read_s", read - begin)
    record_testsuite_property("tabulated_s", end - read)
    assert end - begin <= READ_S


def record(number: int) -> TrialRecord:
    engine, policy = ("bullet", "mujoco", "dart", "pymunk")[number % 4], ("none", "paper")[number // 4 % 2]
    scene, seed = f"four_stack-{number // 8 % 25}", number // 200
    return TrialRecord(
        trial=f"{engine}.game.{scene}.{policy}.s{seed}.r0",
        engine=engine,
        engine_version="1.0",
        profile="game",
        unit_scale=1.0,
        scenario="four_stack",
        scene=scene,
        parameters={"levels": number // 8 % 25},
        policy=policy,
        seed=seed,
        repeat=0,
        status="completed",
        levels_placed=25,
        height_levels=25,
        height_m=0.2,
        frame_ms_p50=0.5,
        frame_ms_p95=0.7,
        frame_ms_p99=0.9,
        frame_ms_max=2.0,
        engine_ms=0.4,
        frame_ratio=0.5,
        frame_ratio_level=25,
        pose_hash="0" * 32,
        expectation=Expectation("stand", "always in equilibrium"),
        verdict="right",
        environment="abc",
        levels_planned=25,
        timed_frames=600,
        calibration_ms=0.3,
        host="here",
    )
