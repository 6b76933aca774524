"""`python -m tests.public_sets SET …`: what the program makes of recording sets of others, as rows for the manual.

Targets found beside OpenCV's detectors, the camera, the light planes, and how far those of random halves of the
pictures lie apart in the standard deviations stated for them: 1 where these are right. Sets: `trisect import`. Slow.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.calibrate.results import CameraCalibration, FanCalibration
from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import RecordingSet, open_set
from core.image.targets import Checkerboard, CircleGrid, Target, detect
from core.model.arrays import Array
from core.pipeline.steps.camera_step import see_views, solve_camera
from core.pipeline.steps.planes_step import measure_poses, solve_planes
from core.settings.options import Options

CAMERA_HALVES, PLANES_HALVES = 6, 20
"""Splits of the pictures in two; planes are quicker to solve."""

SEED = 14

Picture = NDArray[np.uint8]
Detector = Callable[[Target, Picture], bool]


def found_here(target: Target, picture: Picture) -> bool:
    """Whether the program finds the target, or a part of it whose corners are known by the ends it shows."""
    try:
        detect(target, picture)
    except InputError:
        return False
    return True


def found_classic(target: Target, picture: Picture) -> bool:
    """Whether OpenCV's older detector does, with its own flags."""
    match target:
        case Checkerboard():
            return bool(cv2.findChessboardCorners(picture, (target.columns, target.rows))[0])
        case CircleGrid():
            return bool(cv2.findCirclesGrid(picture, (target.columns, target.rows))[0])
    return False


def found_by_sectors(target: Target, picture: Picture) -> bool:
    """Whether OpenCV's newer detector of checkerboards does, with its own flags."""
    return isinstance(target, Checkerboard) and bool(
        cv2.findChessboardCornersSB(picture, (target.columns, target.rows))[0]
    )


DETECTORS: tuple[Detector, ...] = (found_here, found_classic, found_by_sectors)


def targets_row(recording_set: RecordingSet, kind: str, target: Target, paths: Sequence[Path]) -> str:
    """How often each detector finds `target` in the pictures, at full size / halved."""
    counts = np.zeros((len(DETECTORS), 2), int)
    for path in paths:
        full = _eight_bit(PictureReader(recording_set).read_target(path))
        half = np.asarray(cv2.resize(full, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), np.uint8)
        counts += np.array([[detector(target, size) for size in (full, half)] for detector in DETECTORS])
    return f"| {recording_set.name}, {kind} | {len(paths)} | " + " | ".join(f"{a} / {b}" for a, b in counts) + " |"


def camera_row(recording_set: RecordingSet) -> tuple[CameraCalibration, str]:
    """The camera, its standard deviations, and the halves."""
    seen, rng = see_views(PictureReader(recording_set)), np.random.default_rng(SEED)
    whole = solve_camera(seen, tolerance=recording_set.rig.camera_board)
    apart = []
    for _ in range(CAMERA_HALVES):
        a, b = (
            solve_camera(seen, Options(excluded=left), tolerance=recording_set.rig.camera_board)
            for left in _halves([view.name for view in seen.found], rng)
        )
        apart.append(_apart(*(_parameters(one)[:, [0, 1, 3, 4]] for one in (a, b))))  # not the skew
    values, sd = _parameters(whole)
    shown = " | ".join(f"{v:.1f} ± {s:.1f}" for v, s in zip(values, sd, strict=True))
    return whole, f"| {recording_set.name} | {len(seen.found)} of {len(seen.views)} | {shown} | {_rms(apart):.2f} |"


def planes_row(recording_set: RecordingSet, calibration: CameraCalibration) -> str:
    """The light planes, how they foretell each pose, and the halves."""
    camera, rng = calibration.camera, np.random.default_rng(SEED)
    poses = measure_poses(PictureReader(recording_set), camera)
    usable = [pose for pose in poses if pose.reason is None]

    def solve(names: Iterable[str] = ()) -> FanCalibration:
        left = Options(excluded=frozenset(f"planes/{name}" for name in names))
        return solve_planes(poses, camera, recording_set.rig, left, calibration=calibration)

    whole = solve()
    apart = []
    for _ in range(PLANES_HALVES):
        a, b = (solve(left).fan for left in _halves([pose.name for pose in usable], rng))
        assert a.covariance is not None and b.covariance is not None
        sd = np.sqrt(np.diag(a.covariance + b.covariance)).reshape(-1, 3)
        planes = [np.array([plane.pi for plane in fan.planes]) for fan in (a, b)]
        apart.append(float(np.sqrt(np.mean(((planes[0] - planes[1]) / sd) ** 2))))
    used = sum(pose.used for pose in whole.poses)
    figures = f"{max(whole.rms_mm):.3f} mm | {whole.cross_validation_mm:.3f} mm | {_rms(apart):.2f}"
    told = ", ".join(note.code for note in whole.notes)
    return f"| {recording_set.name} | {used} of {len(poses)} | {figures} | {told} |"


def _eight_bit(picture: NDArray[np.generic]) -> Picture:
    return np.asarray(picture if picture.dtype == np.uint8 else np.asarray(picture, np.uint16) >> 8, np.uint8)


def _halves(names: Sequence[str], rng: np.random.Generator) -> tuple[frozenset[str], frozenset[str]]:
    """A random half of the names, and the other: what each of two solutions leaves out."""
    order = rng.permutation(len(names))
    half = len(names) // 2
    return frozenset(names[i] for i in order[half:]), frozenset(names[i] for i in order[:half])


def _parameters(calibration: CameraCalibration) -> Array:
    """(2, 5): fx, fy, skew, cx, cy and their standard deviations, px."""
    K = calibration.camera.matrix
    values = [K[0, 0], K[1, 1], K[0, 1], K[0, 2], K[1, 2]]
    return np.array([values, np.sqrt(np.diag(calibration.covariance)[:5])])


def _apart(a: Array, b: Array) -> float:
    """RMS of how far two sets of parameters with standard deviations (2, N) lie apart, in these."""
    return float(np.sqrt(np.mean((a[0] - b[0]) ** 2 / (a[1] ** 2 + b[1] ** 2))))


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.public_sets", description=__doc__)
    parser.add_argument("sets", nargs="+", type=Path, metavar="SET", help="recording sets, made by trisect import")
    parser.add_argument("--targets-only", action="store_true", help="count the targets found, solve nothing")
    chosen = parser.parse_args()
    for folder in chosen.sets:
        recording_set = open_set(folder)
        pictures: dict[str, tuple[Target, Sequence[Path]]] = {
            "camera": (recording_set.rig.camera_target, recording_set.camera)
        }
        if recording_set.planes:
            on, off = (
                [pair.on for pair in recording_set.planes],
                [pair.off for pair in recording_set.planes if pair.off is not None],
            )
            pictures |= {
                "laser on": (recording_set.rig.plane_target, on),
                "laser off": (recording_set.rig.plane_target, off),
            }
        for kind, (target, paths) in pictures.items():
            print(targets_row(recording_set, kind, target, paths), flush=True)
        if chosen.targets_only:
            continue
        try:
            calibration, row = camera_row(recording_set)
            print(row, flush=True)
            if recording_set.planes:
                print(planes_row(recording_set, calibration), flush=True)
        except InputError as error:
            print(f"| {recording_set.name} | {error} |", flush=True)


if __name__ == "__main__":
    main()
