"""The table of the tilt test: the slope at which a stack first moves, and the limits by exact statics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from reports.records.trial import TrialRecord
from reports.statistics.groups import groups_of
from reports.tables.table import NOTHING, Table
from scenarios.model import Scene, Tilt
from scenarios.registry import build
from scenarios.scenes.tilt_test import THETA, TiltLimits, tilt_limits

TITLE = "Onset on tilting ground"
"""Title of the table."""
SCENARIO = "tilt_test"
"""Name of the scenario."""
NEAR_DEG = 0.25
"""Greatest difference between an onset and a limit with which the onset agrees [deg]. On ground that tilts at 0.1
deg/s, the onset comes 0.02 to 0.1 deg after the limit, because an onset is a motion by 1 % of a thickness or a turn by
half a degree. The greatest difference is less than half a degree, so that an error of half a degree shows."""
NAMED_DEG = 2.0
"""Greatest difference [deg] between the angles of a ridge's normal and of a named normal to the bisector, up to which
the table shows the name instead of the angle."""


class Onset(NamedTuple):
    """Onset of motion in one trial, with the limits of its stack."""

    trial: TrialRecord
    limits: TiltLimits
    """Limit slopes by exact statics [deg]."""
    own_deg: float | None
    """Limit slope by exact statics with the engine's own contacts [deg], from its trial without an extension; None if
    unknown."""
    ridge_deg: float | None
    """Greatest angle between the engine's normal at a ridge and the bisector [deg]; None without a ridge."""
    fall_deg: float | None
    """Slope when the collapse was first seen [deg]; None without a collapse."""

    @property
    def exact_deg(self) -> float:
        """Limit slope by exact statics, with the bisector as the normal of a ridge [deg]."""
        return self.limits.exact

    @property
    def depends_on_ridge(self) -> bool:
        """True if the limit slope depends on the normal of a ridge, which engines choose differently."""
        return len(set(self.limits)) > 1

    @property
    def off_deg(self) -> float | None:
        """Onset minus the nearer of the limits ``exact_deg`` and ``own_deg`` [deg]; None without an onset."""
        onset = self.trial.onset_deg
        if onset is None:
            return None
        limits = [self.exact_deg] if self.own_deg is None else [self.exact_deg, self.own_deg]
        return min((onset - limit for limit in limits), key=abs)

    @property
    def is_near(self) -> bool:
        """True if the onset differs from a limit by at most ``NEAR_DEG``."""
        return self.off_deg is not None and abs(self.off_deg) <= NEAR_DEG


def onsets_of(records: Sequence[TrialRecord]) -> list[Onset]:
    """Return the onset of each trial of the tilt test, in the order of the groups."""
    tilted = [record for record in records if record.scenario == SCENARIO]
    own = {(one.scene, one.engine, one.profile): one for one in tilted if one.ridge_deg or one.own_limit_deg}
    found = []
    for group in groups_of(tilted):
        scene = build(SCENARIO, **group.trials[0].parameters)
        alone = own.get(group.key[:3])
        for trial in group.trials:
            exact = tilt_limits(str(trial.parameters["stack"]), str(trial.parameters["heading"]))
            fall = None if trial.collapse_s is None else slope_at(scene, trial.collapse_s)
            own_limits = (alone.own_limit_deg, alone.ridge_deg) if alone else (None, None)
            found.append(Onset(trial, exact, *own_limits, fall))
    return found


def slope_at(scene: Scene, time: float) -> float:
    """Return the slope of the ground of a scene at ``time`` [s], in degrees; all tilts must have the same axis."""
    tilts = [action for action in scene.actions if isinstance(action, Tilt)]
    return sum(tilt.speed * min(max(time - tilt.time, 0.0), tilt.seconds) for tilt in tilts)


def tilt_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """Return the table of the tilt test in a list, which is empty without trials of the tilt test."""
    found = onsets_of(records)
    if not found:
        return []
    header = (
        *("stack", "heading", "engine", "profile", "policy"),
        *("exact", "own contacts", "ridge", "onset", "fall", "off"),
    )
    notes = (
        "Slopes in degrees. Exact: by statics of the ideal stack. Own contacts: by statics with the points and normals "
        "that the engine itself shows at rest. Ridge: its normal where two planks lean against each other: that of the "
        "edges, which is their bisector, that of a plank's face, or so many degrees off the bisector.",
        "Onset: a brick had moved by 1 % of its thickness or turned by half a degree. Fall: the collapse was seen.",
        f"Off: onset less the nearer of both limits, ✓ within {NEAR_DEG:g}; engines that creep or yield move before.",
    )
    return [Table(TITLE, header, tuple(map(_row, found)), notes, id="tilt")]


def _row(one: Onset) -> tuple[str, ...]:
    trial = one.trial
    off = NOTHING if one.off_deg is None else f"{one.off_deg:+.2f}{' ✓' if one.is_near else ''}"
    return (
        *(str(trial.parameters[name]) for name in ("stack", "heading")),
        *(trial.engine, trial.profile, trial.policy),
        *(_degrees(value) for value in (one.exact_deg, one.own_deg)),
        _ridge(one.ridge_deg),
        *(_degrees(value) for value in (trial.onset_deg, one.fall_deg)),
        off,
    )


def _degrees(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2f}"


def _ridge(angle: float | None) -> str:
    """Return the name of a ridge's normal from its angle to the bisector [deg], or the angle as text."""
    if angle is None:
        return NOTHING
    names = {"edge": 0.0, "face": 90.0 - THETA}
    return next((name for name, named in names.items() if abs(angle - named) <= NAMED_DEG), f"{angle:.0f} off")
