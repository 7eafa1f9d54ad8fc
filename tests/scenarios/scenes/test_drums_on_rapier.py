"""Why one pair of hexagonal drums is missed on Rapier: two drums rock there, though nothing topples them.

Rapier lists one or two of the six corners between the drums, and changes them from step to step.
"""

import pytest

from tests.scenarios.played import played


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "shape", "rocks"),
    [("rapier", "hexagon", True), ("rapier", "cylinder", False), ("bullet", "hexagon", False)],
)
def test_only_hexagons_on_rapier_rock(engine, shape, rocks):
    """Drums of 0.6 m at rest creep by less than 0.1 mm/s; those that rock, by more than 1 mm/s."""
    parameters = {"shape": shape, "drums": 2, "margin": 0.3, "scale": 20.0}
    record = played(engine, "tuned", "leaning_drums", parameters, "none")
    assert record.status == "completed"
    assert (record.creep_m_s > 1e-3) if rocks else (record.creep_m_s < 1e-4)
