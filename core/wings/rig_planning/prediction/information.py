"""Fisher information of a planned measurement: what all its pictures together can tell of camera, fan and part.

Every pixel of every stripe tells, to N0 of `light_bounds`, where a light plane π cuts a surface in the
picture. On a flat surface τ (τ·X = 1 on it) that is where (π − τ)·r = 0, on a sphere where |r/(π·r) − c| = R. With D =
∂/∂(u, v) of the left side, a pixel's length of stripe adds J Jᵀ/(N0² |D|²), J being the derivatives by all unknowns.
Poses and sweeps are unknowns of a few pictures each and eliminated one by one; camera and fan stay, and what is
measured.

The shape of the surfaces is taken as known (flat, round), corners and stripes as found at their bounds: no program can
be better with these pictures, and one that must find out the shape is worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibrate.camera.reprojection import linearise, parameters_of, ray_changes
from core.calibrate.change import Stability, changes
from core.calibrate.fan.pencil import FreePlanes, PlaneSet, pencil_near
from core.calibrate.fan.poses.target_plane import target_plane_changes
from core.image.stripes.noise import ROUNDING_VARIANCE, NoiseModel
from core.image.stripes.speckle import NO_SPECKLE, Speckle
from core.image.stripes.stripe import PIXEL_VARIANCE
from core.image.targets import BlackSquare, Rectangle, Target
from core.image.targets.target_view import TargetView
from core.model import Camera, Fan, LightPlane, Pose
from core.model.arrays import Array
from core.simulate.calibration import CAMERA_GREY, PLANE_GREY
from core.simulate.scene.boards import BLACK, WHITE
from core.simulate.scene.laser import Sheet, fan_sheets
from core.simulate.scene.scene import Sphere
from core.simulate.scene.targets import room_shade
from core.wings.rig_planning.prediction.calibrating import plates_under_fan, square_covariance, view_poses
from core.wings.rig_planning.prediction.design import Design
from core.wings.rig_planning.prediction.light_bounds import edge_density, point_bound, stripe_density
from core.wings.rig_planning.prediction.light_lines import LitLine, lit_ball
from core.wings.rig_planning.prediction.scanning import Stage
from core.wings.rig_planning.prediction.seen_stripes import SeenStripes

CAMERA = 9
"""Unknowns of the camera: `core.calibrate.results.CAMERA_PARAMETERS` without k3."""
_POSE = 6
"""Unknowns of a pose."""
TABLE, BALL = 0, -1
"""Numbers of the table and of the ball among a stage's faces."""
_PLANE = 3
"""Unknowns of a light plane."""


@dataclass(frozen=True, eq=False, slots=True)
class Sensing:
    """Light and camera of a planned rig, with or without `speckle`."""

    design: Design
    camera: Camera
    fan: PlaneSet
    noise: NoiseModel
    speckle: Speckle
    blur_px: float

    @classmethod
    def of(cls, design: Design, *, speckle: bool) -> Sensing:
        """Make the light and the camera of a planned rig, with or without laser speckle."""
        rig = design.rig()
        shot = 1 / design.electrons_per_grey
        read = np.sqrt(design.read_noise_grey**2 + ROUNDING_VARIANCE)
        grains = Speckle(design.speckle, rig.grain_px) if speckle and design.speckle > 0 else NO_SPECKLE
        pis = rig.fan.pis
        fan = pencil_near(pis, np.radians(design.angle_deg)) if len(pis) > 1 else FreePlanes(pis)
        blur_px = float(np.sqrt(rig.blur_px**2 + PIXEL_VARIANCE))
        return cls(design, rig.camera, fan, NoiseModel(float(read), shot), grains, blur_px)

    @property
    def unknowns(self) -> int:
        """Number of unknown parameters of camera and fan together."""
        return CAMERA + len(self.fan.jacobian.T)

    def of_line(self, number: int) -> Array:
        """Return the derivatives (3, P) of the light plane π of fan line `number` by the fan's P unknowns."""
        return np.asarray(self.fan.jacobian[3 * number : 3 * number + 3])

    def line_of(self, piece: LitLine) -> int:
        """Find the number of the fan line whose light plane the stripe `piece` lies on."""
        off = np.abs(self.fan.pis @ piece.points.mean(axis=0) - 1)
        return int(off.argmin())

    def density(self, line: LitLine, background: float, pictures: int = 1) -> float:
        """Compute N0 in px·√px of a stripe in the mean of several pictures: its mean place over L px has σ ≥ N0/√L."""
        noise = NoiseModel(self.noise.read_grey / np.sqrt(pictures), self.noise.grey_per_electron / pictures)
        return stripe_density(
            float(np.median(line.width)), float(np.median(line.height)), background, noise, self.speckle
        )


