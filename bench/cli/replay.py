"""``bench replay``: show a trial in the browser, draw a picture or video of the trial, or export the trial."""

from __future__ import annotations

import webbrowser
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from bench.cli.console import ERR, input_errors, note, read_folder, relative
from reports.records.atomic import write_atomic
from reports.records.folder import ResultsFolder
from reports.records.trial import TrialRecord
from reports.replays.camera import parse_camera
from reports.replays.gltf import to_glb
from reports.replays.margins import margins_of, write_margins
from reports.replays.pictures import Film, parse_size, write_still, write_video
from reports.replays.replay import Replayed
from reports.replays.rerun_export import write_rerun
from reports.replays.stacks import read_stack, stack_of, write_stack_replay
from scenarios.lookup import look_up


class Colour(StrEnum):
    """Quantity that the colours of bricks show."""

    STATE = "state"
    LOAD = "load"
    TILT = "tilt"


_CAMERA_HELP = (
    "For pictures and videos: corner, front, side or top, azimuth, elevation (degrees), distance (metres), as in "
    "'front,elevation=20,distance=0.5'."
)


def replay(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A results folder.")],
    trial: Annotated[str, typer.Argument(help="Id of a trial in that folder.")],
    show: Annotated[bool, typer.Option("--open/--no-open", help="Open the replay in the browser.")] = True,
    gltf: Annotated[
        Path | None, typer.Option(metavar="FILE.glb", help="Write the trial as animated glTF instead of a replay.")
    ] = None,
    rrd: Annotated[
        Path | None, typer.Option(metavar="FILE.rrd", help="Write a file for Rerun's viewer instead of a replay.")
    ] = None,
    video: Annotated[
        Path | None, typer.Option(metavar="FILE.mp4|FILE.gif", help="Write a video instead of a replay.")
    ] = None,
    still: Annotated[
        str | None, typer.Option(metavar="WIDTHxHEIGHT", help="Write a picture of this size instead of a replay.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE.png", help="File of the picture [TRIAL.png].")
    ] = None,
    at: Annotated[float | None, typer.Option(help="Time of the picture in seconds; by default the end.")] = None,
    camera: Annotated[str, typer.Option(help=_CAMERA_HELP)] = "corner",
    colour: Annotated[
        Colour,
        typer.Option(help="Colour of the bricks in pictures and videos: their state, or their load or tilt margin."),
    ] = Colour.STATE,
    margins: Annotated[
        bool, typer.Option("--margins", help="Add the margins of the bricks to the replay in the browser.")
    ] = False,
    margins_csv: Annotated[
        Path | None, typer.Option(metavar="FILE.csv", help="Write the margins as numbers instead of a replay.")
    ] = None,
    beside: Annotated[
        list[str] | None,
        typer.Option(
            help="Also draw the trial of the same stack under this policy; may be repeated (default: none, if any)."
        ),
    ] = None,
    alone: Annotated[bool, typer.Option("--alone", help="Only this trial in pictures, videos and .rrd.")] = False,
    size: Annotated[
        str | None, typer.Option(metavar="WIDTHxHEIGHT", help="Size of the video [1280x720; GIF 640x360].")
    ] = None,
    fps: Annotated[int, typer.Option(help="Frames per second of the video.")] = 25,
    speed: Annotated[float, typer.Option(help="Simulated seconds per second of the video.")] = 1.0,
) -> None:
    """Show a trial in the browser beside the same stack under other policies, or write the trial to a file."""
    with input_errors():
        records = read_folder(folder)
        if gltf is not None:
            export_gltf(folder, records, trial, gltf)
            note(f"the animation is {relative(gltf)}")
        if margins_csv is not None:
            write_margins(margins_csv, margins_of(side_by_side(folder, records, trial, ())[0].recording, trial=trial))
            note(f"the margins are {relative(margins_csv)}")
        if (rrd, video, still) == (None, None, None):
            if (gltf, margins_csv) == (None, None):
                _show(replay_trial(folder, records, trial, with_margins=margins), show)
            return
        seen_from = parse_camera(camera)
        shown = side_by_side(folder, records, trial, () if alone else beside)
        if rrd is not None:
            write_rerun(rrd, shown)
            note(f"the file for Rerun is {relative(rrd)}; to open it: uv run --group rerun rerun {relative(rrd)}")
        if still is not None:
            picture = output or Path(f"{trial}.png")
            write_still(picture, shown, parse_size(still, "--still"), at=at, camera=seen_from, colour=colour.value)
            note(f"the picture is {relative(picture)}")
        if video is not None:
            pixels = parse_size(size or ("640x360" if video.suffix.lower() == ".gif" else "1280x720"), "--size")
            with ERR.status("drawing") as status:
                film = Film(pixels, fps, speed, seen_from, colour.value)
                write_video(video, shown, film, lambda done, count: status.update(f"drawing frame {done} of {count}"))
            note(f"the video is {relative(video)}")


def _show(page: Path, show: bool) -> None:
    note(f"the replay is {relative(page)}")
    if show and not webbrowser.open(page.resolve().as_uri()):
        note("no browser could be opened: open that file in a browser yourself")


def replay_trial(folder: Path, records: Sequence[TrialRecord], trial: str, *, with_margins: bool = False) -> Path:
    """Write the replay of a trial beside the same stack under other policies; return the path of the replay.

    Raises:
        UnknownNameError: if the folder has no trial with this id.
        RecordingError: if the trial has no recording, or an incomplete recording.
        ExportError: if ``with_margins`` is True, and a recording has no margins.
    """
    wanted, others = _stack(records, trial)
    shown = Replayed(wanted, ResultsFolder(folder).recording(wanted.trial))
    return write_stack_replay(folder, [shown, *read_stack(folder, others)], with_margins=with_margins)


def side_by_side(
    folder: Path, records: Sequence[TrialRecord], trial: str, beside: Sequence[str] | None
) -> list[Replayed]:
    """Return the recorded trials to draw from left to right: other trials of the same stack, then ``trial``.

    Args:
        folder: a results folder.
        records: records of that folder.
        trial: id of the trial.
        beside: policies of the other trials; None for the policy ``none``, if its trial has a complete recording.

    Raises:
        UnknownNameError: if the folder has no trial with this id, or no trial of the same stack under a policy of
            ``beside``.
        RecordingError: if a trial to draw has no recording, or an incomplete recording.
    """
    wanted, others = _stack(records, trial)
    by_policy = {record.policy: record for record in others}
    if beside is None:
        left = read_stack(folder, [by_policy["none"]] if "none" in by_policy else [])
    else:
        found = [look_up("policy of a recorded trial of this stack", policy, by_policy) for policy in beside]
        left = [Replayed(record, ResultsFolder(folder).recording(record.trial)) for record in found]
    return [*left, Replayed(wanted, ResultsFolder(folder).recording(wanted.trial))]


def _stack(records: Sequence[TrialRecord], trial: str) -> tuple[TrialRecord, list[TrialRecord]]:
    """Return the record of a trial, and the records of all other trials of the same stack."""
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    others = [record for record in records if stack_of(record) == stack_of(wanted) and record.trial != wanted.trial]
    return wanted, others


def export_gltf(folder: Path, records: Sequence[TrialRecord], trial: str, to: Path) -> None:
    """Write a trial's recording as an animated glTF file.

    Raises:
        UnknownNameError: if the folder has no trial with this id.
        RecordingError: if the trial has no recording, or an incomplete recording.
    """
    wanted = look_up("trial", trial, {record.trial: record for record in records})
    write_atomic(to, to_glb(ResultsFolder(folder).recording(wanted.trial)))
