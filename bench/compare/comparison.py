"""Compare two sides trial by trial: gates judge comparable trials; for other trials, a finding gives the reason."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence

from bench.compare.determinism import judge_poses, other_processor
from bench.compare.failures import failed_engines, require_results
from bench.compare.findings import Comparison, Finding, Judgement, plain
from bench.compare.outcomes import judge_draws, judge_outcome, values_of
from bench.compare.side import Baseline, Machine
from bench.compare.timing import PARTS, Part, judge_times
from bench.studies.tolerance import Tolerance
from reports.records.trial import TrialRecord
from scenarios.registry import with_defaults


class NothingInCommonError(ValueError):
    """Two sides without a common trial, so that a comparison can state neither a pass nor a regression."""


Pair = tuple[TrialRecord, TrialRecord]
"""The records of one trial in base and head."""


def compare_runs(
    base: Baseline,
    head: Baseline,
    names: tuple[str, str],
    *,
    across_versions: bool = False,
    poses: bool = False,
    require_all: bool = False,
) -> Comparison:
    """Return the findings of all gates for ``head``, compared with ``base``.

    Args:
        base: the expected run.
        head: the run to judge; its study gives the tolerances.
        names: names of base and head, for the messages.
        across_versions: True to compare outcomes and times of different versions of an engine.
        poses: True to compare poses of different versions of an engine as well.
        require_all: True to raise an alarm for each trial of the base that the head lacks.

    Raises:
        SideFailedError: if no trial of a side has a result.
        NothingInCommonError: if no trial is in both runs.
        BaselineError: if a pose trace is unreadable.
    """
    across_versions |= poses
    require_results(base, names[0])
    require_results(head, names[1])
    before = {record.trial: record for record in base.trials}
    now = {record.trial: record for record in head.trials}
    pairs = [(before[trial], now[trial]) for trial in before if trial in now]
    if not pairs:
        raise NothingInCommonError(
            f"{names[0]} and {names[1]} have no trial in common; for example, {names[0]} has "
            f"{plain(next(iter(before)))} and {names[1]} has {plain(next(iter(now)))}: compare runs of the same study, "
            "engines and profiles"
        )
    missing = [trial for trial in before if trial not in now]
    lost: Judgement = "worse" if require_all else "open"
    findings = [Finding("outcome", trial, lost, f"missing in {names[1]}") for trial in missing]
    findings += [Finding("outcome", trial, "open", f"new: not in {names[0]}") for trial in now if trial not in before]
    failed = failed_engines(base)
    findings += [Finding("outcome", engine, "open", f"in {names[0]} {why}") for engine, why in failed.items()]
    comparable = []
    for base_trial, head_trial in pairs:
        if base_trial.engine in failed:
            continue
        why = _incomparable(base, head, base_trial, head_trial, across_versions)
        if why is None:
            comparable.append((base_trial, head_trial))
        else:
            findings.append(Finding("outcome", head_trial.trial, "open", why))
    findings += _outcomes(base, head, comparable)
    hashed = list(_trajectories(base, head, comparable, poses))
    same_way = {finding.trial for finding in hashed if finding.judgement == "same"}
    findings += hashed
    findings += _times(base, head, comparable, same_way)
    notes = tuple(_differences(base, head))
    return Comparison(*names, tuple(findings), notes, missing=len(missing), expected=len(before))


def _incomparable(
    base: Baseline, head: Baseline, base_trial: TrialRecord, head_trial: TrialRecord, across_versions: bool
) -> str | None:
    """Return the reason that excludes two trials with the same id from the comparison; None without a reason."""
    if _scene(base_trial) != _scene(head_trial):
        return "another scene under the same name"
    if base_trial.engine_version != head_trial.engine_version and not across_versions:
        versions = f"{head_trial.engine_version}, was {base_trial.engine_version}"
        return f"{head_trial.engine} {versions} (--across-versions compares them)"
    is_limited = {"base": base.is_limited(base_trial), "head": head.is_limited(head_trial)}
    limited = [name for name in is_limited if is_limited[name]]
    return f"stopped by its time limit in {' and '.join(limited)}" if limited else None


def _scene(record: TrialRecord) -> tuple[object, ...]:
    expectation = record.expectation
    return (
        record.scenario,
        record.scene,
        sorted(with_defaults(record.scenario, record.parameters).items()),
        record.levels_planned,
        expectation.outcome,
        expectation.level,
    )


def _outcomes(base: Baseline, head: Baseline, pairs: Sequence[Pair]) -> Iterator[Finding]:
    draws: dict[str, list[Pair]] = defaultdict(list)
    for base_trial, head_trial in pairs:
        if base.repeats_itself(base_trial) and head.repeats_itself(head_trial):
            judged = judge_outcome(base_trial, head_trial, _tolerance(head, head_trial))
            yield Finding("outcome", head_trial.trial, *judged, values_of([base_trial]), values_of([head_trial]))
        else:
            draws[head_trial.trial.rpartition(".r")[0]].append((base_trial, head_trial))
    for name, group in draws.items():
        before, now = zip(*group, strict=True)
        judged = judge_draws(before, now, _tolerance(head, now[0]))
        yield Finding("outcome", name, *judged, values_of(before), values_of(now))


def _trajectories(base: Baseline, head: Baseline, pairs: Sequence[Pair], across: bool) -> Iterator[Finding]:
    for base_trial, head_trial in pairs:
        if base.repeats_itself(base_trial) and head.repeats_itself(head_trial):
            yield Finding(
                "hash", head_trial.trial, *judge_poses(base_trial, head_trial, (base, head), across_versions=across)
            )


def _times(base: Baseline, head: Baseline, pairs: Sequence[Pair], same_way: Collection[str]) -> Iterator[Finding]:
    """Yield one finding for each engine, profile, part of a frame and reference part.

    For an engine and a profile without a reference part, the function yields one open finding.
    """
    groups: dict[str, list[Pair]] = defaultdict(list)
    for base_trial, head_trial in pairs:
        if base_trial.trial in base.shares and head_trial.trial in head.shares:
            groups[f"{head_trial.engine}.{head_trial.profile}"].append((base_trial, head_trial))
    for name, group in sorted(groups.items()):
        figures: dict[str, list[tuple[float, float]]] = defaultdict(list)
        for base_trial, head_trial in group:
            machines = base.machine(base_trial), head.machine(head_trial)
            is_same_engine = base_trial.engine_version == head_trial.engine_version
            yardstick = _yardstick(*machines, is_same_engine and head_trial.trial in same_way)
            if yardstick is not None:
                before, now = base.shares[base_trial.trial], head.shares[head_trial.trial]
                for part in PARTS:
                    if part != yardstick:
                        figure = f"{name}.{part} / {yardstick}"
                        figures[figure].append((before[part] / before[yardstick], now[part] / now[yardstick]))
        if not figures:
            yield Finding("time", name, "open", "no reference part: the core and the engine's work both differ")
        least = max(_tolerance(head, head_trial).time_share for _, head_trial in group)
        for figure, ratios in figures.items():
            yield Finding("time", figure, *judge_times(ratios, least))


def _yardstick(base: Machine | None, head: Machine | None, did_same_work: bool) -> Part | None:
    """Return the reference part: the part of a frame that is the same in base and head.

    Returns:
        The first case that applies:

        - None for different or unknown processors;
        - ``core`` if both sides run the same code;
        - ``engine`` if the engine's version and all poses are the same;
        - None otherwise.
    """
    if base is None or head is None or other_processor(base, head) is not None:
        return None
    if base.runs_same_code(head):
        return "core"
    return "engine" if did_same_work else None


def _tolerance(head: Baseline, record: TrialRecord) -> Tolerance:
    return head.tolerances.get(record.scenario, Tolerance())


def _differences(base: Baseline, head: Baseline) -> Iterator[str]:
    """Yield the differences between the runs as a whole: processors, platforms, versions, commits, missing settings."""
    before, now = _circumstances(base), _circumstances(head)
    for what in dict.fromkeys([*before, *now]):
        was, are = (", ".join(sorted(side.get(what, {"unknown"}))) for side in (before, now))
        if was != are:
            yield f"{what}: {are}, was {was}"


def _circumstances(side: Baseline) -> dict[str, set[str]]:
    """Return the sets of processors, platforms, versions, commits and missing settings of a side, by property."""
    properties: dict[str, set[str]] = defaultdict(set)
    for machine in side.present_machines.values():
        properties["processor"].add(machine.processor)
        properties["platform"].add(machine.platform)
        properties["Python"].add(machine.python)
        properties["commit"].add((machine.commit or "unknown")[:12] + (" with changes" if machine.modified else ""))
        for name, version in machine.packages.items():
            properties[name].add(version)
        for name, engine in machine.engines.items():
            properties[name].add(engine.version)
            properties[f"settings that {name} does not have"].add(", ".join(engine.missing_knobs) or "none")
    return properties
