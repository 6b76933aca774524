"""Errors common to all points of a scan: those of the camera's and the fan's calibration.

A covariance is the sum of the outer products of its principal deviations. So the scan is solved again with camera and
fan displaced along each of them, one standard deviation at a time, and every pixel triangulated again: to first order
the variance of any quantity of the points is the sum of the squares of its changes. No derivative of the adjustment is
needed, and what points have in common stays common. The robust weights are found anew each time: a displaced camera
moves the residuals, and with the weights and the factor of the first solution σ came out between 0.7 and 8 times as
large, from point to point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.deviations import Deviation, Source
from core.model import Camera, Fan
from core.model.arrays import Array, frozen_array, set_field
from core.model.fan import bent_pis
from core.progress import Progress, StepProgress, silent
from core.scan.features.crossings import Index
from core.scan.known_planes.known_plane import Control
from core.scan.method import Method
from core.scan.network.read_out import row_planes
from core.scan.results import ScanResult
from core.scan.surface.cloud import FAN, Cloud
from core.scan.sweeps.locate import LocatedSweeps, SweepPlanes, locate_each, planes_together
from core.stage_times import stage
from core.threads import ordered_map


@dataclass(frozen=True, eq=False, slots=True)
class CommonErrors:
    """Solutions of one scan: as calibrated, and again with each of K displaced calibrations.

    Parameters
    ----------
    image_size
        (width, height) of the camera's picture in pixels.
    sources
        (K,) which calibration each displacement comes from.
    cameras
        (1 + K, 10) parameters in the order of `core.calibrate.results.CAMERA_PARAMETERS`; first those calibrated.
    fans
        (1 + K, L, 3) light planes of the fan in 1/mm, first those calibrated.
    sweeps
        (1 + K, S, 3) light planes of the sweeps, numbered as in the cloud, in 1/mm; first those of the scan itself.
        More than 3 where rows are read one after another (`core.scan.network.read_out`).
    bends
        (1 + K, L, 3, 3) of the fan's light as in `core.model.Fan`; None where it lies in planes each time.
    """

    image_size: tuple[int, int]
    sources: tuple[Source, ...]
    cameras: Array
    fans: Array
    sweeps: Array
    bends: Array | None = None

    def __post_init__(self) -> None:
        count = 1 + len(self.sources)
        for name, shape in (("cameras", (count, 10)), ("fans", (count, None, 3)), ("sweeps", (count, None, None))):
            set_field(self, name, frozen_array(getattr(self, name), shape, name))
        if self.bends is not None:
            set_field(self, "bends", frozen_array(self.bends, (count, self.fans.shape[1], 3, 3), "bends"))

    def changes(self, uv: Array, sweep: Index) -> Iterator[Array]:
        """Yield for each displaced calibration the shifts (N, 3) in mm of points at `uv` (N, 2) px in `sweep` (N,)."""
        rays = self._rays(0, uv)
        here = self._points(0, uv, sweep, rays)
        for row in range(1, 1 + len(self.sources)):
            same = np.array_equal(self.cameras[row], self.cameras[0])
            yield self._points(row, uv, sweep, rays if same else self._rays(row, uv)) - here

    def sigma(self, cloud: Cloud) -> Array:
        """Compute the standard uncertainty (N,) in mm of the depths of a cloud that is due to the calibrations."""
        variance = np.zeros(len(cloud))
        for change in self.changes(cloud.uv, cloud.sweep):
            variance += change[:, 2] ** 2
        return np.asarray(np.sqrt(variance), dtype=np.float64)

    def sigma_of(self, source: Source, cloud: Cloud) -> Array:
        """Compute σ (N,) in mm of a cloud's depths that is due to one source of displacements; 0 if it has none."""
        variance = np.zeros(len(cloud))
        for one, change in zip(self.sources, self.changes(cloud.uv, cloud.sweep), strict=True):
            variance += change[:, 2] ** 2 if one == source else 0.0
        return np.asarray(np.sqrt(variance), dtype=np.float64)

    def planes(self, uv: Array, sweep: Index, row: int = 0) -> Array:
        """Compute the light planes (N, 3) in 1/mm of points at `uv` (N, 2) px in `sweep` (N,), by solution `row`.

        `row` 0: as calibrated; k > 0: with the displacement k − 1.
        """
        fan, sweeps = self.fans[row], self.sweeps[row]
        still = np.pad(fan[::-1], ((0, 0), (0, sweeps.shape[1] - 3)))  # fan line k is sweep FAN − k = −1 − k
        coefficients = np.concatenate([still, sweeps])[sweep + len(fan)]
        return row_planes(coefficients, uv[:, 1], self.image_size[1])

    def _rays(self, row: int, uv: Array) -> Array:
        return camera_of(self.cameras[row], self.image_size).rays(uv)

    def _points(self, row: int, uv: Array, sweep: Index, rays: Array) -> Array:
        pis = self.planes(uv, sweep, row)
        if self.bends is not None and self.bends[row].any():
            mine = sweep < 0
            pis[mine] = bent_pis(pis[mine], self.bends[row][FAN - sweep[mine]], rays[mine])
        points: Array = rays / np.einsum("ni,ni->n", rays, pis)[:, None]
        return points

    @classmethod
    def of_fan(cls, camera: Camera, fan: Fan, deviations: Sequence[Deviation]) -> CommonErrors:
        """Make the errors that displaced calibrations cause in points of the fan alone, for a scan without sweeps."""
        return cls(
            camera.image_size,
            tuple(one.source for one in deviations),
            np.array([parameters_of(camera), *(parameters_of(one.camera) for one in deviations)]),
            np.array([fan.pis, *(one.fan.pis for one in deviations)]),
            np.zeros((1 + len(deviations), 0, 3)),
            _bends(fan, deviations),
        )


def solve_common(
    scan: ScanResult,
    camera: Camera,
    fan: Fan | Control,
    deviations: Sequence[Deviation],
    method: Method = Method.NETWORK,
    progress: Progress = silent,
) -> CommonErrors:
    """Solve a scan again from the same crossings with each of the displaced calibrations `deviations`.

    `camera` and `fan`, or a control, are those it was solved with.

    Raises
    ------
    InputError
        If a scan cannot be solved with one of them.
    """
    reported = StepProgress(progress)
    reported("calibration uncertainty", 0, len(deviations))
    together = method == Method.NETWORK
    crossings, line = scan.crossings.select(scan.of_solved), scan.crossing_lines[scan.of_solved]
    control, sweeps = Control.of(fan), [scan.pis]

    def solved(one: Deviation) -> Array:
        with stage(progress, "calibration uncertainty"):
            if together:
                moved = control.displaced(one)
                again: SweepPlanes | LocatedSweeps
                again = planes_together(crossings, line, one.camera, moved, read_out=scan.read_out)
            else:
                again = locate_each(crossings, line, one.camera, one.fan)
        return np.asarray(again.pis[np.searchsorted(again.frames, scan.sweep_frames)])

    idle = partial(reported.within_step, "calibration uncertainty", 0, len(deviations))
    for pis in ordered_map(solved, deviations, idle=idle):
        sweeps.append(pis)
        reported("calibration uncertainty", len(sweeps) - 1, len(deviations))
    return replace(CommonErrors.of_fan(camera, control.fan, deviations), sweeps=np.array(sweeps))


def _bends(fan: Fan, deviations: Sequence[Deviation]) -> Array | None:
    forms = [one.fan.bends for one in deviations]
    if all(form is None for form in forms):
        return None
    flat = np.zeros((fan.lines, 3, 3))
    return np.array([flat, *(flat if form is None else form for form in forms)])
