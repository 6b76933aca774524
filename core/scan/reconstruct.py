"""Features and model to surface points: number the fan's lines, solve the sweeps, triangulate, cut on σ.

No picture is needed here, so a scan can be solved again in a second with another camera, fan or method.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, OwnCause
from core.findings.table import note_of
from core.image.exclusion import MOVEMENTS
from core.messages import Command, Field, Message, plural_message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.progress import Progress, StepProgress, silent
from core.scan.between_frames import Between, between, merged_movements
from core.scan.causes import causes_of_light
from core.scan.exposure_blur import exposure_blurs, notes_on_blur
from core.scan.fan_watch import LEAST_FRAMES, WARM_UP, FanRest, watch_fan
from core.scan.features.crossings import CrossingTable
from core.scan.features.extraction import ScanFeatures
from core.scan.features.frames import CrossingUse
from core.scan.features.overexposure import ADVICE, overexposed
from core.scan.first_cause import Reason, Suspect, cause_first
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.known_planes.points_on_planes import frames_across
from core.scan.method import Method, ReconstructOptions
from core.scan.network.datum import Datum, datum_of, free_directions, main_plane, note_on_datum, relief_mm
from core.scan.network.fan_speckle import FanSpeckle, fan_speckle
from core.scan.network.read_out import AT_ONCE, ReadOut
from core.scan.plane_points import agreements, firm_points
from core.scan.print_on_boards import printed_on_boards
from core.scan.records import frame_records, reasons_of
from core.scan.results import ScanResult
from core.scan.single_change import AS_CALIBRATED, Explanation, explain_by_change
from core.scan.standstill import HOLD_STILL, LEAST_SWEEPS, largest_rigid_interval
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.triangulate import OwnLine, join, triangulate
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines
from core.scan.sweeps.ghosts import NO_BOUNCES, SecondBounces, find_second_bounces
from core.scan.sweeps.locate import (
    LocatedSweeps,
    by_sweep,
    locate_each,
    locate_together,
    number_fan_lines,
    numbered,
)
from core.scan.sweeps.moving import hand_notes, read_out_of

MANY_LOST = 0.1
"""Share of the points that are lost to a moving hand from which on it is told."""

FAN_SAMPLE = 2000
"""Points of the fan that tell its relief as well as all of them."""

NEAREST_SHARE, FARTHEST_SHARE = 0.6, 1.5
"""Of the nearest and the farthest depth at which the fan sees the object: points beyond are reflections."""


FLAT = 0.98
"""Share of the fan's light on one plane from which on a scene is flat: there the planes may fall together, and the
points are right all the same."""
TILT_MORE = Message(
    "scan.advice_tilt_more",
    "move and tilt the hand-held laser more between frames, and cross the fan on object and table; spray shiny sides "
    "that mirror it matt",
)


LOCATE_BETTER = Message(
    "scan.advice_locate_better",
    "cross more of the fan with each sweep and tilt the laser between sweeps, check {field}, or raise the σ "
    "cut{command}",
    field=Field("laser_fan.lines"),
    command=Command("--sigma-cut MM"),
)
ADD_BOARDS = Message(
    "scan.advice_lay_boards",
    "let each sweep cross two boards at an angle, with pictures of them in scan/planes, or use a fan",
)

LARGER_FIELDS = Message(
    "scan.advice_larger_fields",
    "use boards with larger plain fields, such as printed rectangles, take larger pictures, or use a fan",
)


def reconstruct(
    features: ScanFeatures,
    camera: Camera,
    fan: Fan,
    options: ReconstructOptions | None = None,
    progress: Progress = silent,
    fan_lines: FanLines | None = None,
    planes: Sequence[KnownPlane] = (),
) -> ScanResult:
    """Locate the sweeps of a scan and triangulate its points; `fan_lines` is a numbering of the fan known before.

    Sweeps are tied to known `planes` where there is no fan; beside one these only tell print from light.

    Raises
    ------
    InputError
        If no sweep crosses the fan and known planes do not suffice, the sweeps' planes fall together over relief, or no
        point is left.
    """
    options = options or ReconstructOptions()
    progress = reported = StepProgress(progress)
    progress("network", 0, 3)
    printed = printed_on_boards(features.fan, planes, fan, camera)
    lines = fan_lines or number_fan_lines(features.fan, features.crossings, camera, fan, reported.within_step, printed)
    crossings, line = numbered(features.crossings, lines)
    too_bright = overexposed(features.fan, [piece for frame in features.frames for piece in frame.centrelines])
    control = Control(fan)
    if not fan.lines:
        points = firm_points(features, planes if _together(options) else (), crossings, camera)
        if not points.planes:
            raise _refused(too_bright, *_why_none_met(points.seen, frames_across(features, planes)))
        control = Control(fan, points.planes)
        crossings, line = points.added_to(crossings, line, fan.lines)
        _require_planes(crossings, line, control, camera)
    if not np.any(crossings.with_fan):
        raise _refused(
            too_bright,
            Message(
                "scan.no_crossing",
                "no sweep crosses the fan in any frame, so nothing says where the hand-held laser was",
            ),
            Message(
                "scan.advice_cross_the_fan",
                "sweep the single line across the fan's lines, and check that the fan was on",
            ),
        )
    names = [frame.name for frame in features.frames]
    watched = watch_fan(features, lines, camera, fan, printed)
    _require_rest(features, watched)
    among, unrest = (crossings, line), partial(_unrest, watched, names)
    shares = partial(causes_of_light, features, watched.movements, printed)
    bounces = NO_BOUNCES
    if _together(options) and not watched.unsteady:  # the fan's light, moved, would be taken for a bounce
        bounces = find_second_bounces(features.frames, among, camera, control)
    kept = watched.at_rest[crossings.a] & (crossings.with_fan | watched.at_rest[crossings.b])
    kept &= ~bounces.among(crossings)
    with cause_first(unrest, shares):
        solved = _solve(options, among, kept, camera, control, names, watched, reported.within_step)
        sweeps = solved.sweeps
        if sweeps.collapsed and not _flat(features, lines, camera, fan):
            raise _refused(too_bright, note_of("scan.collapsed_in_spite_of_relief"), TILT_MORE)
    reasons = np.where(bounces.among(crossings), CrossingUse.SECOND_BOUNCE, solved.reasons)
    progress("network", 1, 3)
    found = join(_fan_clouds(features, lines, camera, fan) + _sweep_clouds(features, sweeps, camera, bounces))
    cloud = _cut(found, options.sigma_cut_mm)
    progress("network", 2, 3)
    changed = () if solved.explanation is None else (solved.explanation,)
    with cause_first(
        lambda: (*unrest(), *map(_changed, changed)), lambda: (*shares(), *(one.cause for one in changed))
    ):
        if not np.any(cloud.sweep >= 0):
            raise _refused(too_bright, _no_points(options.sigma_cut_mm, () if changed else sweeps.notes), LOCATE_BETTER)
    met = ~crossings.on_plane
    of_met = crossings.select(met), line[met], reasons[met]
    records = bounces.counted(frame_records(features, *of_met, sweeps.frames, cloud, camera))
    sheets = dict(zip(sweeps.frames.tolist(), sweeps.middle_planes[0], strict=True))
    progress("network", 3, 3)
    result = ScanResult(
        cloud=cloud,
        pis=sweeps.pis,
        covariance=sweeps.covariance,
        sweep_frames=sweeps.frames,
        frames=records,
        crossings=crossings,
        crossing_weights=solved.weights,
        fan_lines=lines,
        scale=sweeps.scale,
        notes=bounces.notes
        + _ordered(features.notes + features.faults, solved)
        + _datum_notes(solved.datum, found, camera, has_fan=fan.lines > 0)
        + (() if too_bright is None else (too_bright,))
        + notes_on_blur(exposure_blurs(features.frames, sheets, cloud, camera))
        + _unsure(found, cloud, solved, options)
        + _fan_notes(lines, printed),
        datum=solved.datum,
        speckle=_speckle(features, lines, sweeps, camera, fan) if _together(options) else None,
        crossing_reasons=reasons,
        read_out=solved.read_out,
        moved=solved.moved or _left_out(features) >= LEAST_FRAMES or (None if solved.moved is None else False),
        second_bounces=bounces,
        drifted=_drifted(watched, solved, has_fan=fan.lines > 0),
        collapsed=sweeps.collapsed,
        fan_disagrees=solved.fan_disagrees,
        rig_changed=solved.explanation is not None,
        unsure_share=_unsure_share(found, cloud),
        movements=merged_movements(watched.movements, solved.movements),
        rig_explained=None if solved.explanation is None else solved.explanation.share,
        rows_seen_to_roll=solved.read_out.moves and options.row_time_us is None,
        crossing_lines=line,
        printed=printed,
    )
    return replace(result, planes=agreements(result, camera, control)) if control.planes else result


def _drifted(watched: FanRest, solved: _Solved, *, has_fan: bool) -> bool | None:
    """Whether the rig drifted; without a fan to watch, a drift would make crossings disagree as a movement does."""
    if has_fan:
        return watched.drifts if watched.known else None
    return False if solved.moved is False else None


def _require_planes(crossings: CrossingTable, line: NDArray[np.int64], control: Control, camera: Camera) -> None:
    """InputError if known planes alone leave the sweeps' light planes free."""
    on_plane = crossings.on_plane
    rays = camera.rays(crossings.uv[on_plane])
    pis = control.pis_at(line[on_plane], rays)
    free = free_directions(rays, np.einsum("mi,mi->m", rays, pis))
    if not free:
        return
    what = plural_message(
        "scan.planes_leave_free",
        "one plane leaves {free} of 3 directions of every sweep's light plane free",
        "{n} planes that lie in one leave {free} of 3 directions of every sweep's light plane free",
        n=len(control.planes),
        free=free,
    )
    todo = Message("scan.advice_second_plane", "add a second one at an angle, or the fan")
    raise InputError(what, where="scan", todo=todo)


