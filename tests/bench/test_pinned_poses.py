"""Deterministic engines still compute what they did, to the last bit: the hashes of their poses are pinned.

Of the engine alone, on a tower of three planks: what the core decides may change, what an engine computes may not,
unless its version does. To pin those of a new version or another kind of machine, run this file as a program. The maker
of the processor counts: PhysX takes the processor's own approximate reciprocal roots, which differ between makers.

In a fresh process, as every trial of a study: Bullet's results depend on the worlds that a process had before.
"""

import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

from adapters import ENGINES, capabilities
from bench.machine.environment import engine_version
from bench.studies.plan import Trial
from bench.studies.schema import Limits
from bench.trial.run_trial import run_trial

PINNED = Path(__file__).parent / "pinned_poses.json"
DETERMINISTIC = [name for name in ENGINES if capabilities(name).deterministic == "across processes"]


def processor_maker() -> str:
    """As Linux names it; elsewhere what Python knows of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("vendor_id")), "unknown maker")


def key(engine: str) -> str:
    return f"{engine} {engine_version(engine)} {platform.system()} {platform.machine()} {processor_maker()}"


def pose_hash(engine: str, repeat: int = 0) -> str | None:
    trial = Trial(engine, "game", "leaning_tower", "leaning_tower-3", {"levels": 3}, "none", 1, repeat)
    return run_trial(trial, Limits(trial_wall_s=3600), "abc", lambda _: None).record.pose_hash


def pose_hash_in_a_fresh_process(engine: str) -> str:
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    command = [sys.executable, __file__, engine]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return run.stdout.strip()


@pytest.mark.parametrize("engine", DETERMINISTIC)
def test_an_engine_computes_what_it_did(engine: str) -> None:
    pinned = json.loads(PINNED.read_text(encoding="utf-8"))
    if key(engine) not in pinned:
        pytest.skip(f"nothing is pinned for {key(engine)}")
    assert pose_hash_in_a_fresh_process(engine) == pinned[key(engine)]


@pytest.mark.parametrize("engine", DETERMINISTIC)
def test_repeats_go_the_same_way(engine: str) -> None:
    assert pose_hash(engine, 0) == pose_hash(engine, 1)


if __name__ == "__main__" and sys.argv[1:]:
    print(pose_hash(sys.argv[1]))  # noqa: T201 - the answer to the test that asked
elif __name__ == "__main__":
    known = json.loads(PINNED.read_text(encoding="utf-8")) if PINNED.exists() else {}
    known |= {key(engine): pose_hash(engine) for engine in DETERMINISTIC}
    PINNED.write_text(json.dumps(known, indent=2, sort_keys=True) + "\n", encoding="utf-8")
