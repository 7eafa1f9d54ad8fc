"""Twenty thousand flat random piles: the policies ``paper`` and ``stacking_tree`` against the judge.

    uv run python -m tests.stability_core.flat_piles [--piles N]

writes ``docs/results/truth/flat_piles.md``. The piles are of two kinds, half of each:

- planks: planks of the paper, yawed at random, on the highest plank below (``piles.level_pile``);
- boxes: as in online packing (Zhao et al. 2022), boxes of random size, aligned with the axes, above a square. Their
  heights are one of three, so that a box often lies on two or more others. Only boxes whose own centre lies above
  their contact area are laid, so that a pile falls by the loads of its bodies on each other.

A pile grows body by body, up to the first body with which it falls. Each state from the third body on is a decision.
A policy agrees on a pile if it agrees with the judge on all decisions of the pile; an interval is the 95 % interval of
Wilson for independent piles. The seed of pile k is (20260, kind, k), where 20260 was named before the first run.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy

from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from stability_core import GROUND
from tests.stability_core.decisions import Asked, ask_judge, part_of, sum_counts
from tests.stability_core.piles import MASS, Pile, level_pile

SEED = 20260
PILES = 20_000
"""Number of piles of the published page."""
FEWEST = 3
"""Bodies of the smallest pile that counts."""
POLICIES = ("paper", "stacking_tree")
CELL = 0.03
"""Unit of length of the boxes [m]."""
BIN = 8.0
"""Side of the square in which the boxes lie [units]."""
PAGE = Path(__file__).parents[2] / "docs" / "results" / "truth" / "flat_piles.md"


class Box(NamedTuple):
    """A box of a pile, in units."""

    low: np.ndarray
    """Least x and y."""
    high: np.ndarray
    """Greatest x and y."""
    bottom: float
    top: float
    areas: dict[int, np.ndarray]
    """Corners (4, 2) of the contact area on each box below it, or on the ground."""


def random_box(random: np.random.Generator, boxes: list[Box]) -> Box:
    """Let a box of random size go at a random place; it comes to lie on the highest of the ``boxes`` below it."""
    width, height = random.uniform(1.5, 5.0, 2), float(random.integers(1, 4))
    low = random.uniform(0.0, BIN - width)
    high = low + width
    shared = [(np.maximum(low, other.low), np.minimum(high, other.high), other.top) for other in boxes]
    bottom = max((top for left, right, top in shared if (left < right).all()), default=0.0)
    found = {other: (left, right) for other, (left, right, top) in enumerate(shared) if top == bottom}
    if bottom == 0.0:
        found = {GROUND: (low, high)}
    areas = {
        other: np.array([(x, y) for x in (left[0], right[0]) for y in (left[1], right[1])])
        for other, (left, right) in found.items()
        if (left < right).all()
    }
    return Box(low, high, bottom, bottom + height, areas)


def stands_alone(box: Box) -> bool:
    """Return True if the centre of a box lies above the hull of its contact areas."""
    corners = np.concatenate(list(box.areas.values())) - (box.low + box.high) / 2
    angles = np.sort(np.arctan2(corners[:, 1], corners[:, 0]))
    return bool(np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() < np.pi)  # no half-plane holds all corners


def packed_pile(random: np.random.Generator) -> Pile:
    """6 to 20 boxes, 1.5 to 5 units wide and 1, 2 or 3 units high, with one density, in a square of 8 units."""
    pile, boxes = Pile(float(random.uniform(0.2, 0.8))), []
    for body in range(int(random.integers(6, 21))):
        box = random_box(random, boxes)
        while not stands_alone(box):
            box = random_box(random, boxes)
        center = (*((box.low + box.high) / 2), (box.bottom + box.top) / 2)
        pile.add(tuple(CELL * np.array(center)), MASS * float((box.high - box.low).prod()) * (box.top - box.bottom))
        for other, corners in box.areas.items():
            pile.touch(body, other, CELL * np.column_stack([corners, np.full(4, box.bottom)]))
        boxes.append(box)
    return pile


KINDS: dict[str, Callable[[np.random.Generator], Pile]] = {
    "planks": partial(level_pile, widest=0.25),
    "boxes": packed_pile,
}


class State(NamedTuple):
    """One state of a pile, as the judge and the policies decide it."""

    truth: str
    """Of the judge: stable, unstable, limit or doubt."""
    verdicts: tuple[str, ...]
    """In the order of ``POLICIES``; "" for a policy that has refused an earlier state."""


def states_of(kind: str, seed: int) -> Iterator[State]:
    """Yield the states of one pile, turned about the vertical by any angle, up to the first that is not stable."""
    random = np.random.default_rng([SEED, list(KINDS).index(kind), seed])
    pile = KINDS[kind](random)
    yaw = random.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    contacts, masses = pile.world(turn)
    latest = np.maximum(contacts.body_a, contacts.body_b)
    policies = [Asked(name, contacts, masses) for name in POLICIES]
    for bodies in range(1, len(masses.body) + 1):
        truth = ask_judge(*part_of(contacts, masses, masses.body[:bodies], latest < bodies))
        verdicts = tuple(policy.verdict(bodies) for policy in policies)
        if bodies >= FEWEST:
            yield State(truth, verdicts)
        if truth != "stable":
            return


Counts = Counter[tuple[str, str, str, str]]
"""Numbers of (kind, policy, unit, outcome). The unit is "pile" or "decision"."""


def count(job: tuple[str, range]) -> Counts:
    """Count the outcomes of piles of one kind. States without a known truth count apart, as "unknown"."""
    kind, seeds = job
    counts: Counts = Counter()
    for seed in seeds:
        states = list(states_of(kind, seed))
        for at, policy in enumerate(POLICIES):
            outcomes = [_outcome(state.truth, state.verdicts[at]) for state in states if state.verdicts[at]]
            counts.update((kind, policy, "decision", outcome) for outcome in outcomes)
            wrong = [outcome for outcome in outcomes if outcome.startswith("false")]
            unknown = "unknown" if "unknown" in outcomes else "right"
            counts[kind, policy, "pile", wrong[0] if wrong else unknown] += 1
    return counts


def _outcome(truth: str, verdict: str) -> str:
    if truth not in ("stable", "unstable"):
        return "unknown"
    return "right" if truth == verdict else f"false {verdict}"


def count_all(piles: int, processes: int = 2) -> Counts:
    """Count the outcomes of ``piles`` piles, half of each kind."""
    return sum_counts(count, dict.fromkeys(KINDS, piles // len(KINDS)), processes)


class Agreement(NamedTuple):
    """The agreement of a policy with the judge, over piles or decisions with a known truth."""

    n: int
    right: int
    false_stable: int
    false_unstable: int

    @property
    def share(self) -> float:
        """Share of right verdicts."""
        return self.right / self.n

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of Wilson's 95 % interval of the share."""
        ends = scipy.stats.binomtest(self.right, self.n).proportion_ci(0.95, method="wilson")
        return float(ends.low), float(ends.high)


