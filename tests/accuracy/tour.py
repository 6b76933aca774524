"""The simulated tour without a window: what its pages ask for is recorded, in its true size, and measured.

    python -m tests.accuracy tour

Each recording ends when its page says so: the camera's and the planes' when nothing is missing, the scan's when enough
is covered. Nothing but the block's nominal size, its material and the flatness of the plates is stated, as in the
project that *Try with the simulated rig* makes. Planes and scan are of one sitting by their logs, so the window asks
for no pictures of a check.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.acquire.source import SourceChoice, SourceSettings
from core.files.recording.recording_set import open_set
from core.files.recording.rig import rig_to_toml
from core.pipeline.live.commands import Command, LiveRequest, Stop
from core.pipeline.live.events import CameraDetail, LiveEvent, LiveView, PlanesDetail, ScanDetail
from core.pipeline.live.session import run_live
from core.pipeline.run import run
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.workspace import Workspace
from core.scan.preview.hints import ENOUGH
from core.simulate.sample import sample_scenario, simulated_project

FAST = SourceSettings(rate_hz=0.0)
"""Each frame as soon as it is made and the last one was looked at: what is recorded does not hang on the machine."""

MOST_FRAMES = 1500
"""Two minutes: three times what a recording takes."""


def is_enough(event: LiveEvent) -> bool:
    """Whether a page would ask for *Stop* on this event."""
    match event:
        case LiveView(detail=CameraDetail(missing=missing, views=count)):
            return count > 0 and not missing
        case LiveView(detail=PlanesDetail(missing=missing, poses=count)):
            return count > 0 and not missing
        case LiveView(detail=ScanDetail(stage=stage, share=share)):
            return stage == "scanning" and share >= ENOUGH
    return False


def recorded(request: LiveRequest) -> int:
    """Record until the page asks for *Stop*; how many pictures are kept.

    Raises
    ------
    RuntimeError
        If it has not asked for it after MOST_FRAMES, and never might.
    """
    commands: list[Command] = []
    last = ""

    def hear(event: LiveEvent) -> None:
        nonlocal last
        if isinstance(event, LiveView) and event.index > MOST_FRAMES:
            last = str(getattr(event.detail, "sentence", ""))
        if last or is_enough(event):
            commands.append(Stop())

    ended = run_live(request, lambda: commands.pop(0) if commands else None, hear, lambda: True)
    assert ended.error is None, ended.error
    if last:
        raise RuntimeError(f"{request.step}: not enough after {MOST_FRAMES} frames, and the page says: {last}")
    return ended.recorded


def tour(seed: int, folder: Path, tell: Callable[[str], None] = print) -> dict[str, Any]:
    """Error and U in mm, verdict and contributions of the tour on a rig of this seed; its pictures go into `folder`."""
    begun = time.perf_counter()
    scenario, rig = replace(sample_scenario(), seed=seed), simulated_project("tour").rig
    choice = SourceChoice("simulated", f"scale = {scenario.scale}\nseed = {seed}")
    recording, out = folder / "set", folder / "out"
    recording.mkdir(parents=True)
    (recording / "rig.toml").write_text(rig_to_toml(rig))
    views = recorded(LiveRequest("camera", choice, FAST, rig, recording / "camera"))
    camera = camera_step(Workspace.open(open_set(recording), out)).camera
    poses = recorded(LiveRequest("planes", choice, FAST, rig, recording / "planes", camera=camera))
    fan = planes_step(Workspace.open(open_set(recording), out)).fan
    now = time.time()
    asked = LiveRequest("scan", choice, FAST, rig, recording / "scan", camera=camera, fan=fan, calibrated_s=now)
    frames = recorded(replace(asked, ending=".pgm"))
    gauge = run(recording, out).gauge
    assert gauge is not None
    figures = {
        "seed": seed,
        "error": gauge.thickness_mm - scenario.height_mm,
        "U": gauge.U_mm,
        "verdict": str(gauge.verdict),
        "doubts": [doubt.fact for doubt in gauge.doubts],
        "recorded": [views, poses, frames],
        "budget": {row.words.code: row.u_mm for row in gauge.budget},
        "seconds": round(time.perf_counter() - begun),
    }
    tell(tour_row(figures))
    return figures


def tour_row(one: Mapping[str, Any]) -> str:
    """The line of one tour in the table."""
    views, poses, frames = one["recorded"]
    return (
        f"| {one['seed']} | {1e3 * one['error']:+.0f} | {1e3 * one['U']:.0f} | {one['verdict']} | "
        f"{views}, {poses}, {frames} | {one['seconds']} |"
    )


def tour_table(found: Sequence[Mapping[str, Any]]) -> list[str]:
    """A line for each tour, and how many end as they are to."""
    lines = ["| seed | error, µm | U, µm | verdict | views, poses, frames | s |", "|---" * 6 + "|"]
    good = sum(ends_well(one) for one in found)
    return [*lines, *map(tour_row, found), "", f"{good} of {len(found)} tours end as they are to."]


def ends_well(one: Mapping[str, Any]) -> bool:
    """Whether a tour ends within 0.02 mm, with U of at most 0.03 mm, and conforming."""
    return abs(one["error"]) <= 0.02 and one["U"] <= 0.03 and one["verdict"] == "conforming"
