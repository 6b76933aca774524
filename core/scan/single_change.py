"""Which single change of the rig since its calibration explains that crossings disagree with the fan.

Crossings that disagree everywhere say that something is not as calibrated, not what. So the network is solved again
with each change in turn, as large as it explains most: the picture shifted on the sensor, the fan turned about its
laser, another focal length. Those are named that explain nearly all of what is too much, and no less than the best.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import displaced_fan, laser_of
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import Schedule
from core.progress import Progress, silent, steps
from core.scan.features.crossings import CrossingTable
from core.scan.first_cause import Cause, Suspect
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import HUBER_AT
from core.scan.network.equations import Adjustment
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.sweeps.locate import by_sweep, some_sweeps, sweeping_frames

EXPLAINED = 0.9
"""Share of what is too much of the misfit that the change named explains at least."""
LEAST_MISFIT = 2.0
"""Misfit of a crossing below which nothing has to be explained: 1 where the noise is as stated."""
FIRST_PX = (-48.0, -12.0, 12.0, 48.0)
"""Sizes of each change in pixels that are tried first."""
STEP_PX = 8.0
"""Size of the first step from the best of them."""
LEAST_PX = 0.5
"""Pixels at which the search ends."""
EVALUATIONS = 80
"""Solutions of the network at most for one change."""
SURELY = 20.0
"""Difference of the sums of squares that two changes leave, from which on they are told apart."""
WEIGHTS = Schedule(4, huber_at=HUBER_AT)
"""Of reweighting of each: the planes have settled by then as far as the misfit tells."""
AS_CALIBRATED = Message(
    "scan.advice_as_calibrated", "set the rig as it was at its calibration, or calibrate it again, then scan again"
)
LARGE = 5.0
"""Residual in standard deviations beyond which a crossing counts no more: a wrong one, whatever has changed."""


class Changed(StrEnum):
    """Part of the rig that has changed: the picture's place along u or v or both, the focus, or the fan."""

    PICTURE_ALONG_U = "picture along u"
    PICTURE_ALONG_V = "picture along v"
    PICTURE = "picture"
    FOCUS = "focus"
    FAN = "fan"


_DIRECTIONS = {
    Changed.PICTURE_ALONG_U: (Message("scan.to_the_left", "to the left"), Message("scan.to_the_right", "to the right")),
    Changed.PICTURE_ALONG_V: (Message("scan.upwards", "up"), Message("scan.downwards", "down")),
}
_UNSIZED = {
    Changed.PICTURE: Message("scan.picture_shifted", "the picture shifted"),
    Changed.FAN: Message("scan.fan_turned", "the fixed laser turned"),
}


@dataclass(frozen=True, eq=False, slots=True)
class SingleChange:
    """Single change of the rig that explains why crossings disagree, with its size.

    Parameters
    ----------
    what
        What has changed.
    size
        (1,) px of the picture along u or v, or (2,) along both; (1,) share of the focal length; (3,) rad of the fan, a
        rotation vector. Sizes of more than one number are not known well: crossings do not tell all their directions.
    left
        Mean square of what crossings are off, in their variances, with it.
    """

    what: Changed
    size: Array
    left: float

    @property
    def message(self) -> Message:
        """Sentence that names what part of the rig has changed and, if it is known well, by how much."""
        if self.what == Changed.FOCUS:
            percent = 100 * float(self.size[0])
            return Message("scan.change_of_focus", "the focal length changed by {percent:+.2g} %", percent=percent)
        if len(self.size) > 1:
            return _UNSIZED[self.what]
        shift = float(self.size[0])
        return Message(
            "scan.change_of_picture",
            "the picture shifted by about {px:.2g} px {direction}",
            px=abs(shift),
            direction=_DIRECTIONS[self.what][int(shift > 0)],
        )


@dataclass(frozen=True, eq=False, slots=True)
class Explanation:
    """Single changes of the rig of which each alone explains why crossings disagree, the likeliest first; at least one.

    `misfit`: mean square of what crossings are off, in their variances, with none of them.
    """

    changes: tuple[SingleChange, ...]
    misfit: float

    @property
    def share(self) -> float:
        """Share of the excess misfit of the crossings that the likeliest change explains."""
        return (self.misfit - self.changes[0].left) / (self.misfit - 1)

    @property
    def cause(self) -> Cause:
        """Return the change of the rig as a cause of the misfit, with its share."""
        return Cause(Suspect.RIG_CHANGED, self.share)

    @property
    def note(self) -> Message:
        """Note on how much a scan's crossings disagree, and which single changes of the rig would each explain it."""
        return note_of(
            "scan.explained_by_change",
            times=float(np.sqrt(self.misfit)),
            changes=tuple(one.message for one in self.changes),
        )


