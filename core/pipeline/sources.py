"""All live sources by name: what they are, which can be chosen, and how each is made."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import degrees, radians
from pathlib import Path

import numpy as np

from core.acquire import aravis_driver, basler_driver, gentl_driver
from core.acquire.genicam import Driver, GenICamSource
from core.acquire.opencv_camera import OpenCVSource
from core.acquire.opencv_devices import list_cameras, opencv_name
from core.acquire.replay import HOLDS, ReplaySource
from core.acquire.source import FrameSource, SourceChoice, SourceInfo
from core.errors import InputError
from core.files.pictures import read_picture
from core.files.replay_pictures import ReplayPictures
from core.files.rig import Rig
from core.simulate.live import SimulatedSource
from core.simulate.live_scene import LiveScene
from core.simulate.recording import scenario_rig
from core.simulate.sample import sample_scenario
from core.simulate.scenario import Scenario

Made = Callable[[SourceChoice, Rig | None], FrameSource]
Listed = Callable[[], tuple[SourceInfo, ...]]


@dataclass(frozen=True, slots=True)
class SourceKind:
    """One kind of live source.

    Parameters
    ----------
    title
        What a list shows.
    help
        One line: what it is, and what its `id` is.
    make, list
        Makes a source of a choice; lists the choices that can be found without asking.
    settings
        Names of :class:`core.acquire.source.SourceSettings` that sources of this kind may have; which of them one
        really has it says when it is open.
    is_missing
        Whether its driver is not installed.
    install
        One sentence: what to install if it is missing.
    """

    title: str
    help: str
    make: Made
    list: Listed
    settings: tuple[str, ...] = ("rate_hz",)
    is_missing: Callable[[], bool] = bool
    install: str = ""

    @property
    def missing(self) -> str:
        """Why this kind cannot be used on this computer, and what to install; "" if it can."""
        return self.install if self.is_missing() else ""


def list_sources(kind: str) -> tuple[SourceInfo, ...]:
    """The sources of a kind that can be chosen now; empty if none is found, or its driver is not installed.

    Raises
    ------
    InputError
        If the kind is unknown.
    """
    found = _kind(kind)
    return () if found.missing else found.list()


def missing_driver(kind: str) -> str:
    """Why sources of a kind cannot be used on this computer, and what to install; "" if they can.

    Raises
    ------
    InputError
        If the kind is unknown.
    """
    return _kind(kind).missing


def make_source(choice: SourceChoice, rig: Rig | None = None) -> FrameSource:
    """The source of a choice, not opened yet.

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
    if kind.missing:
        raise InputError(kind.missing.removesuffix("."))
    return kind.make(choice, rig)


def _kind(name: str) -> SourceKind:
    if name not in SOURCES:
        raise InputError(f"{name!r} is not one of {', '.join(SOURCES)}", where="source")
    return SOURCES[name]


def scenario_of(text: str) -> Scenario:
    """The scenario a simulated source's id means: TOML, the path of a TOML file, or "" for the sample's object.

    Pictures are no larger than the sample's, whatever it says: larger ones are not made in real time.
    """
    if not text.strip():
        return sample_scenario()
    scenario = Scenario.from_toml(text, "simulated rig") if "=" in text else Scenario.read(Path(text))
    return replace(scenario, scale=min(scenario.scale, sample_scenario().scale))


def _make_simulated(choice: SourceChoice, rig: Rig | None) -> SimulatedSource:
    scenario = scenario_of(choice.id)
    if rig is None:
        return SimulatedSource(LiveScene(scenario))
    scene = LiveScene(scenario, rig.camera_target, rig.plane_target)
    lines, angle = scene.rig.fan.lines, float(np.median(scene.rig.fan.angles))
    if rig.lines != lines or abs(rig.angle - angle) > radians(0.2):
        raise InputError(
            f"the simulated rig's laser has {lines} lines, {degrees(angle):.3g}° apart, but the project's has "
            f"{rig.lines}, {degrees(rig.angle):.3g}° apart",
            where="laser fan",
            todo="set the project's laser, or choose another source",
        )
    return SimulatedSource(scene)


def _make_opencv(choice: SourceChoice, rig: Rig | None) -> OpenCVSource:
    return OpenCVSource(choice.id, None if rig is None else rig.channel)


