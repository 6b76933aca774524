"""Does the truth lie within what is stated? Scans at the level of centrelines, each with calibrations of its own.

Camera and fan are calibrated once from simulated corners and stripes, for their covariance. Each scan then is
measured with another camera and fan, drawn from it about the true ones, and fresh noise on all centrelines; network,
cloud, gauge and budget are the program's own. What displaced calibrations do to the sweeps hangs on the geometry alone
and is computed once for each block.

    from tests.accuracy.coverage import run
    result = run(scans=200, seed=1)
    print(result)

or, with what has come out so far after every scan, `python -m tests.accuracy.coverage 200 1`.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from itertools import islice
from multiprocessing import get_context

import numpy as np

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.deviations import Deviation, Source, calibration_deviations, moved_fan
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.inspect.gauge import fit_gauge
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Camera, Fan
from core.scan.common_errors import CommonErrors, solve_common
from core.scan.reconstruct import reconstruct
from core.scan.results import ScanResult
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from tests.calibrate import camera_views, fan_scenes
from tests.scan.centreline_scan import ExactScan

BLOCKS = (("block", 40.0), ("block", 70.0), ("narrow-block", 50.0), ("block", 50.0), ("block", 60.0))
ON_FACE_MM = 1.0
"""Points farther than this from both faces lie on none of them."""


@dataclass(frozen=True)
class Coverage:
    """Thickness errors and U (k = 2) in mm of all scans, and of each the share of points within 2σ of the truth."""

    errors_mm: np.ndarray
    U_mm: np.ndarray
    points: np.ndarray
    independent_mm: np.ndarray
    """Errors of the fit that takes points for independent, for comparison."""

    @property
    def within_U(self) -> float:
        """Share of the scans whose error is no larger than U."""
        return float(np.mean(np.abs(self.errors_mm) <= self.U_mm))

    @property
    def points_within(self) -> float:
        """Mean share of points within 2σ, with what calibrations add."""
        return float(np.mean(self.points))

    @property
    def normalised(self) -> float:
        """RMS of error over standard uncertainty: 1 where the uncertainty is true."""
        return float(np.sqrt(np.mean((2 * self.errors_mm / self.U_mm) ** 2)))

    def __str__(self) -> str:
        rms, alone = (1000 * float(np.sqrt(np.mean(e**2))) for e in (self.errors_mm, self.independent_mm))
        return (
            f"{len(self.errors_mm)} scans: |error| <= U in {100 * self.within_U:.1f} %, error/u {self.normalised:.2f} "
            f"rms; points within 2 sigma {100 * self.points_within:.1f} %; thickness error {rms:.1f} um rms "
            f"(points taken for independent: {alone:.1f} um), u {500 * float(np.mean(self.U_mm)):.1f} um"
        )


def run(scans: int = 200, seed: int = 1, *, blocks: int = len(BLOCKS), frames: int = 60, workers: int = 2) -> Coverage:
    """Measure `scans` simulated scans of the first so many BLOCKS, `frames` sweeps each; the same seed, the same."""
    shares = [(index, len(range(index, scans, blocks)), seed, frames) for index in range(blocks)]
    if workers > 1:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            parts = list(pool.map(_block, *zip(*shares, strict=True)))
    else:
        parts = [_block(*share) for share in shares]
    return Coverage(*np.concatenate(parts, axis=1))


def told(scans: int, seed: int) -> None:
    """As `run`, but the blocks take turns and every scan is printed, with the figures of all so far."""
    begun = [_scans(index, seed, 60) for index in range(len(BLOCKS))]
    rows: list[np.ndarray] = []
    for number in range(scans):
        index = number % len(BLOCKS)
        rows.append(next(begun[index]))
        error, expanded, points, _ = rows[-1]
        kind, height = BLOCKS[index]
        print(
            f"{kind} {height:g}: error {1000 * error:+.1f} um, U {1000 * expanded:.1f} um, points {100 * points:.1f} %"
        )
        print(Coverage(*np.array(rows).T), flush=True)


def _block(index: int, scans: int, seed: int, frames: int) -> np.ndarray:
    """Errors, U, shares of points and independent errors (4, scans) of scans of one block."""
    return np.array(list(islice(_scans(index, seed, frames), scans))).reshape(-1, 4).T


def _scans(index: int, seed: int, frames: int) -> Iterator[np.ndarray]:
    """Error, U, share of points and independent error (4,) of one scan of the block after another."""
    kind, height = BLOCKS[index]
    exact = ExactScan.of(Scenario(object=kind, height_mm=height, seed=seed + index, scale=0.5, frames=frames))
    rig, lines = exact.rig, FanLines.settled_as(exact.fan_line)
    rng = np.random.default_rng([seed, index])
    steps = _calibration_steps()
    features = exact.measured(seed=int(rng.integers(2**31)))
    first = reconstruct(features, rig.camera, rig.fan, fan_lines=lines)
    displaced = [Deviation(source, *_off(rig.camera, rig.fan, step)) for source, step in steps]
    template = solve_common(first, rig.camera, rig.fan, displaced)
    while True:
        draw = sum((rng.normal() * step for _, step in steps), np.zeros(19))
        camera, fan = _off(rig.camera, rig.fan, draw)
        features = exact.measured(seed=int(rng.integers(2**31)))
        scan = reconstruct(features, camera, fan, fan_lines=lines)
        common = _about(template, first, scan, camera, fan)
        cloud = replace(scan.cloud, sigma_common=common.sigma(scan.cloud))
        fit = fit_gauge(cloud, errors=PointErrors.of_scan(features, scan.covariance, common, scan.speckle))
        yield np.array(
            [
                fit.thickness_mm - height,
                2 * combined(fit.budget),
                _points_within(exact, height, cloud),
                fit.robust.thickness - height,
            ]
        )


@cache
def _calibration_steps() -> tuple[tuple[Source, np.ndarray], ...]:
    """One-σ steps (19,) of camera and fan, and whose they are, from calibrations of the paper's numbers of pictures."""
    camera = calibrate_camera(camera_views.synthetic_views(5, noise_px=0.02), camera_views.TRUTH.image_size)
    poses = fan_scenes.features(fan_scenes.poses(9, 2), fan_scenes.Noise(), 2)
    fan = fit_fan(poses, camera.camera, FanOptions(3, fan_scenes.ALPHA))
    here = _vector(camera.camera, fan.fan)
    return tuple((one.source, _vector(one.camera, one.fan) - here) for one in calibration_deviations(camera, fan))


