"""Calibration of the fan: from the target's poses and the stripes on them to light planes with a covariance.

Each pose of a flat target is located by its own points, its straight stripes are put on it, the stripes are sorted
into the lines of the fan by the consensus of all poses, and planes and poses are solved together: freely first, then
as the pencil the laser is said to be, if the comparison speaks for it.

References
----------
Sun et al., Sensors 2023, 23, 13, §3.2, doi:10.3390/s23010013.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.calibrate.board_shape import TRUE, Board, BoardShape, BoardTolerance
from core.calibrate.fan.bundle import Bundle, solve
from core.calibrate.fan.channels import with_differences
from core.calibrate.fan.cross_validation import predict
from core.calibrate.fan.observations import BundlePose, Plate
from core.calibrate.fan.pencil import FreePlanes, PlaneSet
from core.calibrate.fan.poses.line_assignment import NOT_SEEN, assign_lines
from core.calibrate.fan.poses.located_pose import LocatedPose, locate
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.calibrate.fan.poses.stripe_lines import StripeLine
from core.calibrate.fan.poses.target_plane import on_target
from core.calibrate.fan.stripe_distances import BOWS
from core.calibrate.fan.summary import summarise
from core.calibrate.fan.verdict import Constrained, judge
from core.calibrate.levenberg import MOST_STEPS
from core.calibrate.results import FanCalibration
from core.errors import InputError
from core.findings.table import note_of
from core.image.exclusion import Exclusion
from core.messages import Field, Message
from core.model import Camera
from core.model.arrays import Array
from core.progress import Progress, silent, steps

WHERE = "planes"
MORE_POSES = Message("advice.more_poses", "record more poses of the target, at different distances and tilts")
_LINES = Field("laser_fan.lines", whole=True)
SMALLEST_SPREAD = 0.01
"""A plane is not determined by stripes that lie nearer to one straight line than this share of their depth (RMS)."""
_DISAGREES = Message("fan.no_common_stripe", "no stripe on the target agrees with the other poses")
DISTINCT = 0.01
"""Light planes are two if they cut a ray at depths that differ by more than this share."""
MOST_BOWED = 3.0
"""A bow of this many times the stated flatness is not believed."""
TILTS_OF_USE = np.deg2rad(60.0)
"""The most that a target can be tilted and still be seen well."""
BENDS_MM = 0.03
"""Standard deviation in mm of how much a board bends otherwise when it is held anew, between one step and the next:
assumed, for a sheet on a board of some mm."""
OUTLYING = 5.0
"""A pose this many times worse than the median pose is left out."""
NOT_CONVERGED = note_of("fan.not_converged", n=MOST_STEPS)


@dataclass(frozen=True, slots=True)
class FanOptions:
    """Options of a fan calibration: what is known of laser and target.

    Parameters
    ----------
    lines
        How many light planes it has.
    angle
        In rad between neighbouring planes, as stated by its maker; None if unknown. Of no meaning for one line.
    constrained
        "always" holds the planes to one pencil with that angle, "axis" to a pencil with any angles, "never" to
        nothing; "auto" takes the first of these that suits the laser.
    target
        How true the target is: its bow is solved for within its flatness, which is that of what is used of it.
    board
        The target's shape where the camera's calibration with the same target has found it bowed: then its bow is
        solved for from there, within what is known of it, whatever the flatness.

    Raises
    ------
    ValueError
        If there is no line, or the angle is not between 0 and π/2.
    """

    lines: int = 3
    angle: float | None = None
    constrained: Constrained = "auto"
    target: BoardTolerance = TRUE
    board: BoardShape | None = None

    def __post_init__(self) -> None:
        if self.lines < 1:
            raise ValueError(f"a fan has at least one line, not {self.lines}")
        if self.angle is not None and self.lines > 1 and not 0 < self.angle < np.pi / 2:
            raise ValueError(f"the angle between neighbouring lines must be between 0 and π/2 rad, not {self.angle}")

    @property
    def bowed_shape(self) -> BoardShape | None:
        """Shape of the target if the camera's calibration has found it bowed; None if not."""
        return self.board if self.board is not None and self.board.values[:BOWS].any() else None


