"""A recording survives what happens around it: a source unplugged, a process killed, a window closed."""

from __future__ import annotations

import os
import shutil
import signal
from pathlib import Path

import pytest

from core.files.pictures import read_picture
from core.files.project.data import new_project
from core.files.project.folder import read_project
from core.files.recording.set_listing import scan_frames
from tests.workbench.technician import Technician

SCENE = "scale = 0.2\nseed = 3\n"
TIMES = 8
"""So many times the frames of the small set are played."""


@pytest.fixture
def camera_folder(simulated: Path, tmp_path: Path) -> Path:
    """A set that stands for a camera: it can be unplugged by moving it away."""
    folder = Path(shutil.copytree(simulated, tmp_path / "unpluggable"))
    frames = sorted((folder / "scan").glob("frame*.png"))
    for time in range(1, TIMES):
        for number, frame in enumerate(frames):
            os.link(frame, folder / "scan" / f"frame{time * len(frames) + number:04d}.png")
    return folder


def live_scan(t: Technician, folder: Path, kind: str, device: str) -> None:
    """A new project, and a recording of a scan that has begun."""
    t.model.create(folder, new_project("Live"))
    t.window.go_to("scan")
    t.press("Live source")
    t.choose("Kind of source", kind)
    t.until(lambda: not t.presenter().live.settings.looking, "the devices to be listed")
    t.type_in(t.field("Device"), device)
    assert t.presenter().live.settings.choice.id == device
    t.press("Start live")
    recorded(t, 5)


def recorded(t: Technician, count: int) -> None:
    """Wait until so many frames are recorded."""
    t.until(lambda: t.window.presenters["scan"].live.recorded >= count, f"{count} frames to be recorded")  # type: ignore[attr-defined]


def all_readable(folder: Path, at_least: int) -> None:
    """Every frame is whole."""
    reference, frames = scan_frames(folder)
    assert reference is not None
    assert len(frames) >= at_least
    for path in (reference, *frames):
        assert read_picture(path).ndim == 2


def test_a_source_unplugged_in_the_middle_comes_back_and_the_recording_goes_on(
    technician: Technician, camera_folder: Path, tmp_path: Path
) -> None:
    t = technician
    live_scan(t, tmp_path / "project", "Folder of pictures", str(camera_folder))
    live = t.presenter().live
    away = camera_folder.rename(tmp_path / "away")
    t.until(lambda: live.gone, "the source to be missed")
    assert t.page().strip.isVisible()
    assert "unplugged" in live.state_text()
    assert [text for text in t.told() if "not there any more" in text] != []
    before = live.recorded
    assert before >= 5
    away.rename(camera_folder)
    t.until(lambda: not live.gone, "the source to be back")
    recorded(t, before + 5)
    assert not t.page().strip.isVisible()
    t.press("Stop")
    t.until(lambda: not live.running, "the end of the recording")
    all_readable(tmp_path / "project" / t.model.project.sources.scan, before + 5)
    assert len([text for text in t.told() if "unpluggable" in text]) == 2  # gone, and back
    assert t.errors() == []


def test_the_process_of_a_recording_killed_loses_nothing_that_was_recorded(
    technician: Technician, tmp_path: Path
) -> None:
    t = technician
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    live_scan(t, tmp_path / "project", "Simulated rig", str(scene))
    live = t.presenter().live
    count = live.recorded
    os.kill(t.bench.live.pid, signal.SIGKILL)
    t.until(lambda: not live.running, "the end to be noticed")
    (said,) = t.errors()
    assert "ended unexpectedly" in said
    all_readable(tmp_path / "project" / t.model.project.sources.scan, count - 1)  # one may have been on its way
    t.press("Start live")
    recorded(t, 3)
    t.press("Stop")
    t.until(lambda: not live.running, "the end of the recording")
    assert len(t.errors()) == 1


def test_closing_while_scanning_asks_and_leaving_keeps_what_is_recorded(technician: Technician, tmp_path: Path) -> None:
    t = technician
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE)
    folder = tmp_path / "project"
    live_scan(t, folder, "Simulated rig", str(scene))
    live = t.presenter().live
    with t.answers("Stay") as asked:
        t.window.leave()
    assert asked == ["A recording is running. What is recorded is kept. Stop it and leave?"]
    assert t.window.isVisible()
    assert live.running
    before = live.recorded
    recorded(t, before + 3)
    with t.answers("Stop and leave"):
        t.window.leave()
    t.until(lambda: not t.window.isVisible(), "the recording to end, and the window to close")
    assert not live.running
    saved = read_project(folder).project
    assert saved.sources.scan.startswith("recordings/scan-")
    all_readable(folder / saved.sources.scan, before + 3)
    assert not (folder / ".autosave.json").exists()
    assert t.errors() == []


def test_closing_while_measuring_asks_and_leaving_keeps_the_result_before(
    technician: Technician, measured_project: Path
) -> None:
    t = technician
    t.window.projects.open_project(measured_project)
    t.window.go_to("scan")
    t.idle()
    before = read_project(measured_project).results["scan"]
    t.press("Measure again")
    t.until(lambda: t.presenter().stage == "measuring", "the measurement to begin")
    with t.answers("Stay"):
        t.window.leave()
    assert t.bench.measuring.busy
    with t.answers("Stop and leave"):
        t.window.leave()
    assert not t.window.isVisible()
    assert read_project(measured_project).results["scan"] == before
    assert (measured_project / "results" / "cloud.ply").exists()
