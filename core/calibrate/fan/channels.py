"""Do the channels of colour pictures give the same light planes?

Light of one laser lies in one plane, in whatever channel it is seen. Saturation, a compression that keeps colours at
half the size, and a lens that refracts colours differently shift a stripe otherwise in each channel, and in all poses
alike: so neither the residuals nor poses left out show it. Where the planes by another channel alone lie farther off
than the stated uncertainties of both explain, it is not known which of them is right: those in use are then uncertain
by all of the difference, less what chance makes of it. The target's points are the same for all channels, so that the
sum of both covariances is, if anything, too large for a difference.

References
----------
JCGM 100:2008, Guide to the expression of uncertainty in measurement, 5.2 (correlated input quantities).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from core.calibrate.fan.bundle import Bundle, solve
from core.calibrate.fan.cross_validation import FEWEST
from core.calibrate.fan.observations import BundlePose, Plate
from core.calibrate.fan.poses.located_pose import LocatedPose
from core.calibrate.fan.poses.pose_stages import NOT_SEEN, line_numbers
from core.calibrate.fan.poses.stripe_lines import straight_lines
from core.calibrate.fan.poses.target_plane import on_target
from core.calibrate.results import FanCalibration
from core.findings.table import note_of
from core.image.channel_names import CHANNEL_NAMES
from core.messages import Message
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array

BY_CHANCE = 0.01
"""Probability below which the channels of a fan do not differ by chance."""
TOLD_MM = 0.05
"""A difference (RMS) that is smaller is not told."""
_NO_VARIANCE = 1e-9
"""Of the largest variance: planes of one pencil do not vary in all directions."""


@dataclass(frozen=True, eq=False, slots=True)
class Difference:
    """The light planes by one channel alone, where they differ from those in use by more than chance.

    Parameters
    ----------
    channel
        By its name.
    step
        (3N,) how far the stacked π are off those in use, less what chance makes of it, in 1/mm.
    mm
        RMS distance in mm of the stripes in use from its planes, as far off as they come out.
    times
        The difference in units of its standard uncertainty by both covariances.
    """

    channel: str
    step: Array
    mm: float
    times: float

    @property
    def note(self) -> Message:
        """Note that the light planes differ between colour channels, and by how much."""
        return note_of("fan.channels_differ", channel=CHANNEL_NAMES[self.channel], mm=self.mm, times=self.times)


def with_differences(
    calibration: FanCalibration, used: Bundle, located: Sequence[LocatedPose], camera: Camera, plate: Plate | None
) -> FanCalibration:
    """Widen the fan's covariance by differences of its planes between the pictures' colour channels, and note them.

    Parameters
    ----------
    calibration, used
        By the channel in use, and the fit that it is of.
    located
        Its poses, with what their pictures show in other channels.
    camera, plate
        As of the fit.
    """
    found = _differences(used, calibration.fan, located, camera, plate)
    if not found:
        return calibration
    between = np.mean([np.outer(one.step, one.step) for one in found], axis=0)
    return replace(
        calibration,
        fan=Fan(calibration.fan.planes, used.covariance + between),
        notes=(*calibration.notes, *(one.note for one in found if one.mm >= TOLD_MM)),
    )


def _differences(
    used: Bundle, fan: Fan, located: Sequence[LocatedPose], camera: Camera, plate: Plate | None
) -> list[Difference]:
    """Of each channel that differs by more than chance, over all that are compared."""
    channels = sorted({channel for pose in located if pose.used for channel in pose.features.others})
    most = sum(pose.used for pose in located)
    points = [(line, on_target(stripe.rays, pose.pose)) for pose in located for line, stripe in pose.stripes.items()]
    found = []
    for channel in channels:
        poses = _poses_in(channel, located, camera, fan)
        seen = [sum(line in pose.stripes for pose in poses) for line in range(fan.lines)]
        if len(poses) < FEWEST or 2 * len(poses) < most or min(seen) < 2:
            continue
        other = solve(used.planes, poses, camera, plate=plate)
        step = (other.planes.pis - used.planes.pis).ravel()
        squares, freedom = _squares(step, used.covariance + other.covariance)
        p = float(fdtrc(freedom, max(min(used.freedom, other.freedom), 1.0), squares / freedom))
        if not other.converged or p * len(channels) >= BY_CHANCE or squares <= freedom:
            continue
        off = np.concatenate([LightPlane(other.planes.pis[line]).distances(own) for line, own in points])
        own_off = np.concatenate([LightPlane(used.planes.pis[line]).distances(own) for line, own in points])
        mm = float(np.sqrt(np.mean((off - own_off) ** 2)))
        times = float(np.sqrt(squares / freedom))
        found.append(Difference(channel, np.sqrt(1 - freedom / squares) * step, mm, times))
    return found


def _squares(step: Array, covariance: Array) -> tuple[float, int]:
    """A step squared in units of its covariance, in the directions that have a variance, and how many these are."""
    scale = np.sqrt(np.maximum(covariance.diagonal(), np.finfo(np.float64).tiny))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    seen = values > _NO_VARIANCE * values[-1]
    along = vectors[:, seen].T @ (step / scale)
    return float(np.sum(along**2 / values[seen])), int(seen.sum())


def _poses_in(channel: str, located: Sequence[LocatedPose], camera: Camera, fan: Fan) -> list[BundlePose]:
    """The poses in use as a channel shows them: its stripes are those of the fan's lines that they are nearest to."""
    found = []
    for pose in located:
        view, lines = pose.features.view, pose.features.others.get(channel)
        if not pose.used or view is None or not lines:
            continue
        straight = straight_lines(lines, camera)
        numbers = line_numbers(straight, pose.pose, fan)
        stripes = {line: own for own, line in zip(straight, numbers, strict=True) if line != NOT_SEEN}
        if stripes:
            found.append(BundlePose(view, pose.pose, stripes))
    return found
