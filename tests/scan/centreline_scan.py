"""Whole scans without pictures: exact curves of light on a scenario's objects, with noise as the extraction leaves it.

    exact = ExactScan.of(Scenario(scale=0.5, frames=60))     # once: geometry, about a second
    scan = exact.measured(seed=1)                            # many times: fresh noise, crossings, smoothing
    result = reconstruct(scan, exact.rig.camera, exact.rig.fan)

Every sheet of light is followed ray by ray from its emitter to the first surface it meets, so shadows are right; what
the camera does not see is left out, stripes are cut where they leave a face, and 4 px at their ends. The noise across a
stripe is Gaussian, of stated σ and correlated along it as a filter along the stripe leaves it; the fan's is drawn once
for a scan, each sweep's anew. What pictures add beyond that (light fading across a bent face, neighbours, saturation)
is not in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d, map_coordinates, minimum_filter

from core.image.stripes.centreline import Centreline
from core.image.stripes.runs import END_TRIM_PX
from core.image.stripes.stripe import StripeSettings
from core.model import Pose
from core.scan.features.crossings import CrossingTable, CrossingWindow
from core.scan.features.extraction import FrameFeatures, ScanFeatures, gather
from core.scan.features.reference import FeatureOptions
from core.scan.network.line_errors import LineErrors
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.locate import numbered
from core.simulate.recording import scenario_rig
from core.simulate.rig import Rig
from core.simulate.scenario import Scenario
from core.simulate.scene.image import generator
from core.simulate.scene.laser import Sheet, fan_sheets
from core.simulate.scene.scene import Scene, surface_maps
from core.simulate.scene.stage import WORK_POINT, aim_of, build_scene
from core.simulate.sweep import hand_sweeps, sweep_range

RAYS_PER_PX = 1.6
WIDEST = 1.0
"""Half the opening of a sheet in rad."""
SHORTEST_PX = 20.0
LEAST_COSINE = 0.12
"""Light that grazes a face more than this is too faint to be found."""


@dataclass(frozen=True)
class Noise:
    """σ in px across the stripe of one point, of the sweeps and of the fan, and the length along it that shares one."""

    sweep_px: float
    fan_px: float
    correlation_px: float

    @classmethod
    def of_twin(cls, scale: float) -> Noise:
        """About what the extraction leaves on rendered pictures with speckle of contrast 0.18."""
        sigma = 0.083 + 0.104 * (scale - 0.5)
        return cls(sigma, sigma, 7.2 + 9.6 * (scale - 0.5))


@dataclass(frozen=True)
class Curve:
    """Exact light on one face in one picture: pixels (N, 2) a px apart, their normals and the points (N, 3) in mm.

    `width` in px and `strength` in grey levels, of all points or (N,), are only handed on.
    """

    uv: np.ndarray
    normal: np.ndarray
    points: np.ndarray
    face: int
    width: float | np.ndarray = 1.5
    strength: float | np.ndarray = 100.0

    def measured(self, sigma_px: float, correlation_px: float, rng: np.random.Generator) -> Centreline:
        """The curve with noise across itself."""
        count = len(self.uv)
        filter_px = correlation_px / (2 * np.sqrt(np.pi))
        pad = int(np.ceil(5 * filter_px))
        noise = gaussian_filter1d(rng.normal(size=count + 2 * pad), filter_px)[pad : pad + count]
        noise *= sigma_px * np.sqrt(correlation_px)  # a Gaussian filter over white noise leaves 1/√correlation_px
        return Centreline(
            self.uv + noise[:, None] * self.normal,
            self.normal,
            np.broadcast_to(self.width, count),
            np.broadcast_to(self.strength, count),
            np.full(count, max(sigma_px, 1e-9)),
            np.zeros(count, dtype=bool),
            correlation_px,
        )


@dataclass(frozen=True)
class ExactScan:
    """The light of a whole scan as it truly lies: `fan` curves with their line, `sweeps` curves frame by frame."""

    rig: Rig
    scene: Scene
    sheets: tuple[Sheet, ...]
    fan: tuple[Curve, ...]
    fan_line: tuple[int, ...]
    sweeps: tuple[tuple[Curve, ...], ...]
    figures: dict = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        *,
        moved: tuple[int, tuple[float, float, float]] | None = None,
        rig: Rig | None = None,
        sheets: tuple[Sheet, ...] | None = None,
    ) -> ExactScan:
        """The scan that `core.simulate` would render; `moved` shifts the object by so many mm from that frame on."""
        rig = rig or scenario_rig(scenario)
        stage_scene, figures, shots = _scene(scenario, rig)
        shots = shots if sheets is None else list(sheets)
        scenes = [stage_scene] * len(shots)
        if moved is not None:
            later = shifted(stage_scene, moved[1])
            scenes[moved[0] :] = [later] * (len(shots) - moved[0])
        return replace(cls.seen(rig, stage_scene, shots, scenes), figures=figures)

    @classmethod
    def seen(
        cls,
        rig: Rig,
        scene: Scene,
        sheets: Sequence[Sheet],
        scenes: Sequence[Scene] | None = None,
        aim: np.ndarray = WORK_POINT,
    ) -> ExactScan:
        """The scan of a scene by `sheets`, each in its own of the `scenes` if there are any; the fan lights `aim`."""
        scenes = [scene] * len(sheets) if scenes is None else scenes
        eyes = {id(one): _Eye(rig, one) for one in {id(one): one for one in [scene, *scenes]}.values()}
        fan = [eyes[id(scene)].curves(sheet) for sheet in fan_sheets(rig, aim)]
        return cls(
            rig,
            scene,
            tuple(sheets),
            tuple(curve for curves in fan for curve in curves),
            tuple(line for line, curves in enumerate(fan) for _ in curves),
            tuple(eyes[id(one)].curves(sheet) for one, sheet in zip(scenes, sheets, strict=True)),
        )

    @property
    def pis(self) -> np.ndarray:
        """True light planes (S, 3) of the sweeps."""
        return np.array([sheet.plane.pi for sheet in self.sheets])

    def measured(
        self, seed: int, noise: Noise | None = None, *, window: CrossingWindow | None = None, smoothed: bool = True
    ) -> ScanFeatures:
        """The scan's features with noise of this seed; `smoothed` as `core.scan.features.extraction` leaves them."""
        noise = noise or Noise.of_twin(self.rig.scale)
        rng = np.random.default_rng([seed, 2023])
        fan = tuple(curve.measured(noise.fan_px, noise.correlation_px, rng) for curve in self.fan)
        frames = [
            FrameFeatures(
                index,
                f"frame{index:04d}",
                tuple(curve.measured(noise.sweep_px, noise.correlation_px, rng) for curve in curves),
            )
            for index, curves in enumerate(self.sweeps)
        ]
        stripe = StripeSettings(width_px=3.5, contrast=100.0)
        camera = self.rig.camera
        options = FeatureOptions(window=window or CrossingWindow(), camera=camera)
        return gather(camera.image_size, fan, frames, (stripe, stripe), options, smoothed=smoothed)


