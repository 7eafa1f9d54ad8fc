"""Deterministic engines still compute what they did, to the last bit: the hashes of their poses are pinned.

Of the engine alone, on a tower of three planks: what the core decides may change, what an engine computes may not,
unless its version does. To pin those of a new version or another kind of machine, run this file as a program.
"""

import json
import platform
from pathlib import Path

import pytest

from adapters import ENGINES, capabilities
from bench.environment import engine_version
from bench.plan import Trial
from bench.studies import Limits
from bench.trial import run_trial

PINNED = Path(__file__).parent / "pinned_poses.json"
DETERMINISTIC = [name for name in ENGINES if capabilities(name).deterministic == "across processes"]


def key(engine: str) -> str:
    return f"{engine} {engine_version(engine)} {platform.system()} {platform.machine()}"


def pose_hash(engine: str, repeat: int = 0) -> str | None:
    trial = Trial(engine, "game", "leaning_tower", "leaning_tower-3", {"levels": 3}, "none", 1, repeat)
    return run_trial(trial, Limits(), "abc", lambda _: None).record.pose_hash


@pytest.mark.parametrize("engine", DETERMINISTIC)
def test_an_engine_computes_what_it_did(engine: str) -> None:
    pinned = json.loads(PINNED.read_text(encoding="utf-8"))
    if key(engine) not in pinned:
        pytest.skip(f"nothing is pinned for {key(engine)}")
    assert pose_hash(engine) == pinned[key(engine)]


@pytest.mark.parametrize("engine", DETERMINISTIC)
def test_repeats_go_the_same_way(engine: str) -> None:
    assert pose_hash(engine, 0) == pose_hash(engine, 1)


if __name__ == "__main__":
    known = json.loads(PINNED.read_text(encoding="utf-8")) if PINNED.exists() else {}
    known |= {key(engine): pose_hash(engine) for engine in DETERMINISTIC}
    PINNED.write_text(json.dumps(known, indent=2, sort_keys=True) + "\n", encoding="utf-8")
