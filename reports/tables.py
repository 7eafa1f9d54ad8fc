"""Tables of a study, without and with each policy side by side: terminal, Markdown and CSV from the raw records.

With several seeds a cell tells the median and the range. A trial that was stopped by its time limit is censored: its
figures are marked "≥" and stand in no mean.
"""

from __future__ import annotations

import csv
import json
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table as RichTable

from reports.cells import ordered_policies
from reports.records import CENSORED, TrialRecord

_WENT_WRONG = {
    "diverged": "diverged",
    "crashed": "crashed",
    "error": "error",
    "out_of_memory": "no memory",
    "unsupported": "n/a",
}
NOTHING = "-"
ADOPTED = "†"
"""Marks trials in which the core froze bodies of a prebuilt stack before the first step."""
ADOPTED_NOTE = f"{ADOPTED}: prebuilt; the core judged the stack by statics and froze bodies before the first step."


@dataclass(frozen=True, slots=True)
class Table:
    """A table of ready text."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    folds: bool = False
    """True for cells of several words, which may take several lines; all but the first column's."""


def study_tables(records: Sequence[TrialRecord]) -> list[Table]:
    """All tables of a study: what stood and fell, whether that was right, what it cost, and how still it stood.

    Where theory knows no answer nothing is right or wrong, and that table is left out.
    """
    is_judged = any(record.verdict != "none" for record in records)
    return [_outcomes(records), *([_verdicts(records)] if is_judged else []), _timings(records), _stillness(records)]


def _outcomes(records: Sequence[TrialRecord]) -> Table:
    policies, name = _policies(records), _engine_names(records)
    rows = []
    for (scene, engine, profile), trials in _grouped(records, lambda r: (r.scene, r.engine, r.profile)):
        cells = [outcome([r for r in trials if r.policy == policy]) for policy in policies]
        rows.append((scene, str(trials[0].expectation), name(engine, profile), *cells))
    notes = ["✓ as theory demands, ✗ not, no mark: not to be judged. n/m: n of m levels stood."]
    notes += [
        "“falls at k”: it toppled, slid or dropped when k levels were complete, 0: before the first was; “sinks at k”: "
        "it sank upright by half a plank."
    ]
    if any(record.status in CENSORED for record in records):
        notes.append("≥: stopped by the time limit; at least so many levels stand. Counted as neither right nor wrong.")
    if any(record.adopted for record in records):
        notes.append(ADOPTED_NOTE)
    if any(record.status == "unsupported" for record in records):
        notes.append("n/a: the engine cannot play the scene.")
    if alone := _stands_alone(records):
        notes.append(
            f"Stands without any help, so that time and stillness are all there is to gain: {', '.join(alone)}."
        )
    notes.append(f"{_seeds(records)} Profile: {', '.join(dict.fromkeys(record.profile for record in records))}.")
    return Table("What stood and what fell", ("scene", "theory", "engine", *policies), tuple(rows), tuple(notes))


def outcome(trials: Sequence[TrialRecord]) -> str:
    """One cell: how the trials of one scene, engine and policy ended, and whether that was right."""
    if not trials:
        return NOTHING
    judged, mark_of_adopted = _decided(trials), adopted_mark(trials)
    right = sum(trial.verdict == "right" for trial in judged)
    if len(trials) == 1:
        return f"{_end(trials[0])}{mark_of_adopted}{' ✓' if right else ' ✗' if judged else ''}"
    levels = sorted(trial.height_levels for trial in trials if trial.status not in _WENT_WRONG)
    if not levels:
        return _WENT_WRONG[trials[0].status]
    at_least = "≥" if any(trial.status in CENSORED for trial in trials) else ""
    varied = f" ({levels[0]}-{levels[-1]})" if levels[0] < levels[-1] else ""
    reached = f"{at_least}{_plain(statistics.median(levels))}{varied}/{trials[0].levels_planned}{mark_of_adopted}"
    if not judged:
        return reached
    mark = "✓" if right == len(judged) else "~" if right else "✗"
    return f"{reached} {mark} {right}/{len(judged)}"


def adopted_mark(trials: Sequence[TrialRecord]) -> str:
    """Return ``ADOPTED`` if the core froze bodies of a prebuilt stack in one of the trials, else nothing."""
    return ADOPTED if any(trial.adopted for trial in trials) else ""


def _end(trial: TrialRecord) -> str:
    if trial.status in _WENT_WRONG:
        return _WENT_WRONG[trial.status]
    if trial.status in CENSORED:
        return f"≥{trial.height_levels}/{trial.levels_planned}"
    if trial.collapse_level is not None:
        return f"{'sinks' if trial.collapse_kind == 'sink' else 'falls'} at {trial.collapse_level}"
    return f"{trial.height_levels}/{trial.levels_planned}"