def fit_fan(
    features: Sequence[PoseFeatures],
    camera: Camera,
    options: FanOptions,
    progress: Progress = silent,
    excluded: Collection[str] = (),
    camera_covariance: Array | None = None,
) -> FanCalibration:
    """Calibrate the fan of light planes from target points and stripes seen in its poses.

    Parameters
    ----------
    features
        What the pictures of each pose show, from :func:`core.calibrate.fan.poses.plane_pose.measure_plane_pose`.
    camera
        The calibrated camera. May differ a little from the one the features were measured with, so that a fit can be
        repeated to see how the camera's uncertainty goes on into the fan's.
    options
        What is known of the laser.
    excluded
        Names of poses that are located, but have no part in the fit.
    camera_covariance
        (10, 10) in the order of CAMERA_PARAMETERS: then the poses correct the camera as far as they know better, and
        the fan is calibrated with the corrected one, which the result holds. None: the camera stays as it is.

    Raises
    ------
    InputError
        If no pose is usable, fewer lines are seen than promised, or the poses are too alike to determine a plane.
    """
    located = [locate(pose, camera) for pose in steps(features, progress, "fan poses", len(features))]
    located = [
        pose.left_out(Exclusion.BY_HAND) if pose.used and pose.features.name in excluded else pose for pose in located
    ]
    _check_poses(located)
    located, rough = _assigned(located, camera, options)
    _check_spread(located, options.lines)
    further = _further_line(located, camera, rough)
    plate = _plate(located, options)
    located, free = _solve_without_outlying_poses(FreePlanes(rough), located, camera, plate)
    _check_bow(free, options)
    volume = _points_by_line(located, free)
    verdict = judge(free, volume, options.angle, options.constrained)
    if camera_covariance is not None and camera_covariance.any():
        joint = solve(verdict.start, _bundle_poses(located), camera, camera_covariance, plate=plate)
        again = fit_fan(features, joint.camera, options, progress, excluded)
        notes = again.notes if joint.converged else tuple(dict.fromkeys((NOT_CONVERGED, *again.notes)))
        return replace(
            again,
            camera=joint.camera,
            camera_covariance=joint.camera_covariance,
            notes=notes,
            converged=again.converged and joint.converged,
        )
    used = free
    if not isinstance(verdict.start, FreePlanes):
        used = solve(verdict.start, _bundle_poses(located), camera, plate=plate)
    foretold = predict(used, _bundle_poses(located), camera, plate)
    flat = None
    if plate is not None and options.bowed_shape is None:
        flat = solve(verdict.start, _bundle_poses(located), camera)
    summary = summarise(located, free, used, verdict, foretold, further, flat)
    summary = with_differences(summary, used, located, camera, plate)
    converged = verdict.converged and all(one.converged for one in (free, used, flat) if one is not None)
    of_fit = () if converged else (NOT_CONVERGED,)
    shape_known = options.bowed_shape is not None
    of_target = options.target.notes("plane_target", shape_known=shape_known)
    return replace(
        summary,
        notes=(*of_fit, *summary.notes, *of_target),
        scale_sd=options.target.size_sd,
        scale_assumed=options.target.scale_sd is None,
        converged=converged,
        flatness_assumed=options.target.flatness_mm is None and not shape_known,
    )


def _check_poses(located: Sequence[LocatedPose]) -> None:
    """InputError unless two poses are usable."""
    usable = sum(pose.used for pose in located)
    if usable >= 2:
        return
    reasons = tuple(
        Message("fan.of_pose", "{pose}: {reason}", pose=pose.features.name, reason=pose.reason)
        for pose in located
        if pose.reason is not None
    )[:3]
    if not located:
        what = Message("fan.no_poses", "there are no poses of the target")
    elif usable == 0:
        what = Message(
            "fan.no_usable_pose", "none of the {n} poses can be used ({reasons:;})", n=len(located), reasons=reasons
        )
    elif reasons:
        what = Message(
            "fan.one_usable_pose_why",
            "only one pose can be used, which does not determine a light plane ({reasons:;})",
            reasons=reasons,
        )
    else:
        what = Message("fan.one_usable_pose", "only one pose can be used, which does not determine a light plane")
    raise InputError(
        what,
        where=WHERE,
        todo=Message(
            "advice.more_poses_with_fan",
            "{advice}, with the fan on and the whole target in the picture",
            advice=MORE_POSES,
        ),
    )