def _why_none_met(points: int, across: int) -> tuple[Message, Message]:
    """Why no known plane ties a sweep, and what to do.

    By so many `points` on them, and so many frames whose light goes `across` them.
    """
    if points:
        what = Message(
            "scan.planes_met_along_one_line",
            "there is no fan, and each sweep meets known planes along one straight line only, about which it may turn",
        )
        return what, ADD_BOARDS
    if across:
        what = plural_message(
            "scan.light_on_print",
            "there is no fan, and in {n} frame whose sweep crosses a known plane its light lies on print, which would "
            "draw it aside",
            "there is no fan, and in all {n} frames whose sweep crosses a known plane its light lies on print, which "
            "would draw it aside",
            n=across,
        )
        return what, LARGER_FIELDS
    what = Message(
        "scan.no_known_plane",
        "there is no fan, and no sweep is seen on a known plane, so nothing says where the hand-held laser was",
    )
    return what, ADD_BOARDS


def _refused(too_bright: Message | None, what: Message, todo: Message) -> InputError:
    """That no scan comes of it: because its stripes are overexposed, where they are, else for `what` came of that."""
    if too_bright is not None:
        return InputError(too_bright, where="scan", todo=ADVICE)
    return InputError(what, where="scan", todo=todo)


def _unrest(watched: FanRest, names: Sequence[str]) -> Iterator[Reason]:
    """The rig's drift, or what moved, as the reason of a complaint about sweeps that do not fit together."""
    if watched.drifts:
        yield Reason(
            Suspect.DRIFTED,
            lambda reason: Message(
                "scan.drifted_too_much",
                "the rig drifted: from the first frame to the last the fan's light moved evenly, by {shift_px:.2g} px; "
                "of what was measured so: {reason}",
                shift_px=watched.shift_px,
                reason=reason,
            ),
            WARM_UP,
            of_own=True,
            kind=OwnCause,
        )
    if watched.movements:
        yield Reason(
            Suspect.MOVED,
            lambda reason: Message(
                "scan.moved_and_not_solved",
                "by the fan's light, {what} moved {when:and}, by {shift_px:.2g} px; of the frames without it: {reason}",
                what=watched.what_moved,
                when=between(names, watched.movements),
                shift_px=watched.shift_px,
                reason=reason,
            ),
            HOLD_STILL,
            kind=OwnCause,
        )