def _verdicts(records: Sequence[TrialRecord]) -> Table:
    policies, name = _policies(records), _engine_names(records)
    rows = []
    for (engine, profile), trials in _grouped(records, lambda r: (r.engine, r.profile)):
        cells = []
        for policy in policies:
            judged = _decided([r for r in trials if r.policy == policy])
            cells += [_share([r for r in judged if r.expectation.outcome == side]) for side in ("stand", "fall")]
        rows.append((name(engine, profile), *cells))
    header = ("engine", *(f"{policy}: {side}" for policy in policies for side in ("stand", "fall")))
    note = "Right outcomes of those scenes that must stand, and of those that must fall: only both together count."
    return Table("Right by theory", header, tuple(rows), (note,))


def _decided(trials: Sequence[TrialRecord]) -> list[TrialRecord]:
    """Trials that theory can judge: one stopped by its time limit has not been shown to be wrong, only slow."""
    return [trial for trial in trials if trial.verdict != "none" and trial.status not in CENSORED]


def _share(judged: Sequence[TrialRecord]) -> str:
    return f"{sum(r.verdict == 'right' for r in judged)}/{len(judged)}" if judged else NOTHING


def _timings(records: Sequence[TrialRecord]) -> Table:
    rows, name = [], _engine_names(records)
    several = len({record.host for record in records if record.host is not None}) > 1
    for (scene, engine, profile, policy, host), trials in _measured(records, lambda r: (r.host or NOTHING,)):
        rows.append(
            (
                scene,
                name(engine, profile),
                policy,
                *([host] if several else []),
                _median(trials, "frame_ms_p50", "{:.3f}"),
                _median(trials, "frame_ms_p99", "{:.3f}"),
                _median(trials, "engine_ms", "{:.3f}"),
                _median(trials, "readback_ms", "{:.3f}"),
                _median(trials, "core_ms", "{:.3f}"),
                _median(trials, "port_ms", "{:.3f}"),
                _ratio(trials),
            )
        )
    columns = ("p50", "p99", "step", "read", "core", "port", "ratio at level")
    header = ("scene", "engine", "policy", *(["machine"] if several else []), *columns)
    notes = (
        *(["Taken on several machines: compare times of the same machine only."] if several else []),
        "Times in ms a frame, up to a collapse: median and 99th percentile of whole frames; means of the engine's "
        "step, of reading contacts, of the core and of freezing and waking. Trials differ in height: compare heights "
        "first.",
        "Ratio: mean frame time while the level was laid, live bricks included, over that of up to a second of the "
        "same stack all awake without the extension, put up anew where it falls. Above 1 the extension costs more than "
        "it saves.",
    )
    return Table("What it cost", header, tuple(rows), notes)


def _ratio(trials: Sequence[TrialRecord]) -> str:
    levels = sorted(
        {r.frame_ratio_level for r in trials if r.frame_ratio_level is not None and r.frame_ratio is not None}
    )
    value = _median(trials, "frame_ratio", "{:.2f}")
    return f"{value} at {'-'.join(map(str, [levels[0], levels[-1]][: len(levels)]))}" if levels else value


def _stillness(records: Sequence[TrialRecord]) -> Table:
    rows, name = [], _engine_names(records)
    for (scene, engine, profile, policy), trials in _measured(records):
        rows.append(
            (
                scene,
                name(engine, profile),
                policy,
                _median(trials, "height_m", "{:.1f}", 1e3),
                _median(trials, "sink_m", "{:.2f}", 1e3),
                _median(trials, "drift_m", "{:.2f}", 1e3),
                _median(trials, "creep_m_s", "{:.4f}", 1e3),
                _median(trials, "wakes", "{:.0f}"),
                _median(trials, "refreezes", "{:.0f}"),
                _median(trials, "longest_live_s", "{:.1f}"),
            )
        )
    header = ("scene", "engine", "policy", "height", "sink", "drift", "creep", "wakes", "refroze", "live s")
    notes = (
        "Of the highest level when last seen intact: height of its top, sink below its ideal height and the farthest "
        "sideways drift of any brick, in mm; creep in mm/s while the finished stack is watched.",
        "Wakes and refreezes by the core; the longest simulated time that one brick stayed live.",
    )
    return Table("How still it stood", header, tuple(rows), notes)


def render(table: Table, console: Console) -> None:
    """Print a table; the notes follow it."""
    text = RichTable(title=table.title, title_justify="left", pad_edge=False, box=None, header_style="bold")
    figures = sum(map(_is_figures, zip(*table.rows, strict=True))) if table.rows and not table.folds else 0
    first_figure = len(table.header) - figures
    for column, name in enumerate(table.header):
        text.add_column(
            name,
            justify="right" if column >= first_figure else "left",
            overflow="fold",
            no_wrap=column == 0 if table.folds else column < first_figure and name != "theory",
        )
    previous: tuple[str, ...] = ()
    for row in table.rows:
        text.add_row(*(_unless_said(row, previous)))
        previous = row
    console.print(text)
    for note in table.notes:
        console.print(note, style="dim", markup=False, highlight=False)
    console.print()