@dataclass(frozen=True)
class ExactCrossings:
    """The crossings of a scan as they truly are, to be given errors as their table says: hundreds of scans a minute.

    `table` is exact; its σ and how errors hang together along lines are those of `noise`. `line` (M,) is the fan's.
    """

    scan: ExactScan
    table: CrossingTable
    line: np.ndarray

    @classmethod
    def of(cls, scan: ExactScan, noise: Noise | None = None) -> ExactCrossings:
        noise = noise or Noise.of_twin(scan.rig.scale)
        tiny = 1e-5
        features = scan.measured(
            0, Noise(tiny * noise.sweep_px, tiny * noise.fan_px, noise.correlation_px), smoothed=False
        )
        table, line = numbered(features.crossings, FanLines.settled_as(scan.fan_line))
        scaled = {name: getattr(table, name) / tiny for name in ("sigma_a", "sigma_b", "share_a", "share_b")}
        return cls(scan, replace(table, **scaled), line)

    def drawn(self, seed: int) -> CrossingTable:
        """The crossings with errors of this seed."""
        return self.drawn_with(seed)[0]

    def drawn_with(self, seed: int) -> tuple[CrossingTable, np.ndarray, np.ndarray]:
        """The crossings with errors of this seed, and among them those of the cells of fan (F,) and sweeps (Q,)."""
        rng, table, errors = np.random.default_rng([seed, 4]), self.table, LineErrors.of(self.table)
        cells, fan = rng.normal(size=errors.sweep_a.shape[1]), rng.normal(size=errors.fan.shape[1])
        rest_a, rest_b = (np.sqrt(rest) * rng.normal(size=len(table)) for rest in (errors.rest_a, errors.rest_b))
        off_a, off_b = errors.sweep_a @ cells + rest_a, errors.sweep_b @ cells + errors.fan @ fan + rest_b
        t_a, t_b = table.tangent_a, table.tangent_b
        sine = t_a[:, 0] * t_b[:, 1] - t_a[:, 1] * t_b[:, 0]
        uv = table.uv + t_b * (off_a / -sine)[:, None] + t_a * (off_b / sine)[:, None]
        return replace(table, uv=uv), fan, cells