def agreement(counts: Counts, policy: str, unit: str, kind: str | None = None) -> Agreement:
    """Return the agreement of a policy on one kind of piles, or on all."""
    kinds = [kind] if kind else list(KINDS)
    right, stable, unstable = (
        sum(counts[one, policy, unit, outcome] for one in kinds)
        for outcome in ("right", "false stable", "false unstable")
    )
    return Agreement(right + stable + unstable, right, stable, unstable)


def table(counts: Counts, piles: int) -> str:
    """The results as a page."""
    lines = [
        f"# {piles:,} flat random piles",
        "",
        "Made by `uv run python -m tests.stability_core.flat_piles`, whose docstring describes piles, decisions and",
        "intervals. The truth is the judge (`docs/truth.md`). Published for the stacking tree: 99.9 % agreement with a",
        "simulation by Bullet on random packings of boxes, one decision a box (Zhao et al. 2022).",
        "",
        "| piles | policy | unit | n | agreement | 95 % interval | false stable | false unstable |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind in (None, *KINDS):
        for policy in POLICIES:
            for unit in ("pile", "decision"):
                found = agreement(counts, policy, unit, kind)
                low, high = found.interval
                interval = f"{low:.2%} to {high:.2%}" if unit == "pile" else "-"
                lines.append(
                    f"| {kind or 'all'} | `{policy}` | {unit} | {found.n} | {found.share:.2%} | {interval} "
                    f"| {found.false_stable} | {found.false_unstable} |"
                )
    unknown = sum(
        n for (_, policy, unit, out), n in counts.items() if (policy, unit, out) == ("paper", "pile", "unknown")
    )
    lines += ["", f"Left out, because their truth is not known: {unknown} piles.", ""]
    return "\n".join(lines)


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--piles", type=int, default=PILES, help="number of piles; other numbers only print")
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    core = present_core()
    text = table(count_all(arguments.piles, arguments.processes), arguments.piles)
    print(text)  # noqa: T201 - a command
    if arguments.piles == PILES:
        write_page(PAGE, text, core)


if __name__ == "__main__":
    main()
