"""Stack layers on graphs made by hand."""

import numpy as np
import pytest

from adapters.reference.layers import heights_of, layers_of

GROUND = -1


@pytest.mark.parametrize(
    ("contacts", "heights", "layers"),
    [
        ([(GROUND, 0), (0, 1), (1, 2)], [1, 2, 3], [0, 1, 2]),  # a column
        ([(GROUND, 0), (GROUND, 1), (0, 2), (1, 2)], [1, 1, 2], [0, 0, 1, 1]),  # a bridge on two pillars
        ([(GROUND, 0), (GROUND, 1), (0, 1)], [1, 1], [0, 0, 0]),  # a V: its ridge is solved with its feet
        ([(GROUND, 0), (0, 1), (1, 2), (GROUND, 2)], [1, 2, 1], [0, 1, 1, 0]),  # the shortest way counts
        ([(GROUND, 0), (1, 2)], [1, 2, 2], [0, 1]),  # two bodies in flight, which touch, form the top layer
        ([(0, GROUND), (1, 0), (GROUND, 0)], [1, 2], [0, 1, 0]),  # the order of a pair does not matter
    ],
)
def test_heights_count_contacts_to_the_ground(contacts, heights, layers) -> None:
    body = np.array(contacts)
    height = heights_of(body, len(heights))
    assert height.tolist() == heights
    assert layers_of(body, height).tolist() == layers


def test_a_body_without_contacts_is_above_all_others() -> None:
    assert heights_of(np.empty((0, 2), np.int64), 2).tolist() == [1, 1]
    assert heights_of(np.array([(GROUND, 1), (1, 2)]), 4).tolist() == [3, 1, 2, 3]