def to_markdown(tables: Iterable[Table]) -> str:
    """The tables as GitHub's Markdown."""
    parts = []
    for table in tables:
        lines = [f"## {table.title}", "", _line(table.header), _line(["---"] * len(table.header))]
        lines += [_line(row) for row in table.rows]
        lines += [line for note in table.notes for line in ("", note)]
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def write_csv(path: Path, records: Iterable[TrialRecord]) -> None:
    """One line a trial, all fields of the records; what is null is empty, what is nested is JSON."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(TrialRecord.model_fields)
        for record in records:
            fields = record.model_dump(mode="json")
            writer.writerow(json.dumps(v) if isinstance(v, dict) else v for v in fields.values())


def write_table_csv(path: Path, table: Table) -> None:
    """A table as it is read, without its notes."""
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([table.header, *table.rows])


def write_report(folder: Path, records: Sequence[TrialRecord], tables: Iterable[Table]) -> None:
    """Write ``report/tables.md`` and ``report/trials.csv`` into a results folder."""
    report = folder / "report"
    report.mkdir(exist_ok=True)
    (report / "tables.md").write_text(to_markdown(tables), encoding="utf-8")
    write_csv(report / "trials.csv", records)


def _policies(records: Iterable[TrialRecord]) -> list[str]:
    return ordered_policies(record.policy for record in records)


def _engine_names(records: Sequence[TrialRecord]) -> Callable[[str, str], str]:
    """How to name an engine: with its profile where several are compared."""
    several = len({record.profile for record in records}) > 1
    return lambda engine, profile: f"{engine} {profile}" if several else engine


def _grouped(
    records: Iterable[TrialRecord], key: Callable[[TrialRecord], tuple[str, ...]]
) -> list[tuple[tuple[str, ...], list[TrialRecord]]]:
    """Records by a key, keys in the order in which they first appear."""
    groups: dict[tuple[str, ...], list[TrialRecord]] = {}
    for record in records:
        groups.setdefault(key(record), []).append(record)
    return list(groups.items())


def _measured(
    records: Sequence[TrialRecord], further: Callable[[TrialRecord], tuple[str, ...]] = lambda _: ()
) -> list[tuple[tuple[str, ...], list[TrialRecord]]]:
    """Trials that played at least a few frames, by scene, engine, profile, policy and what ``further`` tells apart."""
    policies = _policies(records)
    ran = [record for record in records if record.frame_ms_p50 is not None]
    scenes = list(dict.fromkeys(record.scene for record in records))
    engines = list(dict.fromkeys((record.engine, record.profile) for record in records))
    ran.sort(key=lambda r: (scenes.index(r.scene), engines.index((r.engine, r.profile)), policies.index(r.policy)))
    return _grouped(ran, lambda r: (r.scene, r.engine, r.profile, r.policy, *further(r)))


def _median(trials: Sequence[TrialRecord], field: str, form: str, scale: float = 1.0) -> str:
    values = [value * scale for trial in trials if (value := getattr(trial, field)) is not None]
    return form.format(statistics.median(values)) if values else NOTHING


def _stands_alone(records: Sequence[TrialRecord]) -> list[str]:
    """Scenes that must stand and do so on the engine alone."""
    name = _engine_names(records)
    return [
        f"{scene} on {name(engine, profile)}"
        for (scene, engine, profile), trials in _grouped(records, lambda r: (r.scene, r.engine, r.profile))
        if (plain := [trial for trial in trials if trial.policy == "none"])
        and trials[0].expectation.outcome == "stand"
        and all(trial.verdict == "right" for trial in plain)
    ]


def _seeds(records: Iterable[TrialRecord]) -> str:
    counts = sorted(
        {len(trials) for _, trials in _grouped(records, lambda r: (r.scene, r.engine, r.profile, r.policy))}
    )
    n = "-".join(map(str, [counts[0], counts[-1]][: len(counts)])) if counts else "0"
    told = ""
    if counts[-1:] > [1]:
        told = " (median and range of the levels that stood, then how many trials were right: ✓ all, ~ some, ✗ none)"
    return f"n = {n} trial{'' if n == '1' else 's'} a cell: seeds and repeats{told}."


def _plain(value: float) -> str:
    return f"{value:g}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _is_figures(column: Sequence[str]) -> bool:
    return all(cell == NOTHING or cell[:1].isdigit() for cell in column)


def _unless_said(row: tuple[str, ...], previous: tuple[str, ...]) -> list[str]:
    """Leading cells that repeat the row above are left blank."""
    cells, same = [], True
    for index, cell in enumerate(row):
        same = same and index < len(row) - 1 and previous[index : index + 1] == (cell,)
        cells.append("" if same else cell)
    return cells