def _changed(explanation: Explanation) -> Reason:
    """A change of the rig as the reason of a complaint about sweeps that do not fit together."""
    return Reason(
        Suspect.RIG_CHANGED,
        lambda reason: Message(
            "scan.changed_and_not_solved",
            "camera or laser are not as calibrated (what would explain it: {changes:;}); of what was measured so: "
            "{reason}",
            changes=tuple(one.message for one in explanation.changes),
            reason=reason,
        ),
        AS_CALIBRATED,
        kind=OwnCause,
    )


def _datum_notes(datum: Datum | None, found: Cloud, camera: Camera, *, has_fan: bool) -> tuple[Message, ...]:
    """What fixes the scale, or is missing, by what the fan's own points of all that was `found` show."""
    if datum is None:
        return ()
    if not has_fan:
        return (note_on_datum(datum, None),)
    own = np.flatnonzero(found.sweep <= FAN)
    own = own[:: max(1, len(own) // FAN_SAMPLE)]
    relief = relief_mm(camera.rays(found.uv[own]), 1 / found.points[own, 2]) if len(own) else 0.0
    return (note_on_datum(datum, relief),)


def _together(options: ReconstructOptions) -> bool:
    return options.method == Method.NETWORK


@dataclass(frozen=True, eq=False, slots=True)
class _Solved:
    """Solved sweeps; weight and reason (M,) of every crossing, those of other frames included."""

    sweeps: LocatedSweeps
    weights: Array
    reasons: NDArray[np.int64]
    notes: tuple[Message, ...]
    datum: Datum | None = None
    read_out: ReadOut = AT_ONCE
    moved: bool | None = None
    fan_disagrees: bool = False
    explanation: Explanation | None = None
    movements: tuple[Between, ...] = ()


def _solve(
    options: ReconstructOptions,
    numbered_crossings: tuple[CrossingTable, NDArray[np.int64]],
    kept: NDArray[np.bool_],
    camera: Camera,
    control: Control,
    names: Sequence[str],
    watched: FanRest,
    progress: Progress,
) -> _Solved:
    crossings, line = numbered_crossings
    kept = kept.copy()
    if not _together(options):
        sweeps = locate_each(crossings.select(kept), line[kept], camera, control.fan, progress)
        weights = np.zeros(len(crossings))
        weights[kept] = sweeps.weights
        located = np.isin(crossings.a, sweeps.frames) & crossings.with_fan
        reasons = reasons_of(crossings.with_fan, weights, kept, located)
        notes = watched.note(names, len(sweeps.frames)) + sweeps.notes
        moved = bool(watched.movements) if watched.known else None
        return _Solved(sweeps, weights, reasons, notes, moved=moved)
    among, of_among = crossings.select(kept), line[kept]
    read_out = read_out_of(among, of_among, camera, control, options.row_time_us, progress)
    explanation = None
    if read_out.shifts_mm and options.row_time_us is None:  # what another change of the rig does looks like that, too
        explanation = explain_by_change(among, of_among, camera, control, progress)
        read_out = AT_ONCE if explanation is not None else read_out
    part = largest_rigid_interval(among, of_among, camera, control, names, progress, read_out)

    def locate(used: NDArray[np.bool_]) -> tuple[LocatedSweeps, tuple[Message, ...]]:
        some = among.select(used)
        sweeps = locate_together(some, of_among[used], camera, control, progress, read_out)
        return sweeps, hand_notes(sweeps, some, camera, read_out, stated=options.row_time_us is not None)

    used = part.kept
    sweeps, of_hand = locate(used)
    explained = bool(watched.unsteady or of_hand or sweeps.collapsed)
    denied = not watched.possible(part.movements)  # whatever crossings would gain by a movement
    if explanation is None and denied and not explained and (sweeps.fan_silenced or sweeps.judged):
        explanation = explain_by_change(among.select(used), of_among[used], camera, control, progress)
    movements = () if denied and explanation is not None else part.movements
    if part.movements and not movements:  # the change looked like a movement: all frames are as good
        used = np.ones_like(used)
        sweeps, of_hand = locate(used)
    kept[kept] = used
    weights = np.zeros(len(crossings))
    weights[kept] = sweeps.weights
    middle, covariance = sweeps.middle_planes
    explained = explained or bool(movements)
    moved = bool(movements) and not watched.drifts  # a drift makes crossings disagree, too
    judged = sweeps.notes + (() if explained or sweeps.fan_silenced else sweeps.judged)
    datum = datum_of(middle, covariance, by_sweep(among.select(used), sweeps.frames), camera)
    return _Solved(
        sweeps,
        weights,
        reasons_of(crossings.with_fan, weights, kept, np.ones(len(crossings), dtype=np.bool_)),
        (watched.note(names, len(sweeps.frames)) if control.fan.lines else ())
        + (part.note(names, len(sweeps.frames)) if moved else ())
        + of_hand
        + (judged if explanation is None else (explanation.note,)),
        datum,
        read_out,
        bool(watched.movements or moved) if watched.known or part.known else None,
        explanation is None and (sweeps.fan_silenced or (sweeps.off_fan and not explained)),
        explanation,
        movements if moved else (),
    )


def _fan_clouds(features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan) -> list[Cloud]:
    """The fan's own points: measured directly, on every line, at every height."""
    return [
        triangulate(piece, fan.planes[line].pi, np.zeros((3, 3)), camera, -1, FAN - line)
        for piece, line in zip(features.fan, lines.line, strict=True)
        if line != UNASSIGNED
    ]


def _flat(features: ScanFeatures, lines: FanLines, camera: Camera, fan: Fan) -> bool:
    """Whether the fan's light lies on one plane, or known planes do without it: these are not one plane."""
    if not fan.lines:
        return False
    numbered_pieces = [(p, k) for p, k in zip(features.fan, lines.line, strict=True) if k != UNASSIGNED]
    rays = [camera.rays(piece.uv[::4]) for piece, _ in numbered_pieces]
    inverse_depths = [r @ fan.planes[k].pi for r, (_, k) in zip(rays, numbered_pieces, strict=True)]
    _, on_plane = main_plane(np.concatenate(rays), np.concatenate(inverse_depths))
    return bool(np.mean(on_plane) > FLAT)


def _speckle(features: ScanFeatures, lines: FanLines, sweeps: LocatedSweeps, camera: Camera, fan: Fan) -> FanSpeckle:
    """Compute the errors common to the fan's own points and the sweeps."""
    planes = [None if line == UNASSIGNED else fan.planes[line] for line in lines.line]
    cell_px = features.crossings.half_length_px
    return fan_speckle(features.fan, planes, camera, cell_px, sweeps.fan_cells, sweeps.fan_covariance)


def _sweep_clouds(features: ScanFeatures, sweeps: LocatedSweeps, camera: Camera, bounces: SecondBounces) -> list[Cloud]:
    clouds: list[Cloud] = []
    cell_px, size = features.crossings.half_length_px, sweeps.pis.shape[1]
    for sweep, frame in enumerate(sweeps.frames):
        block = slice(size * sweep, size * sweep + size)
        mine = sweeps.line_cells[:, 0] == sweep
        cells, covariance = sweeps.line_cells[mine, 1:], sweeps.line_covariance[mine]
        for number, piece in enumerate(features.frames[frame].centrelines):
            if (frame, number) in bounces:
                continue
            own = OwnLine(_by_cell(cells[:, 0] == number, cells[:, 1], covariance), cell_px)
            clouds.append(
                triangulate(piece, sweeps.pis[sweep], sweeps.covariance[block, block], camera, int(frame), sweep, own)
            )
    return clouds


def _by_cell(mine: NDArray[np.bool_], cell: NDArray[np.int64], covariance: Array) -> Array:
    """Rows of `covariance` (Q, 3) that are `mine` (Q,) in the order of their cells from 0, zero where there is none."""
    ordered = np.zeros((int(cell[mine].max(initial=-1)) + 1, covariance.shape[1]))
    known = mine & (cell >= 0)
    ordered[cell[known]] = covariance[known]
    return ordered


def _cut(cloud: Cloud, sigma_cut_mm: float) -> Cloud:
    """Select points that are known well enough and lie at depths where the fan sees the object."""
    depth = cloud.points[:, 2]
    own = depth[cloud.sweep <= FAN]
    near, far = (NEAREST_SHARE * own.min(), FARTHEST_SHARE * own.max()) if len(own) else (0.0, np.inf)
    return cloud.select((cloud.sigma <= sigma_cut_mm) & (depth > near) & (depth < far))


def _ordered(of_features: tuple[Message, ...], solved: _Solved) -> tuple[Message, ...]:
    """What moved comes first."""
    return solved.notes + of_features if solved.moved else of_features + solved.notes


def _left_out(features: ScanFeatures) -> int:
    """How many frames show the fan's light elsewhere, or not at all."""
    return sum(frame.exclusion in MOVEMENTS for frame in features.frames)


def _require_rest(features: ScanFeatures, watched: FanRest) -> None:
    """InputError if something moved and too few frames are left between which nothing did."""
    left = [frame for frame in features.frames if frame.centrelines and watched.at_rest[frame.index]]
    moved = [frame for frame in features.frames if frame.exclusion in MOVEMENTS or not watched.at_rest[frame.index]]
    if len(left) >= LEAST_SWEEPS or len(moved) < LEAST_FRAMES:
        return
    raise OwnCause(
        Message(
            "scan.moved_too_early",
            "object, table or camera moved during the scan, the first frame after it is {name}, and only {n} frames "
            "with a stripe agree with the reference",
            name=moved[0].name,
            n=len(left),
        ),
        where="scan",
        todo=HOLD_STILL,
    )


def _unsure(found: Cloud, cloud: Cloud, solved: _Solved, options: ReconstructOptions) -> tuple[Message, ...]:
    """A note if many points of a moving hand are too unsure to be used."""
    share = _unsure_share(found, cloud)
    if not solved.read_out.shifts_mm or share <= MANY_LOST:
        return ()
    return (note_of("scan.points_unsure_by_motion", percent=100 * share, cut_mm=options.sigma_cut_mm),)


def _unsure_share(found: Cloud, cloud: Cloud) -> float:
    """Share of the sweeps' points in `found` that are not in what is left of it, `cloud`."""
    swept, left = (int(np.count_nonzero(one.sweep >= 0)) for one in (found, cloud))
    return 1 - left / max(swept, 1)


def _no_points(sigma_cut_mm: float, notes: tuple[Message, ...]) -> Message:
    if not notes:
        return Message("scan.no_points", "no point of any sweep is known to {cut_mm} mm", cut_mm=sigma_cut_mm)
    return Message(
        "scan.no_points_because",
        "no point of any sweep is known to {cut_mm} mm ({reasons:;})",
        cut_mm=sigma_cut_mm,
        reasons=notes,
    )


def _fan_notes(lines: FanLines, printed: NDArray[np.bool_]) -> tuple[Message, ...]:
    """A note on light of the fan that is not used; print on boards is none."""
    reasons = zip(lines.reason, printed, strict=True)
    left_out = [reason for reason, is_print in reasons if reason is not None and not is_print]
    if not left_out:
        return ()
    return (note_of("scan.fan_light_unused", n=len(left_out), reason=left_out[0]),)