def calibration_information(sensing: Sensing, seed: int) -> Array:
    """Compute the Fisher information (U, U) on camera and fan from all planned calibration pictures."""
    information = np.zeros((sensing.unknowns, sensing.unknowns))
    information[:CAMERA, :CAMERA] += _of_views(sensing, seed)
    return information + check_information(sensing, seed, sensing.design.poses)


def change_covariance(sensing: Sensing, stability: Stability) -> Array:
    """Compute the covariance (U, U) of camera and fan by their changes between calibration and scan."""
    fan, here = Fan(tuple(LightPlane(pi) for pi in sensing.fan.pis)), parameters_of(sensing.camera)
    columns = []
    for one, share in zip(changes(sensing.camera, fan), stability.over_default, strict=True):
        by_camera = (parameters_of(one.camera) - here)[:CAMERA]
        moved = one.fan.pis - sensing.fan.pis
        by_fan = np.linalg.lstsq(sensing.fan.jacobian, moved.ravel(), rcond=None)[0]
        columns.append(share * np.concatenate([by_camera, by_fan]))
    root = np.column_stack(columns)
    return np.asarray(root @ root.T)


def flat_stripe(sensing: Sensing, line: LitLine, density: float, pi: Array, tau: Array, by: Array) -> Array:
    """Compute the Fisher information (C, C) of a stripe of light plane `pi` on the plane `tau`, both (3,) in 1/mm.

    `by` (6, C) are the derivatives of π and τ, one above the other, by the unknowns; the camera's are the first.
    """
    rays = sensing.camera.rays(line.uv)
    difference = (pi - tau)[:2]
    gradient = difference @ sensing.camera.ray_jacobian(rays)
    rows = np.hstack([rays, -rays]) @ by
    rows[:, :CAMERA] += difference @ ray_changes(sensing.camera, rays)[:, :, :CAMERA]
    return _summed(rows, gradient, density)


def round_stripe(sensing: Sensing, line: LitLine, density: float, pi: Array, centre: Array, by: Array) -> Array:
    """Compute the Fisher information (C, C) of a stripe of light plane `pi` (3,) on a sphere about `centre` (3,).

    `by` (7, C) are the derivatives of π, the centre and the radius by the unknowns; the camera's are the first.
    """
    rays = sensing.camera.rays(line.uv)
    inverse = 1 / (rays @ pi)
    points = rays * inverse[:, None]
    outwards = points - centre
    outwards /= np.linalg.norm(outwards, axis=1)[:, None]
    along = np.einsum("ni,ni->n", outwards, rays) * inverse**2
    by_ray = inverse[:, None] * outwards - along[:, None] * pi
    gradient = np.einsum("ni,nij->nj", by_ray[:, :2], sensing.camera.ray_jacobian(rays))
    rows = np.hstack([-along[:, None] * rays, -outwards, -np.ones((len(rays), 1))]) @ by
    rows[:, :CAMERA] += np.einsum("ni,nij->nj", by_ray[:, :2], ray_changes(sensing.camera, rays)[:, :, :CAMERA])
    return _summed(rows, gradient, density)


def eliminated(information: Array, last: int) -> Array:
    """Reduce an information matrix by eliminating its `last` unknowns, which are not of interest."""
    keep = len(information) - last
    own, shared = information[keep:, keep:], information[:keep, keep:]
    unit = 1 / np.sqrt(np.maximum(np.diag(own), 1e-300))
    inverse = np.linalg.pinv(own * np.outer(unit, unit), rcond=1e-12, hermitian=True) * np.outer(unit, unit)
    return np.asarray(information[:keep, :keep] - shared @ inverse @ shared.T)


