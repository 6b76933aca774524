"""Synthetic scans of a ball, a lying cylinder and a wedge on a table, with a real scan's errors and known truth.

Every stripe is one sweep: its points share the error of its light plane, drawn from a known covariance, part of which
all sweeps have in common; the noise along a stripe is the same over a few points.
"""

from dataclasses import dataclass, field

import numpy as np

from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import CENTRE, FOCAL

TABLE_MM = 545.0
BALL, BALL_RADIUS = np.array([25.0, -20.0, TABLE_MM - 20.0]), 20.0
PIN, PIN_RADIUS = np.array([-25.0, 10.0, TABLE_MM - 15.0]), 15.0
PIN_AXIS = np.array([np.sin(0.3), np.cos(0.3), 0.0])
STRETCH = 5


def _ball(rays):
    half = rays @ BALL
    square = (rays**2).sum(axis=1)
    under = half**2 - square * (BALL @ BALL - BALL_RADIUS**2)
    return np.where(under > 0, (half - np.sqrt(np.maximum(under, 0))) / square, np.inf)


def _pin(rays):
    across, to = rays - np.outer(rays @ PIN_AXIS, PIN_AXIS), PIN - PIN_AXIS * (PIN_AXIS @ PIN)
    a, b, c = (across**2).sum(axis=1), across @ to, to @ to - PIN_RADIUS**2
    under = b**2 - a * c
    depth = np.where(under > 0, (b - np.sqrt(np.maximum(under, 0))) / a, np.inf)
    met = np.isfinite(depth)
    along = (rays[met] * depth[met, None] - PIN) @ PIN_AXIS
    depth[met] = np.where(np.abs(along) < 25.0, depth[met], np.inf)
    return depth


@dataclass
class ShapeScan:
    """True depths of all pixels; `measure` gives a cloud with errors. `on` says what each point lies on."""

    spacing_px: float = 9.0
    seed: int = 0
    points: np.ndarray = field(init=False)

    def __post_init__(self):
        u, v = np.meshgrid(np.arange(720.0, 1200.0, self.spacing_px), np.arange(520.0, 860.0, 2.0))
        self.uv = np.column_stack([u.T.ravel(), v.T.ravel()])
        self.sweep = np.repeat(np.arange(u.shape[1]), u.shape[0])
        rays = np.column_stack([(self.uv - CENTRE) / FOCAL, np.ones(len(self.uv))])
        depths = np.column_stack([_ball(rays), _pin(rays), np.full(len(rays), TABLE_MM)])
        on, depth = depths.argmin(axis=1), depths.min(axis=1)
        points = rays * depth[:, None]
        outward = np.where((on == 0)[:, None], points - BALL, [0.0, 0.0, -1.0])
        away = points - PIN
        outward = np.where((on == 1)[:, None], away - np.outer(away @ PIN_AXIS, PIN_AXIS), outward)
        outward /= np.linalg.norm(outward, axis=1)[:, None]
        seen = -(outward * rays).sum(axis=1) > 0.35
        self.uv, self.sweep, self.points, self.on = self.uv[seen], self.sweep[seen], points[seen], on[seen]
        self.normals = outward[seen]
        count = u.shape[1]
        rng = np.random.default_rng(self.seed)
        own = np.kron(np.eye(count), np.diag([2e-7, 2e-7, 4e-8]))
        self.factor = np.hstack([own, 4e-8 * np.tile(rng.normal(size=(3, 3)), (count, 1))])

    @property
    def errors(self):
        return PointErrors(self.factor @ self.factor.T, correlation_px=2.0 * STRETCH)

    def measure(self, rng, *, noise=0.02, outliers=0.0):
        depth = self.points[:, 2].copy()
        rays = self.points / depth[:, None]
        shifts = (self.factor @ rng.normal(size=self.factor.shape[1])).reshape(-1, 3)
        blocks = (self.factor @ self.factor.T).reshape(len(shifts), 3, len(shifts), 3)
        diagonal = blocks[np.arange(len(shifts)), :, np.arange(len(shifts)), :][self.sweep]
        variance = noise**2 + depth**4 * np.einsum("ni,nij,nj->n", rays, diagonal, rays)
        white = rng.normal(size=len(depth) + STRETCH)
        own = noise * np.convolve(white, np.ones(STRETCH) / np.sqrt(STRETCH))[STRETCH - 1 :][: len(depth)]
        depth += own - depth**2 * (rays * shifts[self.sweep]).sum(axis=1)
        wrong = rng.random(len(depth)) < outliers
        depth[wrong] += rng.uniform(-5, 5, wrong.sum())
        count = len(depth)
        return Cloud(
            rays * depth[:, None],
            self.uv,
            np.sqrt(variance),
            np.ones(count),
            self.sweep,
            self.sweep,
            self.normals,
        )
