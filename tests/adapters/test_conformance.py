"""Every engine keeps the contract, as shipped and set up for a game."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from adapters import ENGINES, capabilities
from adapters.conformance import CHECKS, Check

ROOT = Path(__file__).parents[2]
TUMBLE = """
import hashlib, sys
from adapters import open_engine
from adapters.conformance.housekeeping import tumble
print("poses", hashlib.blake2b(tumble(open_engine(sys.argv[1], sys.argv[2]))).hexdigest())
"""


def skip_without_adapter(engine: str) -> None:
    """An engine may be announced before its adapter is written; once the file is there, an import error fails."""
    if importlib.util.find_spec(ENGINES[engine].module) is None:
        pytest.skip(f"{ENGINES[engine].module} is not written yet")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)
@pytest.mark.parametrize("profile", ["game", "default"])
@pytest.mark.parametrize("engine", ENGINES)
def test_engine_keeps_the_contract(engine: str, profile: str, check: Check) -> None:
    skip_without_adapter(engine)
    if not check.applies(engine, profile):
        pytest.skip("not asked of this engine under this profile")
    check.run(engine, profile)


@pytest.mark.parametrize("engine", ENGINES)
def test_two_processes_agree_bit_for_bit(engine: str) -> None:
    skip_without_adapter(engine)
    if capabilities(engine).deterministic != "across processes":
        pytest.skip("not promised")
    command = [sys.executable, "-c", TUMBLE, engine, "game"]
    runs = [subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout for _ in range(2)]
    first, second = ([line for line in run.splitlines() if line.startswith("poses")] for run in runs)
    assert first == second != []
