"""Known planes computed on paper: boards in a synthetic scan, with the sweeps' light on them, no pictures."""

from dataclasses import dataclass, field, replace

import numpy as np

from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.model import Fan, LightPlane
from core.scan.features.crossings import CrossingTable
from core.scan.features.extraction import FrameFeatures, ScanFeatures
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.known_planes.points_on_planes import points_on_planes
from core.scan.network.geometry import CrossingRays
from tests.scan.synthetic import CAMERA, FAN, network, sweeps, tangent

NO_FAN = Fan(())
CORNER = (LightPlane.from_normal([0.05, 0.64, 0.77], 420.0), LightPlane.from_normal([0.05, -0.64, 0.77], 420.0))
"""Two boards at an angle, like a corner that opens towards the camera."""
PLACES = (((10.0, 10.0), (1900.0, 480.0)), ((10.0, 893.0), (1900.0, 1360.0)))
"""Where they are seen, from and to (u, v): above and below the block."""
STRIPE = StripeSettings(3.0, 100.0)


def board(plane: LightPlane, number: int, *, sd_mm=0.0, seed=None, place=None) -> KnownPlane:
    """A board known to `sd_mm` in its distance and, over 100 mm, in its tilts; with a `seed` it is off by that."""
    (left, top), (right, bottom) = place or PLACES[number]
    across = np.cross(plane.normal, [0.0, 1.0, 0.0])
    along = np.cross(plane.normal, across)
    factor = sd_mm / plane.d_mm * np.column_stack([plane.pi, across / 100, along / 100])
    pi = plane.pi
    if seed is not None:
        pi = pi + factor @ np.random.default_rng([seed, number, 5]).normal(size=3)
    outline = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
    none = np.zeros((3, 3))
    return KnownPlane(f"board {number}", pi, outline, factor @ factor.T, none, np.zeros((3, 10)))


@dataclass
class OnPaper:
    """A scan's crossings with points on boards among them, and the truth."""

    table: CrossingTable
    line: np.ndarray
    control: Control
    truth: np.ndarray
    features: ScanFeatures
    geometry: CrossingRays = field(init=False)

    def __post_init__(self):
        self.geometry = CrossingRays.of(self.table, CAMERA)


def scan_on_paper(
    seed, planes=CORNER, *, count=30, noise_px=0.1, sd_mm=0.0, with_fan=False, boards=None, crossing_px=0.05
):
    """Sweeps over block and table and over boards, whose light has `noise_px` at every pixel by itself."""
    sheets = sweeps(count, seed)
    boards = boards or [board(plane, k, sd_mm=sd_mm, seed=seed) for k, plane in enumerate(planes)]
    scan = network(sheets, crossing_px, seed, fan_noise_px=0.6 * crossing_px)
    keep = np.ones(len(scan.table), dtype=bool) if with_fan else ~scan.table.with_fan
    rng = np.random.default_rng([seed, 77])
    frames = tuple(
        FrameFeatures(index, f"frame{index:04d}", light_on(pi, planes, boards, noise_px, rng))
        for index, pi in enumerate(sheets)
    )
    crossings = replace(scan.table.select(keep), half_length_px=40.0)
    features = ScanFeatures(CAMERA.image_size, (), frames, crossings, STRIPE, STRIPE)
    rows, number = points_on_planes(features, boards, CAMERA)
    fan = FAN if with_fan else NO_FAN
    line = np.concatenate([np.where(scan.table.with_fan, scan.line, -1)[keep], fan.lines + number])
    return OnPaper(crossings.followed_by(rows), line, Control(fan, tuple(boards)), sheets, features)


def light_on(pi, planes, boards, noise_px, rng):
    """Centrelines of the sweep `pi` on `planes` where the `boards` are seen."""
    pieces = []
    for plane, known in zip(planes, boards, strict=True):
        low, high = known.outline.min(axis=0), known.outline.max(axis=0)
        v = np.arange(max(low[1], 0.0), min(high[1], 1373.0))
        uv = _seen(pi, plane, v)
        uv = uv[(uv[:, 0] > max(low[0], 0.0)) & (uv[:, 0] < min(high[0], 1919.0))]
        if len(uv) < 3:
            continue
        t = tangent(pi, plane, CAMERA.rays(uv[len(uv) // 2][None])[0])
        t = t * np.sign(t @ (uv[-1] - uv[0]))
        normal = np.tile([t[1], -t[0]], (len(uv), 1))
        count = len(uv)
        pieces.append(
            Centreline(
                uv + rng.normal(0, noise_px, count)[:, None] * normal,
                normal,
                np.full(count, 1.5),
                np.full(count, 100.0),
                np.full(count, max(noise_px, 1e-6)),
                np.zeros(count, dtype=bool),
                float(np.linalg.norm(uv[-1] - uv[0])) / (count - 1),  # each point's noise is its own
            )
        )
    return tuple(pieces)


def _seen(pi, plane, v):
    """The pixels (N, 2) of the stripe of sweep `pi` on `plane` in picture rows `v` (N,)."""
    u = np.full(len(v), 960.0)
    d = pi - plane.pi
    for _ in range(4):
        y = CAMERA.rays(np.column_stack([u, v]))[:, 1]
        x = -(d[1] * y + d[2]) / d[0]
        u = np.clip(CAMERA.pixels(np.column_stack([x, y]))[:, 0], -500, 2500)
    return np.column_stack([u, v])
