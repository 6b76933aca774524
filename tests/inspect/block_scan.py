"""Synthetic scans of a block on a tilted table, with a real scan's errors: noise along stripes, wrong sweep planes.

Everything is analytic: the true light plane of each sweep meets the faces in straight lines, points are taken along
these lines, and each depth is measured again on the same ray with a displaced light plane.
"""

from dataclasses import dataclass, field

import numpy as np

from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.common_errors import CommonErrors
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.surface.cloud import FAN, Cloud
from tests.scan_facts import NOTHING_WRONG

FOCAL = 2495.0
CENTRE = np.array([960.0, 687.0])
NORMAL = np.array([0.05, 0.25, 1.0]) / np.linalg.norm([0.05, 0.25, 1.0])
TABLE_MM = 540.0
FAN_SOURCE = np.array([-200.0, 40.0, 60.0])
LASER = np.array([260.0, -60.0, 80.0])
HALF = 30.0
SPACING = 0.45
"""Distance in mm between two points along a stripe: about 2 px."""


def axes():
    """Two unit vectors in the table's plane."""
    u = np.cross(NORMAL, [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    return np.array([u, np.cross(NORMAL, u)])


def pixels(points):
    return points[:, :2] / points[:, 2:] * FOCAL + CENTRE


def cloud_at(points, sigma=0.02):
    """A cloud of points (N, 3) without normals, as if all were of one sweep."""
    count = len(points)
    zero = np.zeros(count, dtype=int)
    return Cloud(points, pixels(points), np.full(count, sigma), np.ones(count), zero, zero, np.zeros((count, 3)))


def square(distance, half):
    """Pixel corners of a square of half side `half` mm about the block's centre, on the plane at `distance`."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    return pixels(distance * NORMAL + corners @ axes())


@dataclass
class BlockScan:
    """True points, labels and light planes of one scan; `measure` gives clouds with errors."""

    height: float = 40.0
    sweeps: int = 40
    reach: float = 75.0
    seed: int = 0
    points: np.ndarray = field(init=False)
    upper: np.ndarray = field(init=False)
    sweep: np.ndarray = field(init=False)
    factor: np.ndarray = field(init=False)
    pis: np.ndarray = field(init=False)
    fan_pis: np.ndarray = field(init=False)

    def __post_init__(self):
        rng = np.random.default_rng(self.seed)
        parts = [self._stripe(LASER, index, *self._ends(rng)) for index in range(self.sweeps)]
        source = FAN_SOURCE
        for k, at in enumerate((-22.0, 3.0, 25.0)):
            ends = TABLE_MM * NORMAL + np.array([[at, -self.reach], [at, self.reach]]) @ axes()
            parts.append(self._stripe(source, FAN - k, *ends))
        self.pis = np.array([part[3] for part in parts[: self.sweeps]])
        self.fan_pis = np.array([part[3] for part in parts[self.sweeps :]])
        self.points = np.vstack([part[0] for part in parts])
        self.upper = np.concatenate([part[1] for part in parts])
        self.sweep = np.concatenate([part[2] for part in parts])
        self.factor = self._plane_error_factor(rng)

    @property
    def covariance(self):
        """(3S, 3S) of the sweeps' π."""
        return self.factor @ self.factor.T

    def errors(self, stretch_px=13.0, *, plane_errors=True, common=None):
        """All that makes its points wrong; camera and fan are exact where nothing else is said."""
        covariance = self.covariance if plane_errors else np.zeros_like(self.covariance)
        common = self.common_errors(camera=1.0, fan=1.0) if common is None else common
        empty = np.zeros(0, dtype=np.int64)
        speckle = FanSpeckle(np.zeros((0, 2)), empty, empty, empty, np.zeros((0, 1)), np.zeros((len(covariance), 0)))
        return PointErrors(covariance, common, stretch_px, stretch_px, speckle, facts=NOTHING_WRONG)

    def common_errors(self, **scales):
        """Calibrations that are one standard uncertainty off once they have scaled all of space by that much."""
        camera = [FOCAL, FOCAL, 0.0, *CENTRE, 0.0, 0.0, 0.0, 0.0, 0.0]
        return CommonErrors(
            (1920, 1374),
            tuple(scales),
            [camera] * (1 + len(scales)),
            [self.fan_pis / scale for scale in (1.0, *scales.values())],
            [self.pis / scale for scale in (1.0, *scales.values())],
        )

    @property
    def polygons(self):
        """Upper and lower polygon in pixels; the lower one is a frame-shaped region given as an outer square."""
        return square(TABLE_MM - self.height, HALF + 3), square(TABLE_MM, self.reach)

    def measure(self, rng, *, noise=0.015, stretch=6, plane_errors=True, outliers=0.0, shift=None):
        """A cloud measured with errors; `stretch` points along a stripe share their noise."""
        depth = self.points[:, 2].copy()
        rays = self.points / depth[:, None]
        swept = self.sweep >= 0
        variance = np.full(len(depth), noise**2)
        if plane_errors:
            shifts = (self.factor @ rng.normal(size=self.factor.shape[1])).reshape(-1, 3)
            covariance = self.covariance
            blocks = [covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(self.sweeps)]
            of = self.sweep[swept]
            depth[swept] -= depth[swept] ** 2 * (rays[swept] * shifts[of]).sum(axis=1)
            own = np.einsum("ni,nij,nj->n", rays[swept], np.array(blocks)[of], rays[swept])
            variance[swept] += self.points[swept, 2] ** 4 * own
        white = rng.normal(size=len(depth) + stretch)
        depth += noise * np.convolve(white, np.ones(stretch) / np.sqrt(stretch))[stretch - 1 :][: len(depth)]
        wrong = rng.random(len(depth)) < outliers
        depth[wrong] += rng.uniform(-6, 6, wrong.sum())
        if shift is not None:
            depth += shift
        points = rays * depth[:, None]
        count = len(points)
        return Cloud(
            points,
            pixels(self.points),
            np.sqrt(variance),
            np.full(count, 90.0),
            np.where(swept, self.sweep, -1),
            self.sweep,
            np.zeros((count, 3)),
        )

    def _ends(self, rng):
        """Two points on the table that a sweep's stripe runs through."""
        at, lean = rng.uniform(-self.reach, self.reach), rng.uniform(-0.6, 0.6)
        flat = np.array([[at - lean * self.reach, -self.reach], [at + lean * self.reach, self.reach]])
        return TABLE_MM * NORMAL + flat @ axes()

    def _stripe(self, source, index, a, b):
        """Points of one light sheet on the table and on the block, which are on the block, their sweep, and its π."""
        pi = np.linalg.solve(np.array([source, a, b]), np.ones(3))
        found = []
        for distance, on_block in ((TABLE_MM, False), (TABLE_MM - self.height, True)):
            direction = np.cross(pi, NORMAL)
            direction /= np.linalg.norm(direction)
            foot = np.linalg.solve(np.array([pi, NORMAL, direction]), [1.0, distance, 0.0])
            points = foot + np.arange(-150, 150, SPACING)[:, None] * direction
            flat = (points - distance * NORMAL) @ axes().T
            over = np.abs(flat).max(axis=1) < HALF
            # The block hides the table behind it from camera and laser: leave out a band around its foot.
            beside = (np.abs(flat).max(axis=1) > HALF + 6) & (np.abs(flat).max(axis=1) < self.reach)
            found.append((points[over if on_block else beside], on_block))
        points = np.vstack([part for part, _ in found])
        upper = np.repeat([on for _, on in found], [len(part) for part, _ in found])
        return points, upper, np.full(len(points), index), pi

    def _plane_error_factor(self, rng):
        """δπ = factor @ ξ: errors of each sweep's own, and a few that all sweeps share."""
        scale = 1.2e-7
        own = np.zeros((3 * self.sweeps, 3 * self.sweeps))
        for i in range(self.sweeps):
            # Ill-conditioned as on a flat block: one direction of π is worse known by far.
            direction = rng.normal(size=(3, 3)) * np.array([1.0, 0.6, 0.3])
            own[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = scale * direction * np.array([3.0, 3.0, 1.0])[:, None]
        shared = 0.3 * scale * np.tile(rng.normal(size=(3, 4)), (self.sweeps, 1))
        return np.hstack([own, shared])
