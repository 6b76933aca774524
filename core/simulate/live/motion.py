"""Motions in real time: a plate that is held still now and then, and a laser swept to and fro without end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation, Slerp

from core.model import Pose
from core.model.arrays import Array
from core.simulate.rig import Rig
from core.simulate.scene.laser import Sheet
from core.simulate.sweep import HandCourse, SweepRange, hand_course

# The hand that sweeps. Chosen to look like a hand's and to scan in a minute:
# tests/simulate/live holds them.
PASS_S = 2.0
"""Time in s of one pass of the laser over the object: about 80 mm/s."""
TURN_S, CROSSING_S = 0.4, 1.3
"""Time in s to turn back at the end of a pass, and to take the laser round to the other side of the camera."""
LIFT_MM = 90.0
"""How far up in the picture the stripe is meanwhile: half way round it is parallel to the fan's lines."""
PASSES, KNOTS = 32, 12
"""Passes before the motion repeats, and positions of the hand that make a pass."""


@dataclass(frozen=True, eq=False, slots=True)
class PlateMotion:
    """Motion of a plate that rests at each of its poses and is moved smoothly from one to the next, for ever.

    Parameters
    ----------
    poses
        `pose_cam_target` of the rests.
    pivot
        The plate's middle (3,) in its own frame, in mm: it moves straight while the plate turns about it.
    rest_s, move_s
        How long it rests, and how long a move takes.
    """

    poses: Sequence[Pose]
    pivot: Array
    rest_s: float
    move_s: float

    def at(self, time_s: float) -> tuple[Pose, int | None]:
        """Return the plate's pose at `time_s` since the first rest began, and the rest's number; None in a move."""
        number, within = divmod(max(time_s, 0.0), self.rest_s + self.move_s)
        rest = int(number) % len(self.poses)
        if within <= self.rest_s:
            return self.poses[rest], rest
        share = (within - self.rest_s) / self.move_s
        eased = share**3 * (10 - 15 * share + 6 * share**2)
        return self._between(self.poses[rest], self.poses[(rest + 1) % len(self.poses)], eased), None

    def rest_at(self, time_s: float) -> int | None:
        """Return the number, from 0, of the rest that the plate is in at `time_s`; None within a move."""
        number, within = divmod(max(time_s, 0.0), self.rest_s + self.move_s)
        return int(number) if within <= self.rest_s else None

    def end_of_rest(self, number: int) -> float:
        """Compute the time in s at which the plate's rest `number`, counted from 0, ends."""
        return number * (self.rest_s + self.move_s) + (1 - 1e-9) * self.rest_s

    def _between(self, first: Pose, second: Pose, share: float) -> Pose:
        turns = Rotation.from_matrix(np.stack([first.rotation, second.rotation]))
        rotation = np.asarray(Slerp([0.0, 1.0], turns)(share).as_matrix())
        ends = [pose.apply(self.pivot[None])[0] for pose in (first, second)]
        return Pose(rotation, ends[0] + share * (ends[1] - ends[0]) - rotation @ self.pivot)


class HandPath:
    """Path of the hand-held laser at any time: :func:`core.simulate.sweep.hand_course` joined up smoothly.

    Between two passes from different sides the laser is taken round above the camera, so that at every moment its
    light is a sheet the camera can measure with. After PASSES passes it begins again.

    Parameters
    ----------
    rig, reach
        Whose laser it is, and how far it goes.
    rng
        How this hand wanders and trembles.
    """

    def __init__(self, rig: Rig, reach: SweepRange, rng: np.random.Generator) -> None:
        self._rig = rig
        course = hand_course(reach, PASSES * KNOTS, rng)
        held = np.column_stack(
            [
                course.tilt - np.pi * (course.side < 0),  # the left side is half a turn from the right one
                course.baseline,
                course.sway,
                course.nearness,
                course.aims,
            ]
        )
        times, held = _with_turns(course, held)
        self._period = float(times[-1])
        self._held = PchipInterpolator(times, held)

    def sheet(self, time_s: float) -> Sheet:
        """Return the hand-held laser's sheet of light, in the camera frame, `time_s` after the first pass began."""
        tilt, baseline, sway, nearness, *aim = np.asarray(self._held(time_s % self._period))[:, None]
        course = HandCourse(np.zeros(1, np.intp), tilt, np.ones(1), baseline, sway, nearness, np.transpose(aim))
        return course.sheets(self._rig)[0]


def _with_turns(course: HandCourse, held: Array) -> tuple[Array, Array]:
    """Times (M,) in s and positions (M, 7) of the hand with the turns between passes; the last is the first again."""
    times, rows = [0.0], [held[0]]
    for k in range(len(held)):
        after = (k + 1) % len(held)
        if course.number[after] == course.number[k]:
            times.append(times[-1] + PASS_S / (KNOTS - 1))
        elif course.side[after] == course.side[k]:
            times.append(times[-1] + TURN_S)
        else:
            rows.append((held[k] + held[after]) / 2 - [0, 0, 0, 0, 0, LIFT_MM, 0])
            times += [times[-1] + CROSSING_S / 2, times[-1] + CROSSING_S]
        rows.append(held[after])
    return np.array(times), np.array(rows)