def covariance(information: Array) -> Array:
    """Invert an information matrix, with its unknowns scaled for a stable inversion."""
    unit = 1 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    return np.asarray(np.linalg.inv(information * np.outer(unit, unit)) * np.outer(unit, unit))


def _summed(rows: Array, gradient: Array, density: float) -> Array:
    weighted = rows / (density * np.linalg.norm(gradient, axis=1))[:, None]
    return np.asarray(weighted.T @ weighted)


def _of_views(sensing: Sensing, seed: int) -> Array:
    """(9, 9) information on the camera of the views of its target."""
    design = sensing.design
    information = np.zeros((CAMERA, CAMERA))
    for pose in view_poses(design, seed):
        rows = _target_rows(sensing, design.camera_target, pose, CAMERA_GREY)
        information += eliminated(rows.T @ rows, _POSE)
    return information


def check_information(sensing: Sensing, seed: int, poses: int) -> Array:
    """Compute the Fisher information (U, U) on camera and fan from `poses` simulated pictures of the plane target."""
    size = sensing.unknowns
    information = np.zeros((size, size))
    columns = np.concatenate([np.arange(CAMERA), size + np.arange(_POSE)])
    for pose, pieces in plates_under_fan(sensing.design, seed, poses):
        own = np.zeros((size + _POSE, size + _POSE))
        rows = _target_rows(sensing, sensing.design.plane_target, pose, PLANE_GREY)
        own[np.ix_(columns, columns)] += rows.T @ rows
        tau, by_pose = target_plane_changes(pose)
        background = WHITE * float(room_shade(pose, PLANE_GREY))
        for piece in pieces:
            number = sensing.line_of(piece)
            by = np.zeros((6, size + _POSE))
            by[:3, CAMERA:size], by[3:, size:] = sensing.of_line(number), by_pose
            density = sensing.density(piece, background)
            own += flat_stripe(sensing, piece, density, sensing.fan.pis[number], tau, by)
        information += eliminated(own, _POSE)
    return information


def _target_rows(sensing: Sensing, target: Target, pose: Pose, white_grey: float) -> Array:
    """Derivatives (2N, 9 + 6) of a target's points by camera and pose, in units of their bound."""
    uv, by_camera, by_pose = linearise(sensing.camera, pose, target.points)
    grey = float(room_shade(pose, white_grey))
    density = edge_density(grey * (WHITE - BLACK), grey * BLACK, sensing.blur_px, sensing.noise)
    if isinstance(target, BlackSquare | Rectangle):
        view = TargetView(target.points, uv, np.ones(len(uv)), covariance=square_covariance(uv, density))
    else:
        sigma = point_bound(target, density, sensing.camera.focal / float(pose.translation[2]))
        view = TargetView(target.points, uv, np.full(len(uv), sigma))
    return view.whitened(np.concatenate([by_camera[:, :, :CAMERA], by_pose], axis=2))


@dataclass(frozen=True, eq=False, slots=True)
class Surface:
    """Surface to be measured, of S unknowns behind those of camera and fan.

    For a flat one `at` is τ (3,) in 1/mm and `by` (3, S) ∂τ/∂(unknowns); for a round one (`round`) `at` is the centre
    (3,) in mm and `by` (4, S) the derivatives of centre and radius.
    """

    at: Array
    by: Array
    round: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Seen:
    """Stripes of one light plane π on surfaces: line, surface and N0 of each."""

    pi: Array
    stripes: tuple[tuple[LitLine, Surface, float], ...]


