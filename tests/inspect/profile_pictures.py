"""Light profiles of a block on a table, as centrelines with noise of a known size, without rendering."""

from collections.abc import Sequence

import numpy as np

from core.calibrate.deviations import FANS, Deviation
from core.image.stripes.centreline import Centreline
from core.inspect.uncertainty.point_errors import PointErrors
from core.model import Camera, Fan
from core.model.arrays import Array
from core.scan.common_errors import CommonErrors
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.triangulate import join, triangulate
from core.simulate.rig import paper_rig
from tests.scan_facts import NOTHING_WRONG

RIG = paper_rig(0.25)
NORMAL = np.array([0.03, 0.05, 1.0]) / np.linalg.norm([0.03, 0.05, 1.0])
"""Of table and block, away from the camera."""
TABLE = 560.0
CORRELATION_PX = 8.0


def fan_of(lines: Sequence[int]) -> Fan:
    return Fan(tuple(RIG.fan.planes[line] for line in lines))


def picture(
    heights: Sequence[tuple[float, float, float]],
    *,
    fan: Fan = RIG.fan,
    camera: Camera = RIG.camera,
    noise_px: float = 0.0,
    seed: int = 0,
    frame: int = 0,
) -> Cloud:
    """The fan's points on a part of (from x, to x, height over the table) in mm, noise alike over CORRELATION_PX."""
    rng = np.random.default_rng(seed)
    clouds = []
    for line, plane in enumerate(fan.planes):
        for first, last, height in heights:
            x = np.arange(first, last, 0.45)  # a pixel apart
            # Where the light plane meets the plane of this height, at x: n·X = d, π·X = 1.
            matrix = np.array([NORMAL[1:], plane.pi[1:]])
            rest = np.linalg.solve(matrix, np.array([TABLE - height - NORMAL[0] * x, 1 - plane.pi[0] * x]))
            clouds.append(
                triangulate(
                    _noisy(camera.project(np.column_stack([x, *rest])), noise_px, rng),
                    plane.pi, np.zeros((3, 3)), camera, frame, FAN - line,
                )
            )  # fmt: skip
    return join(clouds)


def errors(fan: Fan = RIG.fan, camera: Camera = RIG.camera) -> PointErrors:
    """Of these points: noise alone, no calibration is wrong."""
    known = tuple(Deviation(source, camera, fan) for source in ("camera", FANS[0]))  # each known for sure
    common = CommonErrors.of_fan(camera, fan, known)
    return PointErrors(common=common, speckle_px=CORRELATION_PX, swept=False, facts=NOTHING_WRONG)


def _noisy(uv: Array, noise_px: float, rng: np.random.Generator) -> Centreline:
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(uv, axis=0), axis=1))])
    cell = (arc / CORRELATION_PX).astype(int)
    off = noise_px * rng.normal(size=cell.max() + 1)[cell]
    count = len(uv)
    sigma = np.full(count, max(noise_px, 1e-3))
    ones = np.ones(count)
    return Centreline(
        uv + off[:, None] * normal, normal, 1.5 * ones, 100 * ones, sigma, np.zeros(count, bool), CORRELATION_PX
    )