def explain_by_change(
    crossings: CrossingTable, line: NDArray[np.int64], camera: Camera, fan: Fan | Control, progress: Progress = silent
) -> Explanation | None:
    """Find the single changes of camera or fan that each explain why crossings disagree, the likeliest first.

    None where none does, or the misfit is not too large.

    Parameters
    ----------
    crossings, line
        M crossings, and the fan's line (M,) of each, −1 between sweeps.
    camera, fan
        As calibrated; a control holds known planes as well.
    progress
        Called with how far each solution of the network is.
    """
    some = some_sweeps(crossings)
    crossings, line = crossings.select(some), line[some]
    frames = sweeping_frames(crossings)
    table = by_sweep(crossings, frames)
    calibrated = Adjustment(table, CrossingRays.of(table, camera), line, fan, len(frames), LineErrors.of(table))
    misfit = _misfit(calibrated)
    if misfit < LEAST_MISFIT:
        return None
    enough = misfit - EXPLAINED * (misfit - 1)
    found: list[SingleChange] = []
    for what, unknowns, changed in _changes(camera, Control.of(fan)):
        size_px, left = _least(partial(_misfit_of_change, calibrated, changed), unknowns, progress)
        size = size_px / camera.matrix[0, 0] if what in (Changed.FOCUS, Changed.FAN) else size_px
        found.append(SingleChange(what, size, left))
    alike = min(one.left for one in found) + SURELY / len(crossings)
    named = [one for one in found if one.left < min(enough, alike)]
    if any(one.what in _DIRECTIONS for one in named):  # along one axis is enough, and better known
        named = [one for one in named if one.what != Changed.PICTURE]
    return Explanation(tuple(sorted(named, key=lambda one: one.left)), misfit) if named else None


def _least(misfit: Callable[[Array], float], unknowns: int, progress: Progress) -> tuple[Array, float]:
    """The change (unknowns,) in pixels with the least misfit, searched from the best of some, and that misfit."""
    tried = np.vstack([np.zeros(unknowns), *(step * np.eye(unknowns) for step in FIRST_PX)])
    corner = min(steps(tried, progress, "network", len(tried)), key=misfit)
    corners = np.vstack([corner, corner + STEP_PX * np.eye(unknowns)])
    found = minimize(
        misfit,
        corner,
        method="Nelder-Mead",
        options={"initial_simplex": corners, "xatol": LEAST_PX, "fatol": np.inf, "maxfev": EVALUATIONS},
    )
    return np.asarray(found.x), float(found.fun)


def _changes(
    camera: Camera, control: Control
) -> Iterator[tuple[Changed, int, Callable[[Array], tuple[Camera, Control]]]]:
    """What may have changed, by how many numbers, and camera and fan changed by them.

    All numbers are in pixels: those of angles and of the focal length are divided by the focal length.
    """
    here = parameters_of(camera)

    def seen_by(parameters: Array) -> tuple[Camera, Control]:
        other = camera_of(parameters, camera.image_size)
        return other, control.behind(camera, other)

    def shifted(*places: int) -> Callable[[Array], tuple[Camera, Control]]:
        return lambda size: seen_by(here + np.eye(len(here))[list(places)].T @ size)

    def focused(size: Array) -> tuple[Camera, Control]:
        return seen_by(here * np.where(np.arange(len(here)) < 2, 1 + size[0] / here[0], 1.0))

    yield Changed.PICTURE_ALONG_U, 1, shifted(3)
    yield Changed.PICTURE_ALONG_V, 1, shifted(4)
    yield Changed.PICTURE, 2, shifted(3, 4)
    yield Changed.FOCUS, 1, focused
    if control.fan.lines:
        pivot = laser_of(control.fan)
        yield (
            Changed.FAN,
            3,
            lambda size: (camera, control.with_fan(displaced_fan(control.fan, size / here[0], pivot))),
        )


def _misfit_of_change(
    calibrated: Adjustment, changed: Callable[[Array], tuple[Camera, Control]], size_px: Array
) -> float:
    camera, control = changed(size_px)
    return _misfit(replace(calibrated, geometry=CrossingRays.of(calibrated.crossings, camera), fan=control))


def _misfit(equations: Adjustment) -> float:
    """Mean square of what crossings and the fan's cells are off, in their variances; wrong crossings count as LARGE.

    None is rejected, so that it changes steadily with camera and fan.
    """
    solution = equations.weighted(WEIGHTS, scaled=True)
    squares = np.minimum(solution.residuals**2, LARGE**2).sum() + solution.cells @ solution.cells
    return float(squares) / len(equations.crossings)
