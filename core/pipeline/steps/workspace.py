"""The folder of results: the names in it, and the record of how they came about."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.calibrate.deviations import Deviation, calibration_deviations
from core.calibrate.results import NO_FAN, CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.atomic import cannot_write, make_folder
from core.files.folder_lock import NEW_FOLDER
from core.files.pictures import write_picture
from core.files.reading import file_hash
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RIG, RecordingSet, require_outside
from core.files.results.camera_file import camera_id, read_camera
from core.files.results.planes_file import planes_id, read_planes
from core.files.results.run_file import RunRecord, read_run, write_run
from core.files.step_graph import FILES, GRAPH, READJUST, resting_on
from core.held_files import remove, remove_tree, rename
from core.memory import give_back
from core.messages import Command, Message
from core.model import Camera
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.known_planes.plane_deviations import followed_by_planes
from core.scan.results import FrameRecord

_READ_FRAMES = tuple(step.name for step in GRAPH if "scan" in step.reads)
"""Steps that measure the pictures of the scan, whose log says whether they are simulated."""
_MADE_IN_ORDER = tuple(made for step in GRAPH for made in step.makes)
CLEARED = (*reversed(_MADE_IN_ORDER), "run")
"""The same in the order in which they go: what rests on another goes before it, and what tells of all of them last."""
_PLACED = (*_MADE_IN_ORDER, "run")
"""And in which they come."""

HAS_FAN = "fan"
"""Setting of the scan step in run.json: whether the rig has a fan, where it is stated that it has none."""
RIDGES = "planes"
"""Folder beside the results with a picture of each pose on which the last search found no stripe: NAME-ridge.png. It is
of the recording set alone: no result rests on it, nor it on any, and it is there where no planes came of the search."""


@dataclass(frozen=True, eq=False, slots=True)
class Calibration:
    """Calibrated camera and fan that a scan is measured with, the id of the two, and the known `planes` of the scan."""

    camera: CameraCalibration
    fan: FanCalibration
    planes: tuple[KnownPlane, ...] = ()

    @property
    def control(self) -> Control:
        """What the sweeps of a scan are tied to: fan and known planes."""
        return Control(self.fan.fan, self.planes)

    @property
    def deviations(self) -> tuple[Deviation, ...]:
        """Deviations of camera and fan by their calibrations, and how known planes follow them."""
        of_calibration = calibration_deviations(self.camera, self.fan)
        return followed_by_planes(of_calibration, self.camera.camera, self.control, self.fan.scale_sd)

    def with_planes(self, planes: Sequence[KnownPlane]) -> Calibration:
        """Copy the calibration with other known planes; without a fan the size of their boards is that of the scan."""
        fan = self.fan
        if not fan.fan.lines:
            fan = replace(fan, scale_assumed=any(plane.scale_assumed for plane in planes))
        return replace(self, fan=fan, planes=tuple(planes))

    @property
    def id(self) -> str:
        """Id of camera and fan together, written into everything measured with them."""
        return f"{camera_id(self.camera.camera)}-{planes_id(self.fan.fan)}"


def planes_of(calibration_id: str) -> str:
    """Return the part of a calibration's id that is the id of the fan."""
    return calibration_id.rpartition("-")[2]


@dataclass(frozen=True, eq=False, slots=True)
class StepLog:
    """Settings, notes and frames of a step for run.json, and the folder of its results until they are complete."""

    beside: Path
    pictures: PictureReader
    """Reads the pictures of the set: what it has read are inputs of the step."""
    gone: set[str]
    """Results of another step that these take the place of."""
    settings: dict[str, Any] = field(default_factory=dict)
    notes: list[Message | str] = field(default_factory=list)
    frames: list[FrameRecord] = field(default_factory=list)

    def path(self, name: str) -> Path:
        """Return the path to which the step writes its result called `name`, a key of FILES."""
        return self.beside / FILES[name]


