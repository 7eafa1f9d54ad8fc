"""How finely the traces of a page are drawn."""

import pytest

from reports.page.traces import BINS, bins_for


@pytest.mark.parametrize(("traces", "bins"), [(0, BINS), (1, BINS), (1000, BINS), (4025, 62), (100_000, 48)])
def test_traces_are_drawn_finely_while_they_fit_on_a_page(traces, bins) -> None:
    assert bins_for(traces) == bins
