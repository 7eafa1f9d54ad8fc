"""Optional engines: the suite's studies run without them where they are not installed, and say so."""

import pytest

from adapters import ENGINES, EngineNotInstalledError
from bench.studies import selection
from bench.studies.plan import plan_trials
from bench.studies.schema import load_study
from bench.studies.selection import default_part, installed_part

OPTIONAL = {"jolt", "havok", "ode"}


def missing(*engines: str):
    """Return a check of the installation in which these engines are missing."""

    def check(engine: str) -> None:
        if engine in engines:
            raise EngineNotInstalledError(f"engine '{engine}' cannot be loaded: {ENGINES[engine].remedy}")

    return check


def test_the_optional_engines_are_those_of_optional_dependency_groups() -> None:
    assert {name for name, entry in ENGINES.items() if entry.is_optional} == OPTIONAL


def test_a_study_runs_without_its_missing_optional_engines_and_says_how_to_install_them(monkeypatch) -> None:
    monkeypatch.setattr(selection, "check_installed", missing("jolt", "ode"))
    study = load_study("issues")
    assert study.engines[-3:] == ["jolt", "havok", "ode"]
    part, reasons = installed_part(study)
    assert part.engines == [engine for engine in study.engines if engine not in {"jolt", "ode"}]
    assert {trial.engine for trial in plan_trials(part)} == set(part.engines)
    assert ["adapters.wasm" in reasons[0], "--group ode" in reasons[1]] == [True, True]


def test_a_study_with_all_engines_installed_stays_as_it_is(monkeypatch) -> None:
    monkeypatch.setattr(selection, "check_installed", missing())
    study = load_study("issues")
    assert installed_part(study) == (study, [])


@pytest.mark.parametrize(
    "engines",
    [{"bullet"}, OPTIONAL | {"bullet", "mujoco", "dart", "physx", "rapier", "box3d"}],
    ids=["an engine that is not optional", "every engine"],
)
def test_other_missing_engines_are_errors(engines, monkeypatch) -> None:
    monkeypatch.setattr(selection, "check_installed", missing(*engines))
    with pytest.raises(EngineNotInstalledError, match=r"cannot be loaded: install"):
        installed_part(load_study("issues"))


def test_a_comparison_of_versions_leaves_optional_engines_out() -> None:
    assert not OPTIONAL & set(default_part(load_study("issues")).engines)
