"""Order and group the trials of a data frame into the rows of a study's tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from reports.statistics.groups import ordered_policies
from reports.tables.table import NOTHING


class Measure(NamedTuple):
    """A column of medians."""

    title: str
    field: str
    form: str
    """Format of its numbers."""
    scale: float = 1.0
    """Factor from the field's unit to the column's unit."""


def engine_names(trials: pd.DataFrame) -> pd.Series:
    """Return the name of each trial's engine, with its profile where several are compared."""
    several = len(trials["profile"].unique()) > 1
    names: pd.Series = trials["engine"] + " " + trials["profile"] if several else trials["engine"]
    return names


def played_in_order(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the trials that played at least a few frames, by scene and set-up in order of appearance.

    Policies are in their usual order; ties stay as they are.
    """
    scene = pd.factorize(trials["scene"])[0]
    set_up = trials.groupby(["engine", "profile"], sort=False).ngroup()
    policies = ordered_policies(trials["policy"])
    ordered = trials.iloc[np.lexsort((trials["policy"].map(policies.index), set_up, scene))]
    return ordered[ordered["frame_ms_p50"].notna()]


def median_rows(trials: pd.DataFrame, keys: Sequence[str], measures: Sequence[Measure]) -> pd.DataFrame:
    """Return the medians of each group of trials as text, in the order of ``played_in_order``; a dash for none.

    Args:
        trials: all trials of a study.
        keys: columns of ``trials`` that a group shares, and that its row starts with.
        measures: the columns that follow.
    """
    played = played_in_order(trials)
    scaled = played[list(keys)].assign(
        **{measure.field: played[measure.field].astype("float64") * measure.scale for measure in measures}
    )
    medians = scaled.groupby(list(keys), sort=False, dropna=False).median()
    for measure in measures:
        medians[measure.field] = [median_text(value, measure.form) for value in medians[measure.field]]
    return medians.reset_index().rename(columns={measure.field: measure.title for measure in measures})


def median_text(value: float, form: str) -> str:
    """Return a formatted number; a dash for nan."""
    return NOTHING if np.isnan(value) else form.format(value)
