"""Principal deviations of camera and fan together, each one standard uncertainty large.

The fan was calibrated through the camera, so that their errors are not independent: a camera that is off takes the fan
with it, which makes up for a part of the error. A set of deviations whose squares add up carries all of that through
any computation, with no derivative of it.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.2 (correlated input quantities).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal, cast

import numpy as np

from core.calibrate.camera.covariance import principal_deviations
from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.results import CameraCalibration, FanCalibration, Readjustment
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array

Source = Literal[
    "camera", "fan", "assumed fan", "bend", "scale", "assumed scale",
    "change", "assumed change", "charted change", "readjusted", "skewed fan",
    "known pose", "known flatness", "assumed known flatness", "known size", "assumed known size",
]  # fmt: skip
FANS: tuple[Source, ...] = ("fan", "assumed fan")
"""The sources that are the fan's calibration."""
SCALES: tuple[Source, ...] = ("scale", "assumed scale")
"""The sources that are the size of the plane target, which no picture of it shows."""
UNEXPLAINED: Source = "bend"
"""The source of errors that were seen, but not why: they are uncertain by all of what was seen."""
LAWLESS: tuple[Source, ...] = (UNEXPLAINED, "skewed fan")
"""The sources of errors whose law is only a bound: a fit must not take them out."""
UNMEASURED: tuple[Source, ...] = (
    "change", "assumed change", "charted change", *SCALES,
    "known flatness", "assumed known flatness", "known size", "assumed known size",
)  # fmt: skip
"""The sources of errors whose size is stated or assumed: nothing in this calibration has measured it."""

NEGLIGIBLE = 1e-12
"""Share of the largest variance below which a direction is left out: rounding."""


@dataclass(frozen=True, eq=False, slots=True)
class Deviation:
    """Camera and fan displaced together by one standard uncertainty in one direction.

    `source` says whose error it is: "camera" (the fan moves along with it, as it would have been calibrated through
    such a camera), "fan" (the camera is as calibrated), "bend" (its light is off its planes),
    "scale" (the plane target is larger than stated), "change" (the rig since then, `core.calibrate.change`),
    "readjusted" (what a re-adjustment leaves uncertain of that), "skewed fan" (its stripes have another section in the
    scan, `core.scan.changed_section`), or that of known planes (`core.scan.known_planes`): their "known pose" by the
    noise of their points, "known flatness", and "known size" where they are no print of the plane target's. Where
    nobody has stated how large scale or change may be, or how flat the plane target is, on which the fan rests,
    their sources say that they are assumed, or that the change is by the rig's own checks ("charted change").
    `planes` (K, 3) in 1/mm are the known planes of a scan then; none where it has none, or they stay.
    """

    source: Source
    camera: Camera
    fan: Fan
    planes: Array = field(default_factory=lambda: np.zeros((0, 3)))


def calibration_deviations(camera: CameraCalibration, fan: FanCalibration) -> tuple[Deviation, ...]:
    """Make deviations of camera and fan: each moved by one standard uncertainty along a principal axis of covariance.

    Let q be anything measured with a camera and a fan, and q₀ the same with the calibrated ones. Then, to first order,
    Σ (q − q₀)² over all deviations is the variance of q from the calibrations, and the sums over those of one `source`
    are its independent parts. Products of the changes of two quantities sum up to their covariance.

    Parameters
    ----------
    camera
        The camera's calibration; parameters without variance stay as they are.
    fan
        The fan's calibration with that camera. Without `by_camera` (a planes.json of another program) the fan stays
        where it is when the camera moves: q's variance then comes out larger than it need be.

    Returns
    -------
    At most 10 deviations of the camera, 3N of the fan, one of how its light is bent, and one of the scale, largest
    first within each source; none where there is no covariance.
    """
    if fan.readjusted is not None:
        return (*_of_readjustment(camera.camera, fan, fan.readjusted), *_of_bends(camera.camera, fan))
    return (
        *_of_camera(camera, fan),
        *_of_fan(camera.camera, fan),
        *_of_bends(camera.camera, fan),
        *_of_scale(camera.camera, fan),
    )


def fan_behind(fan: FanCalibration, calibrated: Camera, camera: Camera) -> Fan:
    """Compute the fan that its pictures would give with `camera` in place of `calibrated`, to first order."""
    if fan.by_camera is None:
        return fan.fan
    return moved_fan(fan.fan, fan.by_camera @ (parameters_of(camera) - parameters_of(calibrated)))


def moved_fan(fan: Fan, change: Array) -> Fan:
    """Add a `change` (3N,) in 1/mm to the vectors π of the fan's N light planes."""
    return Fan(tuple(LightPlane(pi) for pi in fan.pis + change.reshape(-1, 3)), fan.covariance)


def _of_camera(camera: CameraCalibration, fan: FanCalibration) -> Iterator[Deviation]:
    for displaced in reversed(principal_deviations(camera)):
        yield Deviation("camera", displaced, fan_behind(fan, camera.camera, displaced))


def _of_fan(camera: Camera, fan: FanCalibration) -> Iterator[Deviation]:
    values, vectors = np.linalg.eigh(np.asarray(fan.fan.covariance))
    source: Source = "fan" if fan.flatness_assumed is False else "assumed fan"
    for value, vector in zip(values[::-1], vectors.T[::-1], strict=True):
        if value > NEGLIGIBLE * values[-1]:
            yield Deviation(source, camera, moved_fan(fan.fan, np.sqrt(value) * vector))


def _of_bends(camera: Camera, fan: FanCalibration) -> Iterator[Deviation]:
    if fan.bends is not None:
        yield Deviation("bend", camera, replace(fan.fan, bends=fan.bends))


def _of_readjustment(camera: Camera, fan: FanCalibration, known: Readjustment) -> Iterator[Deviation]:
    here = parameters_of(camera)
    for source, step in zip(known.sources, known.deviations, strict=True):
        yield Deviation(
            cast(Source, source),
            camera_of(here + step[: len(here)], camera.image_size),
            moved_fan(fan.fan, step[len(here) :]),
        )


def _of_scale(camera: Camera, fan: FanCalibration) -> Iterator[Deviation]:
    """A target larger by s of itself makes all of space larger and every π smaller by s; the camera stays the same."""
    if fan.scale_sd > 0:
        source: Source = "scale" if fan.scale_assumed is False else "assumed scale"
        yield Deviation(source, camera, moved_fan(fan.fan, -fan.scale_sd * fan.fan.pis.ravel()))