def _vector(camera: Camera, fan: Fan) -> np.ndarray:
    return np.concatenate([parameters_of(camera), fan.pis.ravel()])


def _off(camera: Camera, fan: Fan, step: np.ndarray) -> tuple[Camera, Fan]:
    return camera_of(parameters_of(camera) + step[:10], camera.image_size), moved_fan(fan, step[10:])


def _about(template: CommonErrors, first: ScanResult, scan: ScanResult, camera: Camera, fan: Fan) -> CommonErrors:
    """The changes of `template`, solved with the scan `first`, about another scan of the same geometry."""
    place = np.searchsorted(first.sweep_frames, scan.sweep_frames)
    base = CommonErrors(
        template.image_size, template.sources, template.cameras, template.fans, template.sweeps[:, place]
    )
    return replace(
        base,
        cameras=base.cameras - base.cameras[0] + parameters_of(camera),
        fans=base.fans - base.fans[0] + fan.pis,
        sweeps=base.sweeps - base.sweeps[0] + scan.pis,
    )


def _points_within(exact: ExactScan, height: float, cloud) -> float:
    """Share of the points on table and upper face whose depth is within 2σ of what their pixel truly sees."""
    table = exact.scene.pose_cam_table
    assert table is not None
    up, foot = table.rotation[:, 2], table.translation
    rays = exact.rig.camera.rays(cloud.uv)
    true = np.array([(foot + level * up) @ up / (rays @ up) for level in (0.0, height)])
    errors = cloud.points[:, 2] - true
    nearest = np.abs(errors).argmin(axis=0)
    error = errors[nearest, np.arange(len(cloud))]
    within = np.abs(error) <= 2 * np.hypot(cloud.sigma, cloud.sigma_common)
    return float(np.mean(within[np.abs(error) < ON_FACE_MM]))


if __name__ == "__main__":
    told(int(sys.argv[1]), int(sys.argv[2]))