@dataclass(frozen=True, eq=False, slots=True)
class PlannedScan:
    """Stripes of a scan on surfaces of so many `unknowns`: of the fan's lines, and of every sweep."""

    sensing: Sensing
    unknowns: int
    fan: tuple[Seen, ...]
    sweeps: tuple[Seen, ...]

    def information(self) -> Array:
        """Compute the Fisher information (U + S, U + S) of the scan on camera, fan and surfaces, sweeps eliminated."""
        size = self.sensing.unknowns + self.unknowns
        total = np.zeros((size, size))
        for number, seen in enumerate(self.fan):
            by = np.zeros((_PLANE, size))
            by[:, CAMERA : self.sensing.unknowns] = self.sensing.of_line(number)
            total += self._of(seen, by)
        for seen in self.sweeps:
            total += eliminated(self.of_sweep(seen), _PLANE)
        return total

    def of_sweep(self, seen: Seen) -> Array:
        """Compute the Fisher information (U + S + 3, U + S + 3) of one sweep; its light plane's unknowns are last."""
        size = self.sensing.unknowns + self.unknowns
        return self._of(seen, np.eye(_PLANE, size + _PLANE, size))

    def _of(self, seen: Seen, by_plane: Array) -> Array:
        first, size = self.sensing.unknowns, by_plane.shape[1]
        total = np.zeros((size, size))
        for line, surface, density in seen.stripes:
            by = np.zeros((_PLANE + len(surface.by), size))
            by[:_PLANE] = by_plane
            by[_PLANE:, first : first + self.unknowns] = surface.by
            stripe = round_stripe if surface.round else flat_stripe
            total += stripe(self.sensing, line, density, seen.pi, surface.at, by)
        return total


def block_scan(sensing: Sensing, height_mm: float, seed: int) -> PlannedScan:
    """Plan the scan of a block on the table, whose unknowns are two tilts and the distances of table and top."""
    stage = Stage(sensing.design, height_mm)
    normal = stage.faces[TABLE].normal
    across = np.linalg.svd(normal[None])[2][1:]
    top = min(range(1, len(stage.faces)), key=lambda k: float(stage.faces[k].corners[:, 2].mean()))
    surfaces = {}
    for column, face in enumerate((TABLE, top)):
        distance = float(stage.faces[face].corners[0] @ normal)
        by = np.zeros((3, 4))
        by[:, :2] = across.T / distance
        by[:, 2 + column] = -normal / distance**2
        surfaces[face] = Surface(normal / distance, by)
    return _planned(sensing, stage, surfaces, (), 4, seed)


def ball_scan(sensing: Sensing, diameter_mm: float, seed: int) -> PlannedScan:
    """Plan the scan of a ball on the table, whose unknowns are the table's plane, the ball's centre and radius."""
    stage = Stage(sensing.design, diameter_mm, sensing.design.ball(diameter_mm))
    face = stage.faces[TABLE]
    tau = face.normal / float(face.corners[0] @ face.normal)
    (ball,) = stage.scene.spheres
    surfaces = {TABLE: Surface(tau, np.eye(3, 7)), BALL: Surface(ball.centre, np.eye(4, 7, 3), round=True)}
    return _planned(sensing, stage, surfaces, (ball,), 7, seed)


def _planned(
    sensing: Sensing, stage: Stage, surfaces: dict[int, Surface], balls: Sequence[Sphere], unknowns: int, seed: int
) -> PlannedScan:
    design, background = sensing.design, stage.background_grey()
    sheets = design.sweeps_over(stage.scene, seed)
    of_fan, of_hand = SeenStripes.of_fan(design), SeenStripes.of_hand(design)

    def seen(sheet: Sheet, kind: SeenStripes, pictures: int) -> Seen:
        lines = stage.lines([sheet], kind)
        lines += [lit for ball in balls for lit in lit_ball(sheet, ball, BALL, stage.camera, stage.rig.blur_px)]
        stripes = [
            (line, surfaces[line.face], sensing.density(line, background, pictures))
            for line in lines
            if line.face in surfaces
        ]
        return Seen(sheet.plane.pi, tuple(stripes))

    pictures = 1 + design.sweeps  # the fan stands in the reference and in every frame
    return PlannedScan(
        sensing,
        unknowns,
        tuple(seen(sheet, of_fan, pictures) for sheet in fan_sheets(stage.rig, design.work_point)),
        tuple(seen(sheet, of_hand, 1) for sheet in sheets),
    )
