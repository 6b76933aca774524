"""Crossings computed on paper: planes, a table with a block on it, no pictures."""

from dataclasses import dataclass

import numpy as np

from core.model import Fan, LightPlane
from core.scan.features.crossings import CrossingTable
from core.scan.network.geometry import CrossingRays
from tests import paper

CAMERA = paper.HALF
FAN = Fan(tuple(LightPlane(pi) for pi in paper.PLANES))
TABLE = LightPlane.from_normal([0.02, 0.05, 0.99856], 560.0)
BLOCK = {"x": (-35.0, 35.0), "y": (25.0, 85.0)}
HEIGHT_MM = 50.0


def sweeps(count: int, seed: int) -> np.ndarray:
    """(count, 3) light planes through an emitter beside the camera, stripes mostly across the fan."""
    rng = np.random.default_rng(seed)
    planes = []
    for index in range(count):
        side = 1 if index % 2 else -1
        emitter = np.array([side * rng.uniform(180, 300), rng.uniform(-80, 80), rng.uniform(0, 120)])
        aim = np.array([rng.uniform(-60, 60), rng.uniform(20, 90), 530.0])
        tilt = rng.uniform(-0.6, 0.6)
        along = np.array([np.sin(tilt), np.cos(tilt), 0.0])
        normal = np.cross(aim - emitter, along)
        planes.append(normal / (normal @ emitter))
    return np.array(planes)


@dataclass
class Network:
    table: CrossingTable
    geometry: CrossingRays
    line: np.ndarray


def network(
    planes: np.ndarray, noise_px: float, seed: int, *, fan_noise_px: float = 0.0, relief: bool = True
) -> Network:
    """All crossings of `planes` with the fan and each other on the table and on the block's upper face."""
    rng = np.random.default_rng(seed)
    faces = [TABLE, LightPlane.from_normal(TABLE.normal, TABLE.d_mm - HEIGHT_MM)] if relief else [TABLE]
    window = 40.0
    offsets: dict[tuple[int, int, int], float] = {}
    rows = []
    pairs = [(a, -1, k) for a in range(len(planes)) for k in range(FAN.lines)]
    pairs += [(a, b, -1) for a in range(len(planes)) for b in range(a + 1, len(planes))]
    for a, b, line in pairs:
        other = FAN.planes[line].pi if b < 0 else planes[b]
        for face_index, face in enumerate(faces):
            ray = np.cross(planes[a] - face.pi, other - face.pi)
            ray = ray / ray[2]
            point = ray / (face.pi @ ray)
            on_block = all(BLOCK[axis][0] < value < BLOCK[axis][1] for axis, value in zip("xy", point, strict=False))
            uv = CAMERA.project(point[None])[0]
            inside = 0 < uv[0] < 1919 and 0 < uv[1] < 1373
            if not inside or on_block != (face_index == 1 and relief):
                continue
            t_a, t_b = tangent(planes[a], face, ray), tangent(other, face, ray)
            sine = t_a[0] * t_b[1] - t_a[1] * t_b[0]
            if abs(sine) < np.sin(np.deg2rad(15)):
                continue
            error_a = rng.normal(0, noise_px)
            key = None
            if b < 0:
                key = (line, face_index, int(uv[0] // (2 * window)))
                error_b = offsets.setdefault(key, rng.normal(0, fan_noise_px))
            else:
                error_b = rng.normal(0, noise_px)
            uv = uv + t_b * error_a / -sine + t_a * error_b / sine
            rows.append((uv, t_a, t_b, a, b, line, face_index, key))
    cell = np.array([row[-1][2] if row[-1] else 0 for row in rows])
    count = len(rows)
    uv, t_a, t_b, sweep, other_sweep, lines, on_face = (np.array([row[i] for row in rows]) for i in range(7))
    apart = 1000.0 * np.arange(count, dtype=np.float64)  # every error of a sweep is drawn on its own
    fan_sigma = max(fan_noise_px, 1e-3)
    table = CrossingTable(
        uv=uv,
        tangent_a=t_a,
        tangent_b=t_b,
        sigma_a=np.full(count, max(noise_px, 1e-3)),
        sigma_b=np.where(other_sweep < 0, fan_sigma, max(noise_px, 1e-3)),
        a=sweep,
        b=other_sweep,
        piece_a=on_face,
        piece_b=np.where(other_sweep < 0, lines * 2 + on_face, on_face),
        along_a=apart,
        along_b=np.where(other_sweep < 0, 2 * window * cell, apart),
        half_length_px=2 * window,
        cell_a=np.zeros(count, dtype=np.int64),
        cell_b=cell,
        share_a=np.zeros((count, 1)),
        share_b=np.where(other_sweep < 0, fan_sigma, 0.0)[:, None],  # one error for a whole stretch of the fan
    )
    return Network(table, CrossingRays.of(table, CAMERA), lines)


def stripe_rays(pi: np.ndarray) -> np.ndarray:
    """Rays (N, 3) at which the stripe of plane `pi` is seen on the table and on the block."""
    rays = []
    for on_top, face in ((False, TABLE), (True, LightPlane.from_normal(TABLE.normal, TABLE.d_mm - HEIGHT_MM))):
        v = np.arange(100.0, 1300.0, 25.0)
        y = CAMERA.rays(np.column_stack([np.full(len(v), 960.0), v]))[:, 1]
        difference = pi - face.pi
        x = -(difference[1] * y + difference[2]) / difference[0]
        ray = np.column_stack([x, y, np.ones(len(y))])
        points = face.points(ray)
        seen = np.all((CAMERA.project(points) > 0) & (CAMERA.project(points) < [1919, 1373]), axis=1)
        on_block = np.all(
            [(BLOCK[a][0] < points[:, i]) & (points[:, i] < BLOCK[a][1]) for i, a in enumerate("xy")], axis=0
        )
        rays.append(ray[seen & (on_block == on_top)])
    return np.concatenate(rays)


def tangent(pi: np.ndarray, face: LightPlane, ray: np.ndarray) -> np.ndarray:
    """Unit tangent in the picture of plane `pi` on `face` at `ray`."""
    direction = np.cross(pi, face.pi)
    point = ray / (face.pi @ ray)
    step = np.subtract(*CAMERA.project(point + np.outer([1, -1], direction / np.linalg.norm(direction))))
    return step / np.linalg.norm(step)
