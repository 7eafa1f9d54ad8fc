"""Comparison of two pytest-benchmark files by the frame ratio, which is the relative frame time with the extension.

``tests/benchmarks/test_frame_speed.py`` times frames with and without the extension on the same stack, alternating. The
comparison uses only their ratio, because the times of two runs depend on the machine. Each second of frames gives one
ratio:

    a_k     mean time of the frames with the extension in second k
    b_k     median time of the frames without the extension just before second k
    r_k     a_k / b_k, the frame ratio of second k

For every k and every stack of an engine, "head against base" is the ratio of r_k of the head to r_k of the base.

``timing.judge_times`` judges the interval of the geometric mean of "head against base". In a_k, a frame counts for at
most ``MOST`` times the median of the frames with the same index in all seconds. This bound limits the effect of frames
that the system interrupted.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.compare.comparison import NothingInCommonError
from bench.compare.findings import Comparison, Finding
from bench.compare.side import BaselineError
from bench.compare.strict_json import JsonError, parse, read_file
from bench.compare.timing import CONFIDENCE, judge_times
from bench.studies.tolerance import Tolerance
from stability_core.port import FloatArray

FORMAT = "stillstack-frame-1"
"""Value of ``extra_info.format`` in benchmarks of frame times; ``read_benchmarks`` skips other benchmarks."""
ALONE = "none"
"""Name of the policy of frames without the extension."""
MOST = 2.0
"""Ratio of the greatest time that counts for a frame to the median time of the frames with the same index in all
seconds."""
TOLERANCE = Tolerance(time_share=0.25)
"""Tolerance between two runs. Ratios of two runs also differ by effects that the spread within one run does not show,
such as memory placement: on two shared cores, ratios of the same code differed by up to a factor of 1.23."""
ABOUT = (
    "Frame ratio: time of a frame with the extension over that of a frame without it, on the same stack in the same "
    f"run; the ratio of head to base, and its {CONFIDENCE:.0%} interval."
)
"""Note that explains the figures of this comparison to the reader."""
_Time: TypeAlias = Annotated[float, Field(gt=0)]


class _Read(BaseModel):
    """Base of the models for the parts of a pytest-benchmark file that a comparison needs."""

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)


class _Stats(_Read):
    data: list[_Time] = []
    """Time of each round [s]; empty if the file was saved without rounds."""


class _Frame(_Read):
    format: Literal["stillstack-frame-1"]
    engine: str
    version: str
    profile: str
    scene: str
    levels: int = Field(gt=0)
    policy: str
    frames_per_second: int = Field(gt=0)
    alone_ms: list[_Time] = []
    """Median time of the frames without the extension before each second [ms]; empty if the benchmark has no such
    frames.
    """


class _Benchmark(_Read):
    fullname: str
    stats: _Stats
    extra_info: _Frame


class _Cpu(_Read):
    brand_raw: str | None = None


class _Machine(_Read):
    python_version: str = "unknown"
    cpu: _Cpu = _Cpu()


class _Commit(_Read):
    id: str | None = None
    dirty: bool = False


class _File(_Read):
    machine_info: _Machine
    commit_info: _Commit = _Commit()
    benchmarks: list[_Benchmark]


class Group(NamedTuple):
    """Engine, profile, stack and policy of timed frames."""

    engine: str
    profile: str
    stack: str
    """Scene and number of levels."""
    policy: str

    def __str__(self) -> str:
        return ".".join(self)

    @property
    def group(self) -> str:
        """Name of the figure over all stacks of an engine, profile and policy, such as ``bullet.game.paper / none``."""
        return f"{self.engine}.{self.profile}.{self.policy} / {ALONE}"


@dataclass(frozen=True, slots=True)
class FrameTimes:
    """Frame ratios of one side of a comparison."""

    name: str
    """Name given by the user."""
    processor: str | None
    """Model of the processor; None if unknown."""
    circumstances: Mapping[str, str]
    """Processor, version of Python and commit, by the name of the property."""
    versions: Mapping[Group, str]
    """Engine version by group."""
    ratios: Mapping[Group, FloatArray]
    """Frame ratio of each second, shape (s,)."""


def are_benchmarks(base: Path, head: Path) -> bool:
    """Return whether both sides of a comparison are pytest-benchmark files, by their content.

    Raises:
        BaselineError: if only one side is a pytest-benchmark file.
    """
    written = [_is_benchmark_file(path) for path in (base, head)]
    if any(written) and not all(written):
        benchmarks, trials = (base, head) if written[0] else (head, base)
        raise BaselineError(
            f"both sides must be of the same kind, but {benchmarks} is a file of pytest-benchmark and {trials} is not: "
            "name two files of pytest-benchmark, or two outputs of 'bench run' or 'bench baseline'"
        )
    return all(written)


def read_benchmarks(path: Path) -> FrameTimes:
    """Return the frame ratios of a file that pytest-benchmark wrote.

    Raises:
        BaselineError: if the file contains no frame times with the extension, is unreadable or incomplete, or contains
            a benchmark twice.
    """
    places: list[int] = []
    try:
        content = parse(read_file(path), str(path))
        places = list(_frame_benchmarks(content))
        file = _File.model_validate({**content, "benchmarks": [content["benchmarks"][place] for place in places]})
    except JsonError as error:
        raise BaselineError(str(error)) from error
    except (ValidationError, TypeError, AttributeError, KeyError) as error:
        raise BaselineError(
            f"{path}: not a complete file of pytest-benchmark: {_first(error, places)}; create the file again with "
            "'uv run pytest --benchmark-only'"
        ) from error
    versions: dict[Group, str] = {}
    ratios: dict[Group, FloatArray] = {}
    for benchmark in file.benchmarks:
        info = benchmark.extra_info
        group = Group(info.engine, info.profile, f"{info.scene}-{info.levels}", info.policy)
        if info.policy == ALONE:
            continue
        if group in ratios:
            raise BaselineError(
                f"{path}: the frame times of {str(group)[:200]!r} must occur once, but occur again in benchmark "
                f"{benchmark.fullname[:200]!r}; remove the second entry"
            )
        versions[group], ratios[group] = info.version, _ratios(path, benchmark)
    if not ratios:
        raise BaselineError(
            f"{path}: a comparison needs frame times with the extension, but the file contains none; create a file of "
            "frame times with 'uv run pytest --benchmark-only'"
        )
    commit = (file.commit_info.id or "unknown")[:12] + (" with changes" if file.commit_info.dirty else "")
    processor = file.machine_info.cpu.brand_raw
    circumstances = {
        "processor": processor or "unknown",
        "Python": file.machine_info.python_version,
        "commit": commit,
    }
    return FrameTimes(str(path), processor, circumstances, versions, ratios)


def compare_benchmarks(base: FrameTimes, head: FrameTimes, *, across_versions: bool = False) -> Comparison:
    """Compare the frame ratios of two files.

    Args:
        base: the expected side.
        head: the side to judge.
        across_versions: True to compare different versions of an engine.

    Raises:
        NothingInCommonError: if the files contain no frame times of a common stack with the extension.
    """
    if not base.ratios.keys() & head.ratios.keys():
        first = [str(next(iter(side.ratios), "none"))[:200] for side in (base, head)]
        raise NothingInCommonError(
            f"{base.name} and {head.name} must contain frame times of a common stack with the extension, got, for "
            f"example, {first[0]!r} and {first[1]!r}: create both files with 'uv run pytest --benchmark-only' and the "
            "same selection of benchmarks"
        )
    findings = [
        Finding("time", str(group), "open", "missing in the head") for group in base.ratios if group not in head.ratios
    ]
    findings += [
        Finding("time", str(group), "open", "new: not in the base") for group in head.ratios if group not in base.ratios
    ]
    by_figure: dict[str, list[Group]] = defaultdict(list)
    for group in head.ratios:
        if group in base.ratios:
            why = _incomparable(base, head, group, across_versions)
            if why is None:
                by_figure[group.group].append(group)
            else:
                findings.append(Finding("time", str(group), "open", why))
    findings += [_judged(base, head, name, groups) for name, groups in by_figure.items()]
    notes = tuple(
        f"{what}: {are}, was {base.circumstances[what]}"
        for what, are in head.circumstances.items()
        if are != base.circumstances[what]
    )
    return Comparison(base.name, head.name, findings, notes, ABOUT)


def _incomparable(base: FrameTimes, head: FrameTimes, group: Group, across_versions: bool) -> str | None:
    """Return the reason that excludes the frame ratios of a group from the comparison; None without a reason."""
    if base.processor is None or head.processor is None:
        return "its processor is unknown"
    if base.processor != head.processor:
        return f"on {head.processor}, was on {base.processor}"
    was, now = base.versions[group], head.versions[group]
    if was != now and not across_versions:
        return f"{group.engine} {now}, was {was} (--across-versions compares them)"
    return None


def _judged(base: FrameTimes, head: FrameTimes, name: str, groups: Sequence[Group]) -> Finding:
    """Judge the frame ratios of all stacks of an engine, profile and policy."""
    pairs: list[tuple[float, float]] = []
    figures = []
    for group in groups:
        was, now = base.ratios[group], head.ratios[group]
        pairs += zip(was.tolist(), now.tolist(), strict=False)
        figures.append(f"{group.stack} {_middle(now):.3f}, was {_middle(was):.3f}")
    judgement, message = judge_times(pairs, TOLERANCE.time_share)
    return Finding("time", name, judgement, f"{message} ({'; '.join(figures)})")


def _middle(ratios: FloatArray) -> float:
    """Return the geometric mean of ``ratios``."""
    return float(np.exp(np.log(ratios).mean()))


def _ratios(path: Path, benchmark: _Benchmark) -> FloatArray:
    """Return the frame ratio of each of the s whole seconds, shape (s,).

    Raises:
        BaselineError: if the file has no times of rounds, or less than a second of frames with or without extension.
    """
    info, times = benchmark.extra_info, np.array(benchmark.stats.data)
    if not len(times):
        raise BaselineError(
            f"{path}: benchmark {benchmark.fullname[:200]!r} must contain the time of each round, but does not; create "
            "the file again with 'uv run pytest --benchmark-only --benchmark-save-data'"
        )
    count = min(len(times) // info.frames_per_second, len(info.alone_ms))
    if not count:
        raise BaselineError(
            f"{path}: benchmark {benchmark.fullname[:200]!r} must contain at least a second of frames with and without "
            f"the extension, got {len(times) / info.frames_per_second:.2g} s with and {len(info.alone_ms)} s without; "
            "create the file again with 'uv run pytest --benchmark-only'"
        )
    frames = times[: count * info.frames_per_second].reshape(count, info.frames_per_second)
    means = np.minimum(frames, MOST * np.median(frames, axis=0)).mean(axis=1)
    ratios: FloatArray = 1e3 * means / np.array(info.alone_ms[:count])
    return ratios


def _is_benchmark_file(path: Path) -> bool:
    if path.is_dir():
        return False
    try:
        content = parse(read_file(path), str(path))
    except JsonError:  # the reader of the other format reports the error
        return False
    return isinstance(content, dict) and {"machine_info", "benchmarks"} <= content.keys()


def _frame_benchmarks(content: Any) -> Iterator[int]:
    """Yield the places of the benchmarks of frames in the list of the file."""
    for place, benchmark in enumerate(content["benchmarks"]):
        if benchmark["extra_info"].get("format") == FORMAT:
            yield place


def _first(error: Exception, places: Sequence[int]) -> str:
    """Return the first error without the text of the file, because that text is untrusted.

    Args:
        error: the error.
        places: place of each checked benchmark in the list of the file.
    """
    if not isinstance(error, ValidationError):
        return "'benchmarks' is missing, or is not a list of benchmarks with 'extra_info'"
    first = error.errors(include_url=False, include_input=False)[0]
    location = list(first["loc"])
    if location[:1] == ["benchmarks"] and len(location) > 1:
        location[1] = places[int(location[1])]
    return f"field '{'.'.join(map(str, location))[:200]}': {first['msg']}"