def _scene(scenario: Scenario, rig: Rig) -> tuple[Scene, dict, list[Sheet]]:
    scene, figures = build_scene(scenario)
    reach = sweep_range(scene, aim_of(scene))
    return scene, figures, hand_sweeps(rig, reach, scenario.frames, generator(scenario.seed, "sweeps"))


def shifted(scene: Scene, shift) -> Scene:
    """The scene with its objects, but not the table, moved."""
    motion = Pose(np.eye(3), shift)
    return replace(
        scene,
        meshes=tuple(mesh.moved(motion) for mesh in scene.meshes),
        spheres=tuple(sphere.moved(motion) for sphere in scene.spheres),
    )


class _Eye:
    """Follows sheets of light in one scene and sees them with the rig's camera."""

    def __init__(self, rig: Rig, scene: Scene) -> None:
        self._camera, self._scene = rig.camera, scene
        width, height = rig.camera.image_size
        corners = rig.camera.rays(np.array([[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]]))
        self._widest = 1.02 * np.linalg.norm(corners[:, :2], axis=1).max()
        self._small = rig.camera.scaled(960 / rig.camera.image_size[0])
        depth = surface_maps(scene, self._small).depth.astype(np.float64)
        self._nearest = minimum_filter(np.where(depth > 0, depth, np.inf), 3)
        self._faces = [_face_numbers(mesh) for mesh in scene.meshes]

    def curves(self, sheet: Sheet) -> tuple[Curve, ...]:
        """The light of one sheet, face by face."""
        angles = np.linspace(-WIDEST, WIDEST, int(2 * WIDEST * RAYS_PER_PX * self._camera.focal))
        frame = np.array([sheet.axis, np.cross(sheet.plane.normal, sheet.axis)])
        directions = np.column_stack([np.cos(angles), np.sin(angles)]) @ frame
        reach, face, cosine = self._first_hits(sheet, frame, angles, directions)
        reached = np.isfinite(reach)
        points = sheet.emitter + np.where(reached, reach, 1.0)[:, None] * directions
        uv = self._camera.project(points)
        width, height = self._camera.image_size
        inside = (uv > 0).all(axis=1) & (uv[:, 0] < width - 1) & (uv[:, 1] < height - 1)
        inside &= np.linalg.norm(points[:, :2], axis=1) < self._widest * points[:, 2]  # distortion folds what is beyond
        lit = np.flatnonzero(reached & inside & (cosine > LEAST_COSINE) & (points[:, 2] > 1.0))
        small = self._small.project(points[lit])
        lit = lit[map_coordinates(self._nearest, small.T[::-1], order=0, mode="nearest") > points[lit, 2] - 1.5]
        breaks = (np.diff(lit) > 1) | (np.diff(face[lit]) != 0) | (np.linalg.norm(np.diff(uv[lit], axis=0), axis=1) > 8)
        pieces = np.split(lit, np.flatnonzero(breaks) + 1)
        found = (self._curve(points[piece], int(face[piece[0]])) for piece in pieces if len(piece) > 1)
        return tuple(curve for curve in found if curve is not None)

    def _curve(self, points: np.ndarray, face: int) -> Curve | None:
        """Points on one face made a pixel apart, less what is left out at the ends."""
        steps = np.linalg.norm(np.diff(self._camera.project(points), axis=0), axis=1)
        arc = np.concatenate([[0.0], np.cumsum(steps)])
        at = np.arange(END_TRIM_PX, arc[-1] - END_TRIM_PX, 1.0)
        if len(at) < SHORTEST_PX:
            return None
        points = np.column_stack([np.interp(at, arc, points[:, k]) for k in range(3)])
        uv = self._camera.project(points)
        tangent = np.gradient(uv, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1)[:, None]
        return Curve(uv, np.column_stack([tangent[:, 1], -tangent[:, 0]]), points, face)

    def _first_hits(self, sheet, frame, angles, directions):
        """Distance, face and cosine of incidence of the first surface on each ray from the emitter."""
        reach, face = np.full(len(angles), np.inf), np.zeros(len(angles), dtype=np.int64)
        cosine = np.zeros(len(angles))
        number = 1
        if self._scene.pose_cam_table is not None:
            up, foot = self._scene.pose_cam_table.rotation[:, 2], self._scene.pose_cam_table.translation
            slope = directions @ up
            with np.errstate(divide="ignore"):
                table = ((foot - sheet.emitter) @ up) / slope
            hit = (slope < 0) & (table > 0)
            reach[hit], cosine[hit] = table[hit], -slope[hit]
        for mesh, numbers in zip(self._scene.meshes, self._faces, strict=True):
            self._hit_mesh(sheet, frame, angles, directions, mesh, numbers + number, (reach, face, cosine))
            number += int(numbers.max()) + 1
        for sphere in self._scene.spheres:
            to = sphere.centre - sheet.emitter
            along = directions @ to
            root = along**2 - to @ to + sphere.radius**2
            near = along - np.sqrt(np.maximum(root, 0))
            hit = (root > 0) & (near > 0) & (near < reach)
            reach[hit], face[hit] = near[hit], number
            cosine[hit] = -((near[:, None] * directions - to) * directions).sum(axis=1)[hit] / sphere.radius
            number += 1
        return reach, face, cosine

    def _hit_mesh(self, sheet, frame, angles, directions, mesh, numbers, hits) -> None:
        """Cut the triangles with the sheet: segments in its plane, each met by the rays between its ends."""
        reach, face, cosine = hits
        off = mesh.triangles @ sheet.plane.normal - sheet.plane.d_mm
        cut = np.flatnonzero((off.min(axis=1) < 0) & (off.max(axis=1) > 0))
        a, b, c = mesh.triangles[cut].transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        for index, normal in zip(cut, normals, strict=True):
            corners, side = mesh.triangles[index], off[index]
            ends = [
                corners[i] + side[i] / (side[i] - side[j]) * (corners[j] - corners[i])
                for i, j in ((0, 1), (1, 2), (2, 0))
                if side[i] * side[j] < 0
            ]
            p, q = ((end - sheet.emitter) @ frame.T for end in ends[:2])
            low, high = sorted((np.arctan2(p[1], p[0]), np.arctan2(q[1], q[0])))
            if high - low > 2.0:
                continue  # behind the emitter
            rays = slice(*np.searchsorted(angles, [low, high]))
            along = q - p
            c, s = np.cos(angles[rays]), np.sin(angles[rays])
            distance = (p[0] * along[1] - p[1] * along[0]) / (c * along[1] - s * along[0])
            nearer = np.flatnonzero((distance > 0) & (distance < reach[rays])) + rays.start
            reach[nearer] = distance[nearer - rays.start]
            face[nearer] = numbers[index]
            cosine[nearer] = np.abs(directions[nearer] @ normal)


def _face_numbers(mesh) -> np.ndarray:
    """Number of the face of each triangle: those of one plane are one, a smoothly shaded mesh is one altogether."""
    if mesh.normals is not None:
        return np.zeros(len(mesh.triangles), dtype=np.int64)
    a, b, c = mesh.triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    plane = np.round(np.column_stack([normal, (normal * a).sum(axis=1)]), 6)
    return np.unique(plane, axis=0, return_inverse=True)[1].reshape(-1)
