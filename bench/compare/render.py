"""Write a comparison as tables for a terminal, Markdown, JUnit XML or JSON."""

from __future__ import annotations

import html
import json
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, replace
from typing import get_args
from xml.etree import ElementTree as ET

from rich.console import Console
from rich.markup import escape

from bench.compare.findings import ALARMS, GATES, Comparison, Finding, Gate, Judgement, plain, without_repeat
from bench.compare.timing import CONFIDENCE
from reports.tables.table import Table, render, to_markdown

_KINDS: tuple[Judgement, ...] = get_args(Judgement)
_RATIO = (
    "Times: part / reference part, of a typical frame of each trial; the ratio of head to base, and its "
    f"{CONFIDENCE:.0%} interval. The reference part is unchanged between base and head."
)
_ASIDE = (
    "A trial with another engine version, scene or processor, or one that its time limit ended, is neither a "
    "regression nor a pass."
)


def headline(comparison: Comparison, fail_on: Collection[Gate]) -> str:
    """Summarise the comparison in one line: the alarms by gate, or the gates without a decision and missing trials."""
    alarms = comparison.alarms(fail_on)
    if alarms:
        counts = ", ".join(
            f"{count} by {gate}" for gate in fail_on if (count := sum(alarm.gate == gate for alarm in alarms))
        )
        return f"{len(alarms)} alarm{'s' * (len(alarms) > 1)}: {counts}"
    idle = [gate for gate in fail_on if not any(f.gate == gate and f.judgement != "open" for f in comparison.findings)]
    undecided = f"; nothing could be decided by {' and '.join(idle)}" if idle else ""
    missing = comparison.missing
    lost = f"; {missing} of {comparison.expected} trials are missing (--require-all)" if missing else ""
    return f"no alarm{undecided}{lost}"


def tables(comparison: Comparison, fail_on: Collection[Gate]) -> list[Table]:
    """Return the table of counts by gate, then the tables of findings: worse, better, not decided, times."""
    counted = Table(
        "Findings of the gates",
        ("gate", "fails", "worse", "changed", "better", "same", "not decided"),
        tuple(
            (gate, "yes" if gate in fail_on else "no", *(str(counts[kind]) for kind in _KINDS))
            for gate in GATES
            if (counts := comparison.counts(gate))
        ),
        (
            f"{plain(comparison.head)}, compared with {plain(comparison.base)}.",
            *(f"Not the same: {plain(note)}" for note in comparison.notes),
        ),
    )
    ratio = comparison.about_times or _RATIO
    names = (plain(comparison.base), plain(comparison.head))
    kinds = (
        ("Worse or changed", [finding for finding in comparison.findings if finding.is_alarm], ()),
        ("Better", [finding for finding in comparison.findings if finding.judgement == "better"], ()),
        ("Not decided", [finding for finding in comparison.findings if finding.judgement == "open"], (_ASIDE,)),
        ("Times", [time for time in comparison.findings if time.gate == "time" and time.judgement == "same"], ()),
    )
    return [counted, *(_listed(title, findings, notes, ratio, names) for title, findings, notes in kinds if findings)]


def _listed(
    title: str, findings: Sequence[Finding], notes: tuple[str, ...], ratio: str, names: tuple[str, str]
) -> Table:
    """Return the table of findings, with the values of both sides; equal findings of repeats share a row."""
    counts = Counter(
        (finding.gate, without_repeat(finding.trial), finding.message, finding.base, finding.head)
        for finding in findings
    )
    first = {
        (finding.gate, without_repeat(finding.trial), finding.message, finding.base, finding.head): finding
        for finding in findings
    }
    rows = []
    for key, count in counts.items():
        finding = first[key]
        trial = finding.trial if count == 1 else f"{without_repeat(finding.trial)} (x{count})"
        rows.append((finding.gate, plain(trial), plain(finding.message), plain(finding.base), plain(finding.head)))
    if any(row[0] == "time" for row in rows):
        notes += (ratio,)
    if not any(row[3] or row[4] for row in rows):
        return Table(title, ("gate", "trial", "what"), tuple(row[:3] for row in rows), notes, folds=True)
    return Table(title, ("gate", "trial", "what", *names), tuple(rows), notes, folds=True)


def show(comparison: Comparison, fail_on: Collection[Gate], console: Console) -> None:
    """Print the tables and then the headline, with markup escaped, because the text is untrusted."""
    for table in tables(comparison, fail_on):
        render(replace(_mapped(table, escape), notes=table.notes), console)
    console.print(headline(comparison, fail_on), style="bold", highlight=False)


_ENTITIES = {ord(letter): f"&#{ord(letter)};" for letter in "\\`*_[]!#@"}
"""HTML entities for the characters that Markdown interprets inside a line, and for ``@``, which mentions people."""


def markdown(comparison: Comparison, fail_on: Collection[Gate], pictures: Sequence[tuple[str, str]] = ()) -> str:
    """Return Markdown for a job's summary or a comment; escape links, images and HTML in text of the files.

    Args:
        comparison: the comparison.
        fail_on: gates whose alarms count.
        pictures: the trial and the address of each picture to show after the headline.
    """
    listed = to_markdown(_mapped(table, _literal) for table in tables(comparison, fail_on))
    names = [_literal(plain(trial)) for trial, _ in pictures]
    shown = "".join(f"{name}\n\n![{name}]({where})\n\n" for name, (_, where) in zip(names, pictures, strict=True))
    return f"**Stacking: {headline(comparison, fail_on)}**\n\n{shown}{listed}"


def _mapped(table: Table, form: Callable[[str], str]) -> Table:
    rows = tuple(tuple(map(form, row)) for row in table.rows)
    header = tuple(map(form, table.header))
    return replace(table, title=form(table.title), header=header, rows=rows, notes=tuple(map(form, table.notes)))


def _literal(text: str) -> str:
    return html.escape(text, quote=False).translate(_ENTITIES)


def junit(comparison: Comparison, fail_on: Collection[Gate]) -> bytes:
    """Return JUnit XML with a suite per gate and a case per finding; an open finding becomes a skipped case."""
    root = ET.Element("testsuites", name="stillstack")
    for gate in GATES:
        findings = [finding for finding in comparison.findings if finding.gate == gate]
        failed = [finding for finding in findings if finding.is_alarm and gate in fail_on]
        skipped = [finding for finding in findings if finding.judgement == "open"]
        counts = {"tests": len(findings), "failures": len(failed), "skipped": len(skipped)}
        suite = ET.SubElement(root, "testsuite", {"name": gate} | {key: str(n) for key, n in counts.items()})
        for finding in findings:
            case = ET.SubElement(suite, "testcase", classname=f"stillstack.{gate}", name=plain(finding.trial))
            message = plain(finding.message)
            if finding.judgement == "open":
                ET.SubElement(case, "skipped", message=message)
            elif finding.judgement in ALARMS and gate in fail_on:
                ET.SubElement(case, "failure", type=finding.judgement, message=message)
            elif message:
                ET.SubElement(case, "system-out").text = f"{finding.judgement}: {message}"
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def as_json(comparison: Comparison, fail_on: Collection[Gate]) -> str:
    """Return the whole comparison as JSON."""
    content = {
        "format": "stillstack-comparison-1",
        "alarms": len(comparison.alarms(fail_on)),
        "fail_on": list(fail_on),
        **asdict(comparison),
    }
    return json.dumps(content, indent=1)
