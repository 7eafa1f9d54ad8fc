"""Functions that sort and group the trials of a data frame into the rows of a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from reports.statistics.groups import ordered_policies
from reports.tables.table import NOTHING


class Measure(NamedTuple):
    """Column of medians of a field."""

    title: str
    field: str
    """Name of the field of the record."""
    form: str
    """Format of a number."""
    scale: float = 1.0
    """Factor from the unit of the field to the unit of the column."""


def engine_names(trials: pd.DataFrame) -> pd.Series:
    """Return the name of each trial's engine; append the profile if the trials have several profiles."""
    several = len(trials["profile"].unique()) > 1
    names: pd.Series = trials["engine"] + " " + trials["profile"] if several else trials["engine"]
    return names


def played_in_order(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the trials with timed frames, stably sorted by scene, engine and profile, and policy.

    Scenes, and engines with profiles, are in the order of their first appearance; policies have their usual order.
    """
    scene = pd.factorize(trials["scene"])[0]
    set_up = trials.groupby(["engine", "profile"], sort=False).ngroup()
    policies = ordered_policies(trials["policy"])
    ordered = trials.iloc[np.lexsort((trials["policy"].map(policies.index), set_up, scene))]
    return ordered[ordered["frame_ms_p50"].notna()]


def median_rows(trials: pd.DataFrame, keys: Sequence[str], measures: Sequence[Measure]) -> pd.DataFrame:
    """Return a row of medians as text for each group of trials, in the order of ``played_in_order``.

    A missing median becomes a dash.

    Args:
        trials: all trials of a study.
        keys: columns of ``trials`` that define the groups; a row begins with these columns.
        measures: columns of medians that follow in a row.
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
    """Format a number by the format specification ``form``; return a dash for NaN."""
    return NOTHING if np.isnan(value) else form.format(value)