@dataclass(frozen=True, eq=False, slots=True)
class Workspace:
    """Recording set and the folder of its results; `part` names the part if it is not named like the set.

    What the pictures of an interim check showed is kept in the folder `kept`, if there is one.
    """

    recording_set: RecordingSet
    out: Path
    part: str = ""
    kept: Path | None = None

    @classmethod
    def open(cls, recording_set: RecordingSet, out: Path, part: str = "", kept: Path | None = None) -> Workspace:
        """Make a workspace and its folder, if that is missing; InputError if nothing can be written there."""
        require_outside(recording_set, out)
        return cls(recording_set, make_folder(out), part, kept)

    def path(self, name: str) -> Path:
        """Return the path of the result called `name`, a key of FILES."""
        return self.out / FILES[name]

    def clear(self) -> None:
        """Remove all results of an earlier run, so that old and new are never mixed, even after an interruption."""
        self.put_ridges({})
        put_results(self.out, None, CLEARED)

    def put_ridges(self, ridges: Mapping[str, NDArray[np.uint8]]) -> None:
        """Write pictures (H, W), by the names of their poses, into the folder RIDGES in place of all older ones.

        Raises
        ------
        InputError
            If nothing can be written there.
        """
        folder = self.out / RIDGES
        try:
            for old in folder.glob("*-ridge.png"):
                remove(old)
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()
        except OSError as error:
            raise cannot_write(folder, error) from error
        for name, ridge in ridges.items():
            write_picture(make_folder(folder) / f"{name}-ridge.png", ridge)

    def written(self) -> dict[str, Path]:
        """List the paths of the results that have been written, by their keys in FILES."""
        return {name: self.path(name) for name in FILES if self.path(name).exists()}

    def calibration(self) -> Calibration:
        """Read camera.json and planes.json; InputError if one is missing or wrong, or they do not belong together.

        Where the rig has no fan, the camera alone.
        """
        return read_calibration(self.out, has_fan=self.recording_set.rig.has_fan)

    def record(self) -> RunRecord:
        """Read run.json as it is so far; an empty record where there is none."""
        if self.path("run").exists():
            return read_run(self.path("run"))
        return RunRecord(self.recording_set.name, self.part or self.recording_set.name, _now())

    @contextmanager
    def step(self, name: str, *, measures: bool = True) -> Iterator[StepLog]:
        """Time the step in this block and, if it succeeds, put its results in place and add it to run.json.

        Whoever cuts it off leaves the old results; whoever cuts off its very end leaves results that belong together.

        Parameters
        ----------
        name
            camera, planes, check, readjust, scan, profile, gauge or report.
        measures
            Whether the step measures anything: then its beginning is the time the report prints.
        """
        begun, started = _now(), time.perf_counter()
        self.record()  # a damaged run.json is told before the work, not after it
        gone: set[str] = set()
        with staged(self.out, name, gone) as beside:
            log = StepLog(beside, PictureReader(self.recording_set), gone)
            yield log
            seconds = time.perf_counter() - started
        inputs = {RIG: self.recording_set.rig_hash, **log.pictures.hashes}
        record = self.record().with_step(name, seconds, inputs, log.settings, log.notes)
        if self.part:
            record = replace(record, part=self.part)
        if measures:
            made_at = {**record.made_at, name: begun}
            record = replace(record, measured_at=begun, made_at=made_at)
        if name in _READ_FRAMES:
            record = replace(record, simulated=self.recording_set.simulated)
        if log.frames:
            record = replace(record, frames=tuple(log.frames))
        write_run(self.path("run"), record)
        give_back()


@contextmanager
def staged(out: Path, step: str, gone: Collection[str] = ()) -> Iterator[Path]:
    """Make a folder for a step's new results; if the block succeeds, they replace the old ones in `out`.

    Parameters
    ----------
    out
        Where the results belong.
    step
        Its name; run.json tells no longer of it, nor of what goes with the old results.
    gone
        Further results that go, keys of FILES, even where there is no new one; looked at in the end.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    with made_beside(out) as beside:
        yield beside
        _renew(out, beside, step, gone)


def _renew(out: Path, beside: Path, step: str, gone: Collection[str] = ()) -> None:
    """Put what a step has made in `beside` among the results in `out`; those `gone`, and what rests on what is
    another now, go.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    new = {name for name in FILES if (beside / FILES[name]).exists()}
    same = {name for name in new if _same(beside / FILES[name], out / FILES[name])}
    for name in same:
        (beside / FILES[name]).unlink()  # made just now
    old = {name for name in {*new, *gone} - same if (out / FILES[name]).exists()}
    old |= {one for name in old for one in resting_on(name)} - same
    run = out / FILES["run"]
    if run.exists() and "run" not in old and old - {"report"}:  # it never tells of other results than those beside it
        undone = {one.name for one in GRAPH if one.decides in old} - ({"planes"} if step == READJUST else set())
        write_run(run, read_run(run).without({step, *undone}))
    put_results(out, beside, old)


