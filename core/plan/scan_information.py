"""Fisher information of a planned scan on camera, fan and what is measured: a block on the table, or a ball."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.model.arrays import Array
from core.plan.information import CAMERA, Sensing, eliminated, flat_stripe, round_stripe
from core.plan.light_lines import LitLine, lit_ball
from core.plan.scanning import Stage
from core.plan.seen_stripes import SeenStripes
from core.simulate.laser import Sheet, fan_sheets
from core.simulate.scene import Sphere

TABLE, BALL = 0, -1
"""Numbers of the table and of the ball among a stage's faces."""
_PLANE = 3


@dataclass(frozen=True, eq=False, slots=True)
class Surface:
    """A surface to be measured, of S unknowns behind those of camera and fan.

    For a flat one `at` is τ (3,) in 1/mm and `by` (3, S) ∂τ/∂(unknowns); for a round one (`round`) `at` is the centre
    (3,) in mm and `by` (4, S) the derivatives of centre and radius.
    """

    at: Array
    by: Array
    round: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Seen:
    """The stripes of one light plane π on surfaces: line, surface and N0 of each."""

    pi: Array
    stripes: tuple[tuple[LitLine, Surface, float], ...]


@dataclass(frozen=True, eq=False, slots=True)
class PlannedScan:
    """What a scan sees of `unknowns` of its surfaces: by the fan's lines, and by every sweep."""

    sensing: Sensing
    unknowns: int
    fan: tuple[Seen, ...]
    sweeps: tuple[Seen, ...]

    def information(self) -> Array:
        """(U + S, U + S) on camera, fan and surfaces; the sweeps' planes are eliminated."""
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
        """(U + S + 3, …) with the sweep's own plane last."""
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
    """A block on the table: unknown are two tilts that both faces share, and the distances in mm of table and top."""
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
    """A ball on the table: unknown are the table's τ, the ball's centre and its radius."""
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
