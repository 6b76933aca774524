"""Whether the fan's light lies in planes: what its stripes on all poses leave of straight lines.

A plane of light is straight on a flat target wherever that is held. A line lens that bends its light, a target that is
curled the same way in every pose, or a lens that the camera's model does not have leave one bend in all stripes, which
more poses do not average out. Which of the three it is, stripes alone do not tell, so nothing is corrected: it is told,
and that the light may be bent as it was seen to be is an uncertainty of its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.calibrate.board_shape import BoardShape
from core.calibrate.fan.poses.located_pose import LocatedPose
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.poses.target_plane import on_target
from core.findings.table import note_of
from core.messages import Field, Message
from core.model import LightPlane, Pose
from core.model.arrays import Array
from core.model.residuals import Judgement, Residuals, along_line, judge_residuals, without_line

CELLS = 7
"""Parts of a stripe that are compared: enough for a bend and for an S, and each some hundred points long."""
_ACROSS = 1e-5
"""Step across a line of rays by which distances are derived: large against rounding, small against any bend."""


def judge_lines(located: Sequence[LocatedPose], adjusted: Sequence[Pose], pis: Array, shape: BoardShape) -> Judgement:
    """Judge whether stripes on the target are bent alike: their distances in mm from straight lines on planes `pis`.

    The distances are those of the used poses' stripes from the planes `pis` (N, 3), offset and slope taken out.

    `adjusted` are the poses of those `located` that are used, `shape` is the target's.
    """
    of_stripes = []
    used = (pose for pose in located if pose.used)
    for pose, place in zip(used, adjusted, strict=True):
        for line, stripe in pose.stripes.items():
            points = on_target(stripe.rays, place, shape)
            along = points @ _direction(pis[line])
            order = np.argsort(along)
            off = without_line(along, LightPlane(pis[line]).distances(points))
            expected = _expected(stripe, place, pis[line], shape)
            of_stripes.append((off[order], expected[order], along_line(along[order], CELLS)))
    return judge_residuals(
        Residuals(
            np.concatenate([off for off, _, _ in of_stripes]),
            np.concatenate([expected for _, expected, _ in of_stripes]),
            np.repeat(np.arange(len(of_stripes)), [len(off) for off, _, _ in of_stripes]),
            np.concatenate([cell for _, _, cell in of_stripes]),
            CELLS,
        )
    )


def bends_of(points: Sequence[Array], distances: Sequence[Array], pis: Array) -> Array:
    """Fit how light departs from the planes `pis` (N, 3): quadratic forms Q (N, 3, 3) in 1/mm, XᵀQX mm at X.

    `points` (n_k, 3) in mm are those on each line of all poses, `distances` (n_k,) what they are off its plane. Of
    these a parabola along the lines takes what it can: the same for all, for their light goes through one lens and
    falls on one target, and each less what a plane has of it.
    """
    bends, forms = [], []
    for own, pi in zip(points, pis, strict=True):
        axis = _direction(pi)
        along, deep = (one - (one @ own.mean(axis=0)) * pi for one in (axis, np.cross(axis, pi / np.linalg.norm(pi))))
        bend = (own @ along) ** 2
        flat = own @ np.array([pi, along, deep]).T
        plane = np.linalg.lstsq(flat, bend, rcond=None)[0] @ [pi, along, deep]
        bends.append(bend - own @ plane)
        form = np.outer(along, along) - np.outer(plane, pi)  # π·X = 1 makes forms of planes
        forms.append((form + form.T) / 2)
    bend, off = np.concatenate(bends), np.concatenate(distances)
    return np.asarray(float(bend @ off) / float(bend @ bend) * np.array(forms), dtype=np.float64)


def off_planes_mm(points: Sequence[Array], bends: Array) -> float:
    """Compute the RMS distance in mm of light of these `bends` (N, 3, 3) from its planes, at `points` on each line."""
    off = [np.einsum("ni,ij,nj->n", own, form, own) for own, form in zip(points, bends, strict=True)]
    return float(np.sqrt(np.mean(np.concatenate(off) ** 2)))


def notes_on_lines(judgement: Judgement) -> tuple[Message, ...]:
    """Note that the stripes are bent alike, and in which direction; () if they are straight."""
    if not judgement.systematic:
        return ()
    middle = judgement.profile[CELLS // 2]
    ends = (judgement.profile[0] + judgement.profile[-1]) / 2
    twist = (judgement.profile[-1] - judgement.profile[0]) / 2
    if abs(twist) > abs(ends - middle):
        return (note_of("fan.lines_wavy", mm=abs(twist), rms=judgement.rms, expected=judgement.expected),)
    where = Message("fan.bent_away", "away from") if ends > middle else Message("fan.bent_towards", "towards")
    return (
        note_of("fan.lines_bent", where=where, mm=abs(ends - middle), rms=judgement.rms, expected=judgement.expected),
    )


def bow_or_bend(judgement: Judgement) -> Message:
    """Note that stripes bend alike, and that a bow of the target, not bent light, is assumed as the reason."""
    return note_of(
        "fan.bow_or_bend",
        mm=float(np.nanmax(judgement.profile) - np.nanmin(judgement.profile)),
        field=Field("plane_target.flatness_mm"),
    )


def _direction(pi: Array) -> Array:
    """Unit vector (3,) along the line in its plane, across the viewing direction."""
    along = np.cross(pi, [0.0, 0.0, 1.0])
    return np.asarray(along / np.linalg.norm(along), dtype=np.float64)


def _expected(stripe: StripeLine, pose: Pose, pi: Array, shape: BoardShape) -> Array:
    """Stated uncertainty (n,) in mm of a stripe's points as distances from the light plane."""
    plane = LightPlane(pi)
    moved = stripe.rays + _ACROSS * np.append(stripe.across, 0.0)
    ahead = plane.distances(on_target(moved, pose, shape)) - plane.distances(on_target(stripe.rays, pose, shape))
    return np.asarray(np.abs(ahead) / _ACROSS * stripe.noise, dtype=np.float64)
