"""Studies: the plan that they make, and errors that name the file, the field and the fix."""

import pytest

from bench.studies.plan import plan_trials
from bench.studies.policies import BENCH_POLICIES
from bench.studies.schema import StudyError, check_study, load_study, study_names
from bench.studies.selection import Selection, selected
from bench.studies.toml_text import to_toml
from reports.statistics.intervals import LEAST_RATIOS
from scenarios.lookup import UnknownNameError
from scenarios.model import Scene

VALID = {
    "name": "test",
    "engines": ["bullet"],
    "policies": ["none", "paper"],
    "scenario": [{"name": "card_house", "parameters": {"storeys": [1, 2]}}, {"name": "leaning_tower"}],
}


@pytest.mark.parametrize("name", study_names())
def test_every_study_that_comes_with_the_suite_is_valid_and_its_trials_have_ids_of_their_own(name: str) -> None:
    ids = [trial.id for trial in plan_trials(load_study(name))]
    assert ids
    assert len(set(ids)) == len(ids)


@pytest.mark.parametrize("name", study_names())
def test_a_study_that_measures_ratios_has_enough_pairs_of_them(name: str) -> None:
    study = load_study(name)
    assert not study.limits.ratio or study.seeds * study.repeats >= LEAST_RATIOS


def test_the_paper_study_has_a_side_that_must_stand_and_one_that_must_fall() -> None:
    scenes: list[Scene] = [trial.build_scene() for trial in plan_trials(load_study("paper"))]
    assert {scene.expectation.outcome for scene in scenes} == {"stand", "fall"}


def test_the_truth_study_has_every_engine_as_shipped_for_games_and_tuned() -> None:
    study = load_study("truth")
    trials = {(trial.engine, trial.profile) for trial in plan_trials(study)}
    assert trials == {(engine, profile) for engine in study.engines for profile in ("default", "game", "tuned")}


def test_another_description_makes_no_other_plan() -> None:
    study = check_study(VALID, "test")
    assert study.has_same_plan(study.model_copy(update={"description": "another text"}))
    assert not study.has_same_plan(study.model_copy(update={"name": "another"}))


def test_listed_values_make_a_variant_each() -> None:
    trials = plan_trials(check_study(VALID, "test"))
    assert [trial.id for trial in trials] == [
        "bullet.game.card_house.none.s0.r0",
        "bullet.game.card_house.paper.s0.r0",
        "bullet.game.card_house-2.none.s0.r0",
        "bullet.game.card_house-2.paper.s0.r0",
        "bullet.game.leaning_tower.none.s0.r0",
        "bullet.game.leaning_tower.paper.s0.r0",
    ]


def test_policies_on_one_stack_follow_each_other_in_alternating_order() -> None:
    """A B, B A: a machine that slows down during a study favours neither."""
    content = VALID | {"scenario": [{"name": "leaning_tower"}], "seeds": 2, "repeats": 2}
    trials = plan_trials(check_study(content, "test"))
    assert [(trial.seed, trial.repeat) for trial in trials[::2]] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert [trial.policy for trial in trials] == ["none", "paper", "paper", "none"] * 2


def test_rules_include_and_exclude() -> None:
    rules = {
        "engines": ["bullet", "mujoco"],
        "include": [{"scenarios": ["leaning_tower"]}, {"engines": ["mujoco"], "policies": ["paper"]}],
        "exclude": [{"engines": ["bullet"], "policies": ["none"]}],
    }
    trials = plan_trials(check_study(VALID | rules, "test"))
    assert {(trial.engine, trial.scenario, trial.policy) for trial in trials} == {
        ("bullet", "leaning_tower", "paper"),
        ("mujoco", "leaning_tower", "none"),
        ("mujoco", "leaning_tower", "paper"),
        ("mujoco", "card_house", "paper"),
    }


def test_a_profile_that_only_excluded_engines_lack_is_no_error() -> None:
    rules = {"profiles": ["game", "tuned"], "exclude": [{"engines": ["bullet"], "profiles": ["tuned"]}]}
    assert {trial.profile for trial in plan_trials(check_study(VALID | rules, "test"))} == {"game"}


