"""Twenty thousand decisions on random piles: the core and its policies against the judge.

    uv run python -m tests.stability_core.decisions

writes the table ``docs/results/truth/decisions.md``; the slow test ``test_decisions.py`` asserts what it must say.

A pile is laid plank by plank, the first planks of a V in pairs. From the third plank on each is a decision: does the
pile stand with it? The first that lets it fall is the last. The judge is ``scenarios.statics.truth.judge`` (linear
programs by HiGHS that close in on Coulomb's cone). ``solve_equilibrium`` is asked about each pile from scratch. A
policy sees the pile at rest, as it grows, as an engine would show it: it says "stable" if it now freezes every plank
and wakes none. One that refuses a pile that stands is asked no more about that pile, for it never froze what the next
plank would lie on.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np

from bench.machine.core_digest import present_core
from bench.publishing.page_marks import write_page
from scenarios.statics.contact_patch import Patch
from scenarios.statics.truth import judge
from stability_core import Contacts, Masses, Settings, StabilityExtension, solve_equilibrium
from tests.stability_core.piles import LENGTH, Pile, laden_pair, leaned_on_tower, level_pile

T = TypeVar("T")

KINDS: dict[str, Callable[[np.random.Generator], Pile]] = {
    "level": partial(level_pile, widest=0.25),
    "leaning on a tower": leaned_on_tower,
    "under a roof": laden_pair,
}
PILES = {"level": 4_000, "leaning on a tower": 1_400, "under a roof": 3_000}
"""Piles of each kind."""
FEWEST = 3
"""Planks of the smallest pile that counts."""
IN_PAIRS = {"level": (), "leaning on a tower": (), "under a roof": (1, 3)}
"""Numbers of planks at which a pile is not asked about: half a V."""
BAND = 1e-6
"""A pile that lacks less than this, in weights of the whole pile, is at the limit: counted apart."""
JUDGED = ("solve_equilibrium", "equilibrium", "paper")
FRAME_S = 1 / 60
AT_ONCE = Settings(rest_s=1 / 60, lean_s=1 / 60, load_s=1 / 60, point_radius=0.0)
"""Nothing moves here, so nothing need be watched for long; points are exact, so that none may be off by micrometres."""
TABLE = Path(__file__).parents[2] / "docs" / "results" / "truth" / "decisions.md"


class Decision(NamedTuple):
    """One plank laid, judged by all."""

    kind: str
    truth: str
    """Of the judge: stable, unstable, limit (within ``BAND``) or doubt."""
    verdicts: tuple[str, ...]
    """In the order of ``JUDGED``; "" for a policy that is asked no more."""


def part_of(contacts: Contacts, masses: Masses, bodies: np.ndarray, rows: np.ndarray) -> tuple[Contacts, Masses]:
    """Only those ``bodies`` and ``rows`` of contacts."""
    return (
        contacts.chosen(rows),
        Masses(masses.body[bodies], masses.mass[bodies], masses.center_of_mass[bodies]),
    )


class StillWorld:
    """A port to a pile that grows and never moves."""

    def __init__(self, contacts: Contacts, masses: Masses) -> None:
        self._contacts, self._masses = contacts, masses
        self.planks = 0
        """How many are there."""
        self.frozen = np.zeros(len(masses.body) + 1, np.bool_)
        """By body; the last row is the ground's."""
        self.frozen[-1] = True
        self.woken = False

    def contacts(self) -> Contacts:
        c = self._contacts
        shown = ~(self.frozen[c.body_a] & self.frozen[c.body_b]) & (np.maximum(c.body_a, c.body_b) < self.planks)
        return part_of(c, self._masses, self._masses.body[:0], shown)[0]

    def masses(self) -> Masses:
        return part_of(self._contacts, self._masses, np.flatnonzero(~self.frozen[: self.planks]), np.empty(0, int))[1]

    def sleep(self, bodies: Sequence[int]) -> None:
        self.frozen[list(bodies)] = True

    def wake(self, bodies: Sequence[int]) -> None:
        self.woken = True
        self.frozen[list(bodies)] = False


class Asked:
    """A policy of the core in front of a pile that is being laid."""

    def __init__(self, name: str, contacts: Contacts, masses: Masses) -> None:
        self._world = StillWorld(contacts, masses)
        self._extension = StabilityExtension(self._world, name, settings=AT_ONCE)
        self._is_out = False

    def verdict(self, planks: int) -> str:
        """What it says with so many planks laid; "" once it has refused."""
        if self._is_out:
            return ""
        world = self._world
        world.planks = planks
        quiet = -1  # in the first frame no speed is known
        while quiet < 2 and not (world.woken or world.frozen[:planks].all()):  # the refused are asked in every frame
            quiet = 0 if self._extension.update(FRAME_S).reasons else quiet + 1
        self._is_out = world.woken or not world.frozen[:planks].all()
        return "unstable" if self._is_out else "stable"