@contextmanager
def made_beside(out: Path) -> Iterator[Path]:
    """Make a folder inside `out` for new results; it is removed at the end of the block with all that is left in it.

    Raises
    ------
    InputError
        If it cannot be made.
    """
    beside = out / NEW_FOLDER
    try:
        remove_tree(beside)  # of a program that was killed; what is in it would be taken for new
        beside.mkdir(exist_ok=True)
    except OSError as error:
        raise cannot_write(out, error) from error
    try:
        yield beside
    finally:
        remove_tree(beside, leave=True)


def put_results(out: Path, beside: Path | None, gone: Collection[str]) -> None:
    """Remove the results `gone` from `out`, keys of FILES, then move there what is in `beside`, if any.

    What rests on another goes before it and comes after it: whoever pulls the plug finds old ones or new ones, perhaps
    not all, but never both.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    try:
        for name in sorted(gone, key=CLEARED.index):
            remove(out / FILES[name])
        for name in _PLACED if beside is not None else ():
            if beside is not None and (beside / FILES[name]).exists():
                rename(beside / FILES[name], out / FILES[name])
    except OSError as error:
        raise cannot_write(out, error) from error


def _same(one: Path, other: Path) -> bool:
    return other.exists() and file_hash(one) == file_hash(other)


def read_calibration(out: Path, *, has_fan: bool | None = None) -> Calibration:
    """Read camera.json and planes.json in `out`; InputError if one is missing or wrong, or they do not match.

    Of a rig that has no fan, only camera.json: `has_fan` is what the rig states; None: what run.json in `out` does.
    """
    camera = read_camera(out / FILES["camera"])
    if has_fan is None:
        has_fan = not (out / FILES["run"]).exists() or states_fan(read_run(out / FILES["run"]))
    if not has_fan:
        return Calibration(camera, NO_FAN)
    fan = read_planes(out / FILES["planes"], camera.camera)
    return Calibration(fan.camera_used(camera), fan)


def states_fan(record: RunRecord) -> bool:
    """Whether what a run.json tells of was measured with a fan."""
    has_fan: bool = record.settings.get("scan", {}).get(HAS_FAN, True)
    return has_fan


def check_calibration(path: Path, found_id: str, calibration: Calibration) -> None:
    """Raise InputError if the calibration's id `found_id` in a result is not that of `calibration`; "" passes."""
    if found_id and found_id != calibration.id:
        raise InputError(
            Message(
                "project.result_of_other_calibration",
                "was measured with calibration {found_id}, but camera.json and planes.json are {id}",
                found_id=found_id,
                id=calibration.id,
            ),
            where=path,
            todo=Message(
                "advice.scan_again",
                "measure the scan again{command}",
                command=Command("trisect scan SET --out DIR"),
            ),
        )


def check_size(path: Path, shape: tuple[int, ...], camera: Camera) -> None:
    """Raise InputError if a picture (height, width) is not of the size the camera was calibrated at."""
    height, width = shape
    if (width, height) != camera.image_size:
        wanted = " × ".join(map(str, camera.image_size))
        raise InputError(
            Message(
                "project.picture_size_of_camera",
                "the picture has {width} × {height} pixels, but camera.json was calibrated at {wanted}",
                width=width,
                height=height,
                wanted=wanted,
            ),
            where=path,
            todo=Message("advice.calibrate_with_this_size", "calibrate the camera with pictures of this size"),
        )


def _now() -> datetime:
    return datetime.now(UTC).astimezone()
