"""Survival curves by other people's code: `lifelines`, kept as a fixture.

    uv run --with lifelines==0.30.3 python -m tests.oracle.survival

writes ``tests/fixtures/survival.json``, which the tests read; `lifelines` itself they do not need. It is in no
dependency group: it holds pandas back, and with it the lock file of everything else.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

FIXTURE = Path(__file__).parents[1] / "fixtures" / "survival.json"
SIZES = (2, 5, 20, 60)
"""Numbers of stacks: from what a laptop runs to what is published."""


def draw(seed: int, size: int) -> tuple[list[int], list[bool]]:
    """Levels of stacks that fall at random, and are completed at level 12 or stopped before."""
    rng = np.random.default_rng(seed)
    falls, stopped = rng.integers(1, 20, size), np.where(rng.random(size) < 0.2, rng.integers(1, 12, size), 12)
    return np.minimum(falls, stopped).tolist(), (falls <= stopped).tolist()


def judge(levels: list[int], fell: list[bool]) -> dict[str, Any]:
    """What lifelines makes of them; null for what it leaves undefined."""
    from lifelines import KaplanMeierFitter
    from lifelines.utils import median_survival_times

    fitted = KaplanMeierFitter().fit(levels, fell)
    steps = fitted.survival_function_.iloc[1:]  # the first is at 0, where nothing was built
    interval = fitted.confidence_interval_.loc[steps.index]
    ends = median_survival_times(fitted.confidence_interval_)
    return {
        "levels": levels,
        "fell": fell,
        "at": steps.index.tolist(),
        "standing": steps.iloc[:, 0].tolist(),
        "low": _finite(interval.iloc[:, 0]),
        "high": _finite(interval.iloc[:, 1]),
        "median": _finite([fitted.median_survival_time_])[0],
        "median_interval": _finite([ends.iloc[0, 0], ends.iloc[0, 1]]),
    }


def _finite(values: Any) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


if __name__ == "__main__":
    import lifelines

    cases = [judge(*draw(seed, size)) for seed in range(6) for size in SIZES]
    content = {"lifelines": lifelines.__version__, "cases": cases}
    FIXTURE.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