def ask_judge(contacts: Contacts, masses: Masses) -> str:
    """The truth: stable, unstable, limit or doubt."""
    rows = zip(contacts.body_a.tolist(), contacts.body_b.tolist(), contacts.point, contacts.normal, strict=True)
    patches = [Patch(first, second, point[None], normal) for first, second, point, normal in rows]
    weights = np.outer(masses.mass, (0.0, 0.0, -9.81))
    found = judge(masses.center_of_mass, weights, patches, float(contacts.friction[0]), LENGTH)
    return "limit" if found.verdict == "unstable" and found.residual < BAND else found.verdict


def decisions_of(kind: str, seed: int) -> Iterator[Decision]:
    """Lay one pile, turned about the vertical by any angle, and ask everyone about each plank."""
    random = np.random.default_rng([list(KINDS).index(kind), seed])
    pile = KINDS[kind](random)
    yaw = random.uniform(0, 2 * np.pi)
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    contacts, masses = pile.world(turn)
    latest = np.maximum(contacts.body_a, contacts.body_b)
    policies = [Asked(name, contacts, masses) for name in JUDGED[1:]]
    for planks in range(1, len(masses.body) + 1):
        if planks in IN_PAIRS[kind]:
            continue
        so_far = part_of(contacts, masses, masses.body[:planks], latest < planks)
        truth = ask_judge(*so_far)
        said = tuple(policy.verdict(planks) for policy in policies)
        if planks >= FEWEST:
            yield Decision(kind, truth, (solve_equilibrium(*so_far).verdict, *said))
        if truth != "stable":
            return


def decide_some(job: tuple[str, range]) -> Counter[Decision]:
    """How often each outcome comes up in a range of seeds."""
    kind, seeds = job
    return Counter(decision for seed in seeds for decision in decisions_of(kind, seed))


def sum_counts(count: Callable[[tuple[str, range]], Counter[T]], piles: dict[str, int], processes: int) -> Counter[T]:
    """The sum of ``count`` over ranges of seeds, in several processes; seeds are 0 to n - 1 for each kind of pile."""
    chunk = 25
    jobs = [(kind, range(start, min(start + chunk, n))) for kind, n in piles.items() for start in range(0, n, chunk)]
    total: Counter[T] = Counter()
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for counts in pool.map(count, jobs):
            total.update(counts)
    return total


def decide_all(piles: dict[str, int], processes: int = 2) -> Counter[Decision]:
    """How often each outcome comes up."""
    return sum_counts(decide_some, piles, processes)


class Score(NamedTuple):
    """How one who was asked compares with the judge, over the decisions whose truth is known."""

    stable: int
    unstable: int
    false_stable: int
    false_unstable: int
    doubt: int


def score(counts: Counter[Decision], who: str, kind: str | None = None) -> Score:
    """The score of one of ``JUDGED``, for one kind of pile or for all."""
    at = JUDGED.index(who)
    pairs: Counter[tuple[str, str]] = Counter()
    for decision, n in counts.items():
        if kind in (None, decision.kind) and decision.verdicts[at]:
            pairs[decision.truth, decision.verdicts[at]] += n
    return Score(
        sum(n for (truth, _), n in pairs.items() if truth == "stable"),
        sum(n for (truth, _), n in pairs.items() if truth == "unstable"),
        pairs["unstable", "stable"],
        pairs["stable", "unstable"],
        pairs["stable", "doubt"] + pairs["unstable", "doubt"],
    )


def open_cases(counts: Counter[Decision], truth: str) -> int:
    """Decisions that count for nobody, because the judge says ``truth``."""
    return sum(n for decision, n in counts.items() if decision.truth == truth)


def table(counts: Counter[Decision]) -> str:
    """The results as a page."""
    lines = [
        f"# {sum(counts.values()):,} decisions on random piles",
        "",
        "Made by `uv run python -m tests.stability_core.decisions`, whose docstring describes the method; what",
        "must hold is asserted by `uv run pytest -m slow tests/stability_core/test_decisions.py`.",
        "",
        "Piles of 3-12 planks, friction 0.1-0.8, yawed at random, on level ground, with ideal contacts. Truth is the",
        "exact cone (`docs/truth.md`). False stable: accepted, of the piles that fall. False unstable: refused, of",
        "those that stand. A policy has no doubt: what it does not freeze it refuses, and after a wrong refusal it is",
        "asked no more about that pile, hence the different totals.",
        "",
        "| Piles | asked | stand | fall | false stable | false unstable | doubt |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in (None, *KINDS):
        for who in JUDGED:
            s = score(counts, who, kind)
            lines.append(
                f"| {kind or 'all'} | `{who}` | {s.stable} | {s.unstable} | {_share(s.false_stable, s.unstable)} "
                f"| {_share(s.false_unstable, s.stable)} | {_share(s.doubt, s.stable + s.unstable)} |"
            )
    limit, doubt = open_cases(counts, "limit"), open_cases(counts, "doubt")
    lines += [
        "",
        f"Left out, as their truth is not known: {limit} that lack less than {BAND:g} of their weight, and {doubt} of",
        "which the judge itself is in doubt.",
        "",
    ]
    return "\n".join(lines)


def _share(part: int, whole: int) -> str:
    return f"{part} ({part / whole:.2%})" if whole else "-"


if __name__ == "__main__":
    core = present_core()
    write_page(TABLE, table(decide_all(PILES)), core)
