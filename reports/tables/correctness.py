"""The table of correctness: correct outcomes, for scenes that must stand and for scenes that must fall."""

from __future__ import annotations

import pandas as pd

from reports.records.trial import NOT_JUDGED
from reports.statistics.groups import ordered_policies
from reports.tables.grouping import engine_names
from reports.tables.table import NOTHING, Table

TITLE = "Correctness"
"""Title of the table."""


def correctness_table(trials: pd.DataFrame) -> Table:
    """Return the table of correct outcomes by engine and policy, in separate columns for stand and fall.

    Args:
        trials: all trials of a study, as ``reports.records.results.trials_frame`` returns them.
    """
    trials = trials.assign(engine_name=engine_names(trials), right=trials["verdict"] == "right")
    judged = trials[~trials["verdict"].isin(NOT_JUDGED)]
    counted = judged.groupby(["engine_name", "policy", "expectation_outcome"])["right"].agg(["sum", "size"]).astype(str)
    sides = pd.MultiIndex.from_product([ordered_policies(trials["policy"]), ["stand", "fall"]])
    texts = counted.assign(text=counted["sum"] + "/" + counted["size"]).reset_index()
    rows = (
        texts.pivot_table("text", "engine_name", ["policy", "expectation_outcome"], aggfunc="first")
        .reindex(index=trials["engine_name"].unique(), columns=sides)
        .astype(object)
        .fillna(NOTHING)
    )
    rows.columns = [f"{policy}: {side}" for policy, side in sides]
    note = "Correct outcomes of scenes that must stand, and of scenes that must fall: only both together count."
    return Table.of(TITLE, rows.rename_axis("engine").reset_index(), (note,), id="correctness")