def test_seeds_and_repeats_multiply_the_trials_and_seed_0_is_exact() -> None:
    trials = plan_trials(check_study(VALID | {"seeds": 3, "repeats": 2}, "test"))
    assert len(trials) == 6 * 3 * 2
    exact, noisy = (next(trial.build_scene() for trial in trials if trial.seed == seed) for seed in (0, 1))
    assert exact.bricks != noisy.bricks


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (
            {"engines": ["bulet"]},
            "field 'engines[0]': unknown engine 'bulet'; did you mean 'bullet'? Use one of bullet",
        ),
        ({"policies": ["papr"]}, "field 'policies[0]': unknown policy 'papr'; did you mean 'paper'?"),
        ({"scenario": [{"name": "four_stak"}]}, "field 'scenario[0].name': unknown scenario 'four_stak'; did you mean"),
        (
            {"scenario": [{"name": "four_stack", "parameters": {"level": 3}}]},
            "field 'scenario[0]': unknown parameter of four_stack 'level'; did you mean 'levels'?",
        ),
        (
            {"scenario": [{"name": "four_stack", "parameters": {"levels": 0}}]},
            "field 'scenario[0]': scenario four_stack: levels must be a whole number from 1",
        ),
        ({"profiles": ["gam"]}, "unknown profile of engine bullet 'gam'; did you mean 'game'?"),
        ({"profiles": ["game@scale=0"]}, "profile 'game@scale=0': scale must be a positive, finite number, got '0'"),
        ({"profiles": []}, "field 'profiles': must name at least one profile, because no sweep varies an engine"),
        ({"sweep": [{"engines": ["bullet"], "substeps": [0]}]}, "substeps must be a whole number from 1, got '0'"),
        ({"sweep": [{"engines": ["bullet"], "iterration": [1]}]}, "unknown field 'iterration'; did you mean"),
        ({"sceds": 3}, "unknown field 'sceds'; did you mean 'seeds'?"),
        ({"limits": {"trial_wal_s": 3}}, "unknown field 'trial_wal_s'; did you mean 'trial_wall_s'?"),
        (
            {"scenario": [{"name": "four_stack", "tolerance": {"level": 1}}]},
            "unknown field 'level'; did you mean 'levels'? Use one of levels",
        ),
        (
            {"scenario": [{"name": "four_stack", "tolerance": {"sink_m": -1}}]},
            "field 'scenario[0].tolerance.sink_m': must be 0.0 or more",
        ),
        ({"limits": {"trial_wall_s": 0}}, "field 'limits.trial_wall_s': must be above 0"),
        ({"seeds": 0}, "field 'seeds': must be 1 or more, got 0: correct this value"),
        (
            {"exclude": [{}]},
            "field 'exclude[0]': a rule needs at least one field, got none; remove the rule, or add one of: "
            "engines, profiles, policies, scenarios",
        ),
        ({"exclude": [{"engine": ["bullet"]}]}, "unknown field 'engine'; did you mean 'engines'?"),
        ({"include": [{"policies": ["papr"]}]}, "field 'include[0].policies[0]': unknown policy 'papr'"),
        ({"exclude": [{"engines": ["bullet"]}]}, "the rules of 'include' and 'exclude' must admit at least one trial"),
        ({"engines": []}, "field 'engines': must not be empty"),
        (
            {"engines": ["bullet", "bullet"]},
            "field 'engines': each entry must occur once, got bullet more than once",
        ),
        ({"name": "../x"}, "field 'name': must be letters, digits, '-' and '_'"),
        ({"repeats": "two"}, "field 'repeats': must be a whole number, without quotes"),
        ({"engines": "bullet"}, "field 'engines': must be a list in brackets"),
        ({"scenario": [{}]}, "field 'scenario[0].name': is missing"),
        (
            {"scenario": [{"name": "four_stack", "parameters": {"mu": True}}]},
            "field 'scenario[0].parameters.mu': must be a number, a text, or a list of numbers or texts, got True",
        ),
    ],
)
def test_an_invalid_study_names_the_file_the_field_and_the_fix(change: dict[str, object], complaint: str) -> None:
    with pytest.raises(StudyError) as error:
        check_study(VALID | change, "my.toml")
    assert str(error.value).startswith("my.toml: ")
    assert complaint in str(error.value)


def test_a_file_that_is_no_toml_is_named_with_the_line(tmp_path) -> None:
    file = tmp_path / "broken.toml"
    file.write_text("name = \n")
    with pytest.raises(StudyError, match=r"broken\.toml: not valid TOML.*line 1"):
        load_study(str(file))
    with pytest.raises(StudyError, match="cannot read this file"):
        load_study(str(tmp_path / "missing.toml"))
    with pytest.raises(UnknownNameError, match="did you mean 'paper'"):
        load_study("papr")


