"""Stills: pictures of trials at their end, with live, frozen and fallen bricks in different colours."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from reports.records.folder import still_of
from reports.replays.drawing import view_of, visible_space
from reports.replays.errors import ExportError
from reports.replays.renderer import View, draw_pictures
from reports.replays.replay import Replayed
from reports.replays.timeline import Timeline

PIXELS = 240
"""Edge length of a still [pixels]. A page shows a still at 120 to 160 pixels, so that 240 pixels are sharp there. A
still takes about 0.3 s to draw."""


class StillsError(RuntimeError):
    """A failure to draw stills; the message names the reason and, if known, the fix."""


def write_stills(folder: Path, stacks: Iterable[Sequence[Replayed]], pixels: int = PIXELS) -> None:
    """Draw the still of every trial; skip lists of trials that have neither bricks nor fixed bodies.

    Args:
        folder: folder of the stills, created if necessary.
        stacks: lists of trials; the trials of a list have the same camera.
        pixels: edge length of the square pictures.

    Raises:
        StillsError: if the machine has no renderer, or the renderer fails or takes too long.
    """
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [job for stack in stacks for job in _jobs(folder, stack, pixels)]
    if not jobs:
        return
    try:
        draw_pictures(jobs)
    except ExportError as error:
        raise StillsError(f"no stills: {error}") from error


def _jobs(folder: Path, stack: Sequence[Replayed], pixels: int) -> list[tuple[View, list[Path]]]:
    """Return the view of each trial of one stack at its end, and the file of its picture."""
    space = visible_space([trial.recording for trial in stack])
    if space is None:
        return []
    jobs = []
    for trial in stack:
        timeline = Timeline(trial.recording)
        view = view_of(timeline, [timeline.end_s], space, (pixels, pixels))
        jobs.append((view, [still_of(folder, trial.record)]))
    return jobs
