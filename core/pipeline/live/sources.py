"""All live sources by name: which can be chosen, and how each is made.

The window reads the descriptors when it starts: what only one kind needs is imported when one of it is made.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from math import degrees, radians
from pathlib import Path

import numpy as np

from core.acquire.drivers import aravis, basler, gentl, opencv_camera
from core.acquire.drivers.opencv_camera import OpenCVSource
from core.acquire.replay import FRAMES_HELD, ReplaySource
from core.acquire.source import FrameSource, SourceChoice, SourceInfo
from core.acquire.source_kind import SourceKind
from core.calibrate.sitting import SIMULATED as BY_SIMULATED_RIG
from core.errors import InputError
from core.files.pictures import read_picture
from core.files.recording.replay_pictures import ReplayPictures
from core.files.recording.rig import Rig
from core.image.targets.kinds import Rectangle
from core.messages import Message
from core.simulate.effects.boards import NO_BOARDS, BoardsBeside
from core.simulate.scenario import Scenario


def list_sources(kind: str) -> tuple[SourceInfo, ...]:
    """List the sources of a kind that can be chosen now; () if none is found, or the driver is not installed.

    Raises
    ------
    InputError
        If the kind is unknown.
    """
    found = _kind(kind)
    return () if found.missing is not None else found.list()


def missing_driver(kind: str) -> Message | None:
    """Return why sources of a kind cannot be used on this computer, and what to install; None if they can.

    Raises
    ------
    InputError
        If the kind is unknown.
    """
    return _kind(kind).missing


def make_source(choice: SourceChoice, rig: Rig | None = None) -> FrameSource:
    """Make the source that the user has chosen, without opening it.

    Parameters
    ----------
    choice
        Kind and id, see :class:`core.acquire.source.SourceChoice`.
    rig
        The project's rig: the simulated one shows its targets, the others reduce colour as it says.

    Raises
    ------
    InputError
        If the kind is unknown or not installed, or the id means nothing.
    """
    kind = _kind(choice.kind)
    if (missing := kind.missing) is not None:
        raise InputError(missing)
    return kind.make(choice.id, rig)


def camera_name(choice: SourceChoice, source: FrameSource) -> str:
    """Make the name of an open camera for the logs of recordings; "" for a replay, whose pictures are older.

    Cameras of one name at two computers are two. What lies before the simulated rig is none of its own.
    """
    if choice.kind == REPLAY.name:
        return ""
    chosen = "" if choice.kind == SIMULATED.name else choice.id
    return " ".join(" ".join((choice.kind, source.name, chosen, platform.node())).split())


def _kind(name: str) -> SourceKind:
    if name not in SOURCES:
        raise InputError(
            Message("source.no_such_kind", "{name!r} is not one of {sources}", name=name, sources=tuple(SOURCES)),
            where="source",
        )
    return SOURCES[name]


def scenario_of(text: str) -> Scenario:
    """Read the scenario of a simulated source's id: TOML, the path of a TOML file, or "" for the sample's object.

    Pictures are no larger than the sample's, whatever it says: larger ones are not made in real time.
    """
    from core.simulate.sample import sample_scenario

    if not text.strip():
        return sample_scenario()
    scenario = Scenario.from_toml(text, "simulated rig") if "=" in text else Scenario.read(Path(text))
    return replace(scenario, scale=min(scenario.scale, sample_scenario().scale))


def without_fan(scenario: Scenario, rig: Rig) -> Scenario:
    """Copy a scenario with its fan off, as a `rig` without one has it, and with the boards that this states."""
    boards = scenario.boards
    if rig.known_planes and boards == NO_BOARDS:
        outlines = any(isinstance(one.target, Rectangle) for one in rig.known_planes.values())
        boards = BoardsBeside(corner=True, kind="rectangle" if outlines else "charuco")
    return replace(scenario, fan_lines=0, boards=boards)


def _make_simulated(id_: str, rig: Rig | None) -> FrameSource:
    from core.simulate.live.scene import LiveScene
    from core.simulate.live.source import SimulatedSource

    scenario = scenario_of(id_)
    if rig is None:
        return SimulatedSource(LiveScene(scenario))
    if not rig.has_fan:
        return SimulatedSource(LiveScene(without_fan(scenario, rig), rig.camera_target, rig.plane_target))
    scene = LiveScene(scenario, rig.camera_target, rig.plane_target)
    lines, angle = scene.rig.fan.lines, float(np.median(scene.rig.fan.angles))
    if rig.lines != lines or abs(rig.angle - angle) > radians(0.2):
        raise InputError(
            Message(
                "source.simulated_laser_differs",
                "the simulated rig's laser has {lines} lines, {degrees:.3g}° apart, but the "
                "project's has {lines2}, {degrees2:.3g}° apart",
                lines=lines,
                degrees=degrees(angle),
                lines2=rig.lines,
                degrees2=degrees(rig.angle),
            ),
            where="laser fan",
            todo=Message("advice.match_laser", "set the project's laser, or choose another source"),
        )
    return SimulatedSource(scene)


def _make_replay(id_: str, rig: Rig | None) -> FrameSource:
    channel = None if rig is None else rig.live_channel
    if not id_:
        raise InputError(
            Message("source.no_folder_chosen", "no folder is chosen"),
            where="replay",
            todo=Message("advice.choose_pictures", "choose a folder of pictures"),
        )
    folder = Path(id_)
    if folder.is_file():
        return OpenCVSource(id_, channel)  # a video
    listing = ReplayPictures(folder)
    read = partial(read_picture, channel=channel)
    return ReplaySource(folder.name, folder, listing, read, holds=FRAMES_HELD if listing.is_set else {})


def _list_simulated() -> tuple[SourceInfo, ...]:
    from core.simulate.recording import scenario_rig
    from core.simulate.sample import sample_scenario

    width, height = scenario_rig(sample_scenario()).camera.image_size
    size = Message("source.picture_size", "{width} × {height} pixels", width=width, height=height)
    things = {
        "": Message("source.gauge_block", "Gauge block of 50 mm"),
        'object = "steps"': Message("source.steps", "Block with steps of 40 to 70 mm"),
        'object = "sphere"': Message("source.sphere", "Sphere of 50 mm"),
        'object = "mask"': Message("source.mask", "Mask of a face"),
    }
    return tuple(SourceInfo(SourceChoice(BY_SIMULATED_RIG, text), thing, size) for text, thing in things.items())


SIMULATED = SourceKind(
    BY_SIMULATED_RIG,
    Message("source.simulated", "Simulated rig"),
    Message("source.simulated_help", "A camera and lasers that exist only in this program, moved by hand in real time"),
    Message("source.scene", "Scene"),
    Message("source.scene_help", "What lies before the simulated rig; or the path of a scenario (TOML)"),
    Message("source.scene_usual", "the sample's rig"),
    _make_simulated,
    _list_simulated,
)
REPLAY = SourceKind(
    "replay",
    Message("source.replay", "Folder of pictures"),
    Message("source.replay_help", "Recorded pictures, one after the other, as if a camera took them now"),
    Message("source.folder", "Folder"),
    Message("source.folder_help", "The folder of pictures to replay"),
    Message("source.folder_usual", "choose a folder"),
    _make_replay,
    settings=("rate_hz",),
    is_folder=True,
)

SOURCES: Mapping[str, SourceKind] = {
    kind.name: kind for kind in (SIMULATED, opencv_camera.KIND, REPLAY, basler.KIND, gentl.KIND, aravis.KIND)
}
"""Kinds of live sources by name, in the order of lists; the first is always there."""