def _make_replay(choice: SourceChoice, rig: Rig | None) -> FrameSource:
    if not choice.id:
        raise InputError("no folder is chosen", where="replay", todo="choose a folder of pictures")
    folder = Path(choice.id)
    if folder.is_file():
        return _make_opencv(choice, rig)  # a video
    read = partial(read_picture, channel=None if rig is None else rig.channel)
    listing = ReplayPictures(folder)
    return ReplaySource(folder.name, folder, listing, read, holds=HOLDS if listing.is_set else {})


def _make_basler(choice: SourceChoice, rig: Rig | None) -> GenICamSource:
    return _genicam(f"Basler {choice.id}", partial(basler_driver.connect, choice.id), rig)


def _make_genicam(choice: SourceChoice, rig: Rig | None) -> GenICamSource:
    return _genicam(choice.id or "GenICam camera", partial(gentl_driver.connect, choice.id), rig)


def _make_aravis(choice: SourceChoice, rig: Rig | None) -> GenICamSource:
    return _genicam(choice.id or "Aravis camera", partial(aravis_driver.connect, choice.id), rig)


def _genicam(name: str, connect: Callable[[], Driver], rig: Rig | None) -> GenICamSource:
    return GenICamSource(name.strip(), connect, None if rig is None else rig.channel)


def _list_simulated() -> tuple[SourceInfo, ...]:
    size = "{} × {} pixels".format(*scenario_rig(sample_scenario()).camera.image_size)
    things = {
        "": "Gauge block of 50 mm",
        'object = "steps"': "Block with steps of 40 to 70 mm",
        'object = "sphere"': "Ball of 50 mm",
        'object = "mask"': "Mask of a face",
    }
    return tuple(SourceInfo(SourceChoice("simulated", text), thing, size) for text, thing in things.items())


def _list_opencv() -> tuple[SourceInfo, ...]:
    return tuple(
        SourceInfo(SourceChoice("opencv", number), name, opencv_name(number)) for number, name in list_cameras()
    )


def _list_by(kind: str, list_cameras: Callable[[], list[tuple[str, str, str]]]) -> Listed:
    """Lists what a driver finds: identifier, name and what else is known of each camera."""
    return lambda: tuple(
        SourceInfo(SourceChoice(kind, identifier), name, detail) for identifier, name, detail in list_cameras()
    )


def _is_not_installed(module: str) -> bool:
    return importlib.util.find_spec(module) is None


_CAMERA = ("exposure_ms", "gain_db", "rate_hz")
_GENICAM = (*_CAMERA, "trigger", "pixel_format", "region")

SOURCES: Mapping[str, SourceKind] = {
    "simulated": SourceKind(
        "Simulated rig",
        "A camera and lasers that exist only in this program, moved by hand in real time.",
        _make_simulated,
        _list_simulated,
        settings=_CAMERA,
    ),
    "opencv": SourceKind(
        "Camera or video",
        "A camera of this computer by its number, a network camera by its address, or a video file.",
        _make_opencv,
        _list_opencv,
        settings=_CAMERA,
    ),
    "replay": SourceKind(
        "Folder of pictures",
        "Recorded pictures or a video, one after the other, as if a camera took them now.",
        _make_replay,
        lambda: (),
    ),
    "basler": SourceKind(
        "Basler camera",
        "An industrial camera of Basler, by its serial number.",
        _make_basler,
        _list_by("basler", basler_driver.list_cameras),
        settings=_GENICAM,
        is_missing=partial(_is_not_installed, basler_driver.MODULE),
        install=basler_driver.INSTALL,
    ),
    "genicam": SourceKind(
        "GenICam camera",
        "An industrial camera of any maker, by its GenTL producer (.cti).",
        _make_genicam,
        _list_by("genicam", gentl_driver.list_cameras),
        settings=_GENICAM,
        is_missing=partial(_is_not_installed, gentl_driver.MODULE),
        install=gentl_driver.INSTALL,
    ),
    "aravis": SourceKind(
        "GigE or USB3 camera",
        "An industrial camera of any maker, by Aravis, by its name or network address.",
        _make_aravis,
        _list_by("aravis", aravis_driver.list_cameras),
        settings=_GENICAM,
        is_missing=aravis_driver.is_missing,
        install=aravis_driver.INSTALL,
    ),
}
"""Kinds of live sources by name, the usual one first."""
