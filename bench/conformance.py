"""Holds one engine's adapter to the contract, check by check, and tells each."""

from __future__ import annotations

from rich.console import Console

from adapters import profile_named
from adapters.conformance import CHECKS


def check_engine(engine: str, profile: str, console: Console) -> int:
    """Run every check that applies and print how it went; returns how many failed.

    Raises:
        UnknownNameError: if there is no such engine, or the engine has no such profile.
        ProfileError: if a variation of the profile is not what it must be.
        EngineNotInstalledError: if its package is missing.
    """
    profile_named(engine, profile)  # a name that is wrong is told once, not by every check
    failed = 0
    for check in CHECKS:
        promise = check.name.replace("_", " ")
        if not check.applies(engine, profile):
            console.print(f"n/a     {promise}", markup=False, highlight=False)
            continue
        try:
            check.run(engine, profile)
        except Exception as error:  # an engine may fail a check in any way, and the others are still worth running
            failed += 1
            console.print(f"FAILED  {promise}: {error}", markup=False, highlight=False, soft_wrap=True)
        else:
            console.print(f"ok      {promise}", markup=False, highlight=False)
    return failed
