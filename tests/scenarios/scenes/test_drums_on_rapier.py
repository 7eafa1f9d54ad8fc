"""Why the adapter of Rapier cuts hexagonal drums into pieces: as one hull two drums rock, though nothing topples them.

Parry uses the first four vertices of a face. Those of a hexagon cover half of its area, and end below the centre.
"""

import pytest

import adapters._rapier_world
from tests.scenarios.played import played


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "vertices", "rocks"), [("hexagon", 4, False), ("hexagon", 6, True), ("cylinder", 4, False)]
)
def test_only_hexagons_as_one_hull_rock(shape, vertices, rocks, monkeypatch):
    """Drums of 0.6 m at rest creep by less than 0.1 mm/s; those that rock, by more than 1 mm/s."""
    monkeypatch.setattr(adapters._rapier_world, "VERTICES_OF_A_FACE", vertices)
    parameters = {"shape": shape, "drums": 2, "margin": 0.3, "scale": 20.0}
    record = played("rapier", "tuned", "leaning_drums", parameters, "none")
    assert record.status == "completed"
    assert (record.creep_m_s > 1e-3) if rocks else (record.creep_m_s < 1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0.2, -0.2])
def test_with_equilibrium_hexagonal_drums_stand_only_within_their_limit(margin):
    record = played("rapier", "tuned", "leaning_drums", {"shape": "hexagon", "margin": margin}, "equilibrium")
    assert record.status == ("completed" if margin > 0 else "collapsed")
