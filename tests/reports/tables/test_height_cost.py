"""What height costs: which frames count, and which set-ups are compared."""

from __future__ import annotations

from pathlib import Path

from reports.records.frames import UNTIMED_FRAMES, FrameRow, write_frames
from reports.records.trial import TrialRecord
from reports.statistics.height_cost import cost_points
from reports.tables.height_cost import cost_table
from tests.reports.studies import record


def trial(folder: Path, profile: str, levels: int, *frames: tuple[int, float], timed: int, **fields) -> TrialRecord:
    """A record, and its frames after the untimed ones: the level of each, and its time [ms]."""
    name = f"bullet.{profile}.plank_tower.none.s0.r0"
    rows = [(1, 99.0)] * UNTIMED_FRAMES + [*frames]
    (folder / "frames").mkdir(exist_ok=True)
    write_frames(
        folder / "frames" / f"{name}.parquet",
        [FrameRow(i, i / 60, level, level, level, ms, ms) for i, (level, ms) in enumerate(rows)],
    )
    return record(
        profile=profile,
        scene="plank_tower",
        levels_planned=3,
        height_levels=levels,
        timed_frames=timed,
        **fields,
    )


def test_a_point_is_the_median_frame_of_the_highest_level_while_it_stood(tmp_path) -> None:
    records = [
        trial(tmp_path, "game", 2, (1, 1.0), (2, 2.0), (2, 3.0), (2, 4.0), (2, 90.0), timed=4, status="collapsed"),
        trial(tmp_path, "tuned", 3, (2, 5.0), (3, 7.0), timed=2, status="timeout"),
        trial(tmp_path, "default", 0, (1, 1.0), timed=1, status="collapsed"),
    ]
    points = cost_points(tmp_path, records)
    assert [(p.profile, p.levels, p.frame_ms, p.is_bound) for p in points] == [
        ("game", 2, 3.0, False),
        ("tuned", 3, 7.0, True),
    ]
    assert cost_table(points).rows == (
        ("plank_tower", "bullet", "game", "2/3", "3.000"),
        ("plank_tower", "bullet", "tuned", "≥3/3", "7.000"),
    )


def test_two_set_ups_are_no_comparison_of_costs(tmp_path) -> None:
    records = [trial(tmp_path, name, 1, (1, 1.0), timed=1) for name in ("game", "tuned")]
    assert cost_points(tmp_path, records) == []