def _assigned(located: Sequence[LocatedPose], camera: Camera, options: FanOptions) -> tuple[list[LocatedPose], Array]:
    """The poses with their stripes sorted into fan lines, and the planes (N, 3) roughly."""
    assignment = assign_lines([pose.as_lines(camera) for pose in located], options.lines, options.angle)
    found = len(assignment.pis)
    if found < options.lines:
        usable = sum(pose.used for pose in located)
        raise InputError(
            Message(
                "fan.few_lines",
                "only {n} of the {all} promised fan lines were seen in enough of the {poses} usable poses",
                n=found,
                all=options.lines,
                poses=usable,
            ),
            where=WHERE,
            todo=Message(
                "advice.check_lines_and_poses",
                "check {field}, and that every line falls on the target in several poses",
                field=_LINES,
            ),
        )
    sorted_poses = []
    for pose, which in zip(located, assignment.which.T, strict=True):
        stripes = {line: pose.lines[index] for line, index in enumerate(which) if index != NOT_SEEN}
        if pose.used and not stripes:
            sorted_poses.append(pose.left_out(_DISAGREES))
        else:
            sorted_poses.append(replace(pose, stripes=stripes))
    return sorted_poses, assignment.pis


def _further_line(located: Sequence[LocatedPose], camera: Camera, rough: Array) -> list[Message]:
    """A note if one more light plane than promised is seen in most poses."""
    rest = [replace(pose, lines=pose.lines_left) for pose in located]
    assignment = assign_lines([pose.as_lines(camera) for pose in rest], 1, None, wider=(1.0,))
    for pi, which in zip(assignment.pis, assignment.which, strict=True):
        lines = [pose.lines[index] for pose, index in zip(rest, which, strict=True) if index != NOT_SEEN]
        rays = np.vstack([line.pivots for line in lines])
        apart = np.abs(rays @ (rough - pi).T) / np.abs(rays @ pi)[:, None]
        if 2 * len(lines) > sum(pose.used for pose in located) and np.median(apart, axis=0).min() > DISTINCT:
            return [note_of("fan.further_plane", n=len(lines), field=_LINES)]
    return []


def _check_spread(located: Sequence[LocatedPose], lines: int) -> None:
    """InputError if the stripes of a line lie along one straight line in space."""
    for line in range(lines):
        showing = [pose for pose in located if line in pose.stripes]
        ends = np.vstack([on_target(pose.stripes[line].pivots, pose.pose) for pose in showing])
        spread = np.linalg.svd(ends - ends.mean(axis=0), compute_uv=False)[1] / np.sqrt(len(ends))
        if spread < SMALLEST_SPREAD * ends[:, 2].mean():
            raise InputError(
                Message(
                    "fan.poses_alike",
                    "the poses are too alike: the stripes of fan line {line} on all of them lie within {spread:.1f} mm "
                    "(RMS) of one straight line, which does not determine its plane",
                    line=line + 1,
                    spread=spread,
                ),
                where=WHERE,
                todo=_missing_tilt([pose.stripes[line] for pose in showing], ends, spread),
            )


def _missing_tilt(stripes: Sequence[StripeLine], ends: Array, spread: float) -> Message:
    """Which tilt of the target, and how much more of it, would take stripes with these `ends` (2N, 3) off one line.

    `spread` in mm is how far they are off it now. A tilt about the axis across a stripe moves its ends in depth.
    """
    depth = float(ends[:, 2].mean())
    wanted = 2 * SMALLEST_SPREAD * depth  # twice what is just enough
    half = float(np.linalg.norm(ends[1::2] - ends[::2], axis=1).mean()) / 2
    tilts = [float(np.arcsin(min(value / half, 1.0))) for value in (spread, wanted)]
    upright = np.mean([abs(stripe.across[0]) for stripe in stripes]) < np.mean(
        [abs(stripe.across[1]) for stripe in stripes]
    )
    if tilts[1] > TILTS_OF_USE:
        return Message(
            "advice.other_distances",
            "move the target nearer or farther by {mm:.0f} mm between poses",
            mm=2 * (wanted - spread),
        )
    more = float(np.degrees(tilts[1] - tilts[0]))
    if upright:
        return Message(
            "advice.turn_target",
            "turn the target by {more:.0f}° more to the left and to the right, or move it nearer and farther by "
            "{mm:.0f} mm",
            more=more,
            mm=2 * (wanted - spread),
        )
    return Message(
        "advice.nod_target",
        "tilt the target by {more:.0f}° more forward and back, or move it nearer and farther by {mm:.0f} mm",
        more=more,
        mm=2 * (wanted - spread),
    )