def test_a_sweep_sets_an_engine_up_in_every_combination() -> None:
    sweep = {"engines": ["bullet", "mujoco"], "profile": "tuned", "substeps": [1, 4], "iterations": [10, 50]}
    study = check_study(VALID | {"profiles": ["game"], "sweep": [sweep]}, "test")
    varied = ["iterations=10", "iterations=50"]
    expected = [("bullet", "game")] + [
        ("bullet", f"tuned@substeps={substeps},{one}") for substeps in (1, 4) for one in varied
    ]
    assert study.set_ups() == expected, "of the engines that the study has"
    assert selected(study, Selection(profiles=["default"])).set_ups() == [("bullet", "default")]


def test_the_resolved_study_reads_back_as_it_was(tmp_path) -> None:
    further = {"exclude": [{"policies": ["none"]}], "sweep": [{"engines": ["bullet"], "substeps": [1, 2]}]}
    study = check_study(VALID | {"description": 'quotes " and umlauts ü'} | further, "test")
    file = tmp_path / "study.toml"
    file.write_text(to_toml(study), encoding="utf-8")
    assert load_study(str(file)) == study
    tolerance = {"levels": 1, "creep_share": 0.25}
    study = check_study(VALID | {"scenario": [{"name": "leaning_tower", "tolerance": tolerance}]}, "test")
    file.write_text(to_toml(study), encoding="utf-8")
    assert load_study(str(file)) == study


def test_a_selection_narrows_a_study_and_keeps_its_parameters() -> None:
    study = selected(check_study(VALID, "test"), Selection(scenarios=["card_house", "brick_wall"], policies=["paper"]))
    assert [trial.scene for trial in plan_trials(study)] == ["card_house", "card_house-2", "brick_wall"]
    assert study.policies == ["paper"]
    with pytest.raises(UnknownNameError, match="did you mean 'bullet'"):
        selected(study, Selection(engines=["bulet"]))


def test_none_native_and_raised_run_the_engine_alone() -> None:
    assert {name for name, policy in BENCH_POLICIES.items() if not policy.is_steered} == {"none", "native", "raised"}
    assert all(policy.sleeping == "off" for policy in BENCH_POLICIES.values() if policy.is_steered)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scenario": [{"name": "four_stack"}, {"name": "four_stack"}]}, "got four_stack more than once"),
        ({"scenario": [{"name": "four_stack", "parameters": {"levels": [3, 3]}}]}, "got four_stack-3 more than once"),
        (
            {"scenario": [{"name": "four_stack", "parameters": {"levels": []}}]},
            "needs at least one value, got an empty list",
        ),
        ({"seeds": 10**9}, "must be 100000 or less"),
        ({"repeats": 10**9}, "must be 1000 or less"),
    ],
)
def test_a_plan_that_would_run_a_trial_twice_or_never_or_for_ever_is_refused(change, message) -> None:
    plain = {"name": "x", "engines": ["bullet"], "policies": ["none"], "scenario": [{"name": "four_stack"}]}
    with pytest.raises(StudyError, match=message):
        check_study(plain | change, "x.toml")


def test_a_study_says_how_long_its_trials_watch(tmp_path) -> None:
    plain, longer = check_study(VALID, "test"), check_study(VALID | {"watch_s": 600.0}, "test")
    assert {trial.planned_scene().watch_s for trial in plan_trials(plain)} == {5.0}
    assert {trial.planned_scene().watch_s for trial in plan_trials(longer)} == {600.0}
    file = tmp_path / "study.toml"
    file.write_text(to_toml(longer), encoding="utf-8")
    assert load_study(str(file)) == longer
    with pytest.raises(StudyError, match="watch_s"):
        check_study(VALID | {"watch_s": 0.0}, "test")


def test_hours_lengthen_the_watch_and_its_limit_alike() -> None:
    soak = load_study("soak")
    hour = selected(soak, Selection(hours=1.0))
    assert (soak.watch_s, hour.watch_s) == (600.0, 3600.0)
    assert hour.limits.trial_wall_s == 6 * soak.limits.trial_wall_s
    assert hour.limits.ratio == soak.limits.ratio
