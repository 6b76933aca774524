"""What no program could do better on a planned rig's pictures: Cramér–Rao bounds from the centreline to the part.

Each quantity twice: with the planned speckle and without any. All pictures count together here, camera, fan, sweeps
and part adjusted in one, and shapes are known to be flat or round: so these are floors, and what a program leaves above
them is its own. Errors that no noise explains, of a light that lies unevenly on round flanks or of a lens that is not
its model's, are not in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from core.calibrate.camera.reprojection import ray_changes
from core.calibrate.change import STABLE, Stability
from core.messages import Message, plural_message
from core.model.arrays import Array
from core.progress import Progress, silent
from core.wings.rig_planning.prediction.design import USUAL_CHECK, Design
from core.wings.rig_planning.prediction.information import (
    CAMERA,
    PlannedScan,
    Seen,
    Sensing,
    ball_scan,
    block_scan,
    calibration_information,
    change_covariance,
    check_information,
    covariance,
)
from core.wings.rig_planning.prediction.light_bounds import crossing_bound

STRETCH_PX = 100
"""Length of stripe over which a mean is stated."""
ARMS_PX = 120.0
"""Length of both stripes seen about a crossing."""
FREE_FORM_MM = 1.0
"""Length along a stripe that a point of a surface of unknown shape may be averaged over."""
BALL_MM = 50.0
"""Diameter of the ball that is bounded beside the blocks: that of the accuracy table."""


@dataclass(frozen=True, slots=True)
class Bound:
    """Least standard uncertainty of a `quantity`, in `unit`: of pictures `without` speckle, and `with_speckle`."""

    quantity: Message
    unit: str
    without: float
    with_speckle: float


class _Row(NamedTuple):
    """A bound of one kind of light: the quantity, its unit and the least standard uncertainty."""

    quantity: Message
    unit: str
    u: float


def bounds_of(
    design: Design,
    heights_mm: Sequence[float] | None = None,
    *,
    ball_mm: float = BALL_MM,
    seed: int = 1,
    stability: Stability = STABLE,
    progress: Progress = silent,
) -> tuple[Bound, ...]:
    """Compute the Cramér–Rao bounds of a planned rig for blocks of `heights_mm` (None: the design's) and a ball.

    Of a rig that may change between calibration and scan (`stability`) those of a thickness with and without a check.

    Raises
    ------
    InputError
        If the camera target does not fit into the picture.
    """
    heights = design.heights_mm if heights_mm is None else tuple(heights_mm)
    found = []
    for number, speckle in enumerate((False, True)):
        progress("bounds", number, 2)
        found.append(list(_Bounds(Sensing.of(design, speckle=speckle), seed, stability).rows(heights, ball_mm)))
    progress("bounds", 2, 2)
    pairs = zip(*found, strict=True)
    return tuple(Bound(clean.quantity, clean.unit, clean.u, grainy.u) for clean, grainy in pairs)


@dataclass(frozen=True, eq=False)
class _Bounds:
    """The bounds of one kind of light."""

    sensing: Sensing
    seed: int
    stability: Stability

    def rows(self, heights_mm: Sequence[float], ball_mm: float) -> Iterator[_Row]:
        """All of them, in the order of the table."""
        scans = [block_scan(self.sensing, height, self.seed) for height in heights_mm]
        yield from _of_lines(scans[-1])
        known = covariance(self.calibration)
        yield _Row(Message("plan.bound_focal", "focal length"), "px", float(np.sqrt(known[0, 0])))
        of_fan = Message("plan.bound_on_fan", "depth on the fan's lines, from camera and fan")
        yield _Row(of_fan, "mm", self._of_fan(scans[-1], known))
        of_sweep = Message("plan.bound_on_sweep", "depth on a sweep from its light plane, camera and fan known")
        yield _Row(of_sweep, "mm", self._of_sweeps(scans[-1]))
        of_point = Message(
            "plan.bound_free_form",
            "depth of a point of free form, {length_mm:g} mm of stripe",
            length_mm=FREE_FORM_MM,
        )
        yield _Row(of_point, "mm", self._of_points(scans[-1]))
        for height, scan in zip(heights_mm, scans, strict=True):
            thickness = Message("plan.bound_thickness", "thickness of {height_mm:g} mm", height_mm=height)
            yield _Row(thickness, "mm", self._thickness(scan, self.calibration))
            if self.stability != STABLE:
                yield from self._changed(scan, height)
            alone = Message(
                "plan.bound_thickness_known",
                "thickness of {height_mm:g} mm, camera and fan known",
                height_mm=height,
            )
            yield _Row(alone, "mm", self._thickness(scan, None))
        ball = Message("plan.bound_ball", "diameter of a ball of {diameter_mm:g} mm", diameter_mm=ball_mm)
        yield _Row(ball, "mm", self._diameter(ball_scan(self.sensing, ball_mm, self.seed)))

    @cached_property
    def calibration(self) -> Array:
        """(U, U) information of the calibrations' pictures."""
        return calibration_information(self.sensing, self.seed)

    @cached_property
    def changed(self) -> Array:
        """(U, U) information of the calibrations' pictures on camera and fan as they may be at the scan."""
        return covariance(covariance(self.calibration) + change_covariance(self.sensing, self.stability))

    def _changed(self, scan: PlannedScan, height_mm: float) -> Iterator[_Row]:
        """A thickness by a rig that may have changed, without a check of the day and with one."""
        unchecked = Message(
            "plan.bound_thickness_changed",
            "thickness of {height_mm:g} mm, changed since the calibration and not checked",
            height_mm=height_mm,
        )
        yield _Row(unchecked, "mm", self._thickness(scan, self.changed))
        poses = self.sensing.design.check_poses or USUAL_CHECK
        checked = plural_message(
            "plan.bound_thickness_checked",
            "thickness of {height_mm:g} mm, changed and checked by {n} picture",
            "thickness of {height_mm:g} mm, changed and checked by {n} pictures",
            n=poses,
            height_mm=height_mm,
        )
        known = self.changed + check_information(self.sensing, self.seed, poses)
        yield _Row(checked, "mm", self._thickness(scan, known))

    def _together(self, scan: PlannedScan, known: Array) -> Array:
        """Covariance of camera, fan and the scan's surfaces from its pictures, the two first `known` (U, U) before."""
        information = scan.information()
        information[: self.sensing.unknowns, : self.sensing.unknowns] += known
        return covariance(information)

    def _thickness(self, scan: PlannedScan, known: Array | None) -> float:
        """With this information on camera and fan beforehand; None: they are known for certain."""
        first = self.sensing.unknowns
        own = (
            covariance(scan.information()[first:, first:])
            if known is None
            else self._together(scan, known)[first:, first:]
        )
        difference = np.array([0.0, 0.0, 1.0, -1.0])
        return float(np.sqrt(difference @ own @ difference))

    def _diameter(self, scan: PlannedScan) -> float:
        return 2 * float(np.sqrt(self._together(scan, self.calibration)[-1, -1]))

    def _of_fan(self, scan: PlannedScan, known: Array) -> float:
        """RMS over the points of the fan's lines on table and block."""
        camera, variance = self.sensing.camera, []
        for number, seen in enumerate(scan.fan):
            for line, *_ in seen.stripes:
                rays = camera.rays(line.uv)
                by = np.hstack(
                    [
                        np.einsum("i,nij->nj", seen.pi[:2], ray_changes(camera, rays)[:, :, :CAMERA]),
                        rays @ self.sensing.of_line(number),
                    ]
                )
                variance.append(line.points[:, 2] ** 4 * np.einsum("ni,ij,nj->n", by, known, by))
        return float(np.sqrt(np.concatenate(variance).mean()))

    def _of_sweeps(self, scan: PlannedScan) -> float:
        """Median over the points of all sweeps."""
        first = self.sensing.unknowns
        surfaces = covariance(scan.information()[first:, first:])
        sigma = []
        for seen in scan.sweeps:
            if not seen.stripes:
                continue
            information = scan.of_sweep(seen)[first:, first:]
            own = np.linalg.pinv(information[-3:, -3:], rcond=1e-13, hermitian=True)
            moved = own @ information[-3:, :-3]
            of_plane = own + moved @ surfaces @ moved.T
            for line, *_ in seen.stripes:
                rays = self.sensing.camera.rays(line.uv)
                sigma.append(line.points[:, 2] ** 2 * np.sqrt(np.einsum("ni,ij,nj->n", rays, of_plane, rays)))
        return float(np.median(np.concatenate(sigma)))

    def _of_points(self, scan: PlannedScan) -> float:
        """Median over all points, from their own stretch of stripe alone."""
        camera, sigma = self.sensing.camera, []
        for seen in scan.sweeps:
            for line, _, density in seen.stripes:
                rays, depth = camera.rays(line.uv), line.points[:, 2]
                slope = camera.inverse_depth_slopes(seen.pi, rays, line.normal)
                length_px = FREE_FORM_MM * camera.focal / depth
                sigma.append(depth**2 * np.abs(slope) * density / np.sqrt(length_px))
        return float(np.median(np.concatenate(sigma)))


def _of_lines(scan: PlannedScan) -> Iterator[_Row]:
    """Of centrelines and crossings."""
    fan, hand = (_median_density(part) for part in (scan.fan, scan.sweeps))
    of_fan = Message(
        "plan.bound_fan_line", "centreline of the fan's stripes, mean of {length_px} px", length_px=STRETCH_PX
    )
    of_hand = Message(
        "plan.bound_sweep_line", "centreline of the sweeps' stripes, mean of {length_px} px", length_px=STRETCH_PX
    )
    for line, density in ((of_fan, fan), (of_hand, hand)):
        yield _Row(line, "px", density / np.sqrt(STRETCH_PX))
    for degrees in (90, 45, 20):
        own = crossing_bound(fan, hand, ARMS_PX, np.radians(degrees))
        crossing = Message(
            "plan.bound_crossing",
            "crossing at {angle_deg}°, arms of {arm_px:g} px, per coordinate",
            angle_deg=degrees,
            arm_px=ARMS_PX / 2,
        )
        yield _Row(crossing, "px", float(np.sqrt(np.trace(own) / 2)))


def _median_density(part: Sequence[Seen]) -> float:
    weighted = [(density, len(line)) for seen in part for line, _, density in seen.stripes]
    return float(np.median(np.repeat(*np.array(weighted, dtype=object).T.tolist())))