def _check_bow(fit: Bundle, options: FanOptions) -> None:
    """InputError if the target comes out far more bowed than it was said that it may be, or than the camera saw it."""
    bow, flatness_mm = float(np.abs(fit.shape.values[:BOWS]).max()), options.target.flatness_sd_mm
    if options.bowed_shape is not None:
        _check_bow_against(options.bowed_shape, fit.shape)
        return
    if not flatness_mm or bow <= MOST_BOWED * flatness_mm:
        return
    raise InputError(
        Message(
            "fan.bow_beyond_flatness",
            "the plane target comes out bowed by {bow:.2f} mm at its edges, {times:.0f} times its flatness of "
            "{flatness:g} mm, stated or assumed: something else is wrong that looks like a bow, or it is not so flat",
            bow=bow,
            times=bow / flatness_mm,
            flatness=flatness_mm,
        ),
        where=WHERE,
        todo=Message(
            "advice.check_flatness",
            "check the target's size and {field}, and fix it to something flat",
            field=Field("plane_target.flatness_mm"),
        ),
    )


def _check_bow_against(seen: BoardShape, found: BoardShape) -> None:
    """InputError if the target is `found` bowed otherwise than the camera's views have `seen` it."""
    off = np.abs(found.values - seen.values)[:BOWS]
    if (off <= MOST_BOWED * np.hypot(seen.sd[:BOWS], BENDS_MM)).all():
        return
    raise InputError(
        Message(
            "fan.bow_not_as_camera",
            "the plane target comes out bowed by {found:.2f} mm, but the camera's views of the same target say "
            "{seen:.2f} mm",
            found=found.departure_mm,
            seen=seen.departure_mm,
        ),
        where=WHERE,
        todo=Message(
            "advice.same_target",
            "check that both steps used one target, fixed to something flat, and calibrate both on one day",
        ),
    )


def _plate(located: Sequence[LocatedPose], options: FanOptions) -> Plate | None:
    """The part of the target that points and stripes are on, if it may be bowed."""
    seen = options.bowed_shape
    if seen is not None:
        known = seen.covariance[:BOWS, :BOWS] + BENDS_MM**2 * np.eye(BOWS)
        return Plate(seen.board, seen.values[:BOWS], known)
    flatness_mm = options.target.flatness_sd_mm
    if not flatness_mm:
        return None
    used = [pose for pose in located if pose.used and pose.features.view is not None]
    points = [pose.features.view.points for pose in used if pose.features.view is not None]
    for pose in used:
        points += [pose.pose.inverse().apply(on_target(stripe.rays, pose.pose)) for stripe in pose.stripes.values()]
    return Plate.flat_within(Board.of(points), flatness_mm)


def _bundle_poses(located: Sequence[LocatedPose]) -> list[BundlePose]:
    """The poses that are used."""
    return [
        BundlePose(pose.features.view, pose.pose, pose.stripes)
        for pose in located
        if pose.used and pose.features.view is not None
    ]


def _solve_without_outlying_poses(
    planes: PlaneSet, located: list[LocatedPose], camera: Camera, plate: Plate | None
) -> tuple[list[LocatedPose], Bundle]:
    """The fit; poses far worse than the others are left out one by one, at most a third of them."""
    dispensable = sum(pose.used for pose in located) // 3
    while True:
        bundle = solve(planes, _bundle_poses(located), camera, plate=plate)
        used = [index for index, pose in enumerate(located) if pose.used]
        worst = int(np.argmax(bundle.pose_errors))
        times = float(bundle.pose_errors[worst] / np.median(bundle.pose_errors))
        trial = list(located)
        trial[used[worst]] = located[used[worst]].left_out(note_of("fan.outlying_pose", times=times))
        if dispensable == 0 or times < OUTLYING or not _seen_twice(trial, len(planes.pis)):
            return located, bundle
        located, dispensable, planes = trial, dispensable - 1, bundle.planes


def _seen_twice(located: Sequence[LocatedPose], lines: int) -> bool:
    """Whether every line is seen in two poses or more."""
    return all(sum(line in pose.stripes for pose in located) >= 2 for line in range(lines))


def _points_by_line(located: Sequence[LocatedPose], bundle: Bundle) -> list[Array]:
    """For each line all its points (n, 3) in mm on the adjusted poses."""
    lines: list[list[Array]] = [[] for _ in bundle.planes.pis]
    for pose, adjusted in zip((pose for pose in located if pose.used), bundle.poses, strict=True):
        for line, stripe in pose.stripes.items():
            lines[line].append(on_target(stripe.rays, adjusted, bundle.shape))
    return [np.vstack(points) for points in lines]
