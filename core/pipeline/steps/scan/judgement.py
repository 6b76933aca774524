"""What calibrations, and changes since then, do to a solved scan, and whether anything measured in it is proof."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from core.calibrate.change import P_TOLD, Change, Evidence, changes
from core.calibrate.deviations import UNEXPLAINED, Deviation
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.recording.features_file import read_poses
from core.files.results.planes_file import planes_id
from core.findings.proof import Doubt, ScanFacts, notes_of
from core.findings.table import note_of
from core.image.stripes.centreline import Centreline
from core.messages import Message
from core.pipeline.steps.scan.known_planes import told_of_boards
from core.pipeline.steps.workspace import Calibration, Workspace, planes_of
from core.progress import Progress, silent
from core.scan.bend_correction import reconstruct_twice
from core.scan.causes import compare_causes, note_on_causes
from core.scan.changed_section import Section, changed_section
from core.scan.common_errors import CommonErrors, solve_common
from core.scan.features.extraction import ScanFeatures
from core.scan.features.picture_faults import at_fault
from core.scan.first_cause import Causes, cause_first
from core.scan.known_planes.known_plane import KnownPlane
from core.scan.known_planes.plane_deviations import followed_by_planes, own_deviations
from core.scan.known_planes.points_on_planes import note_on_planes_alone
from core.scan.method import Method, ReconstructOptions
from core.scan.plane_check import PlaneCheck, check_by_planes
from core.scan.plane_points import with_plane_points
from core.scan.results import ScanResult
from core.scan.scan_evidence import scan_evidence


@dataclass(frozen=True, eq=False, slots=True)
class Solved:
    """Solved scan, with the features it was last solved from and the calibration it was solved with."""

    features: ScanFeatures
    scan: ScanResult
    calibration: Calibration
    """With the known planes that sweeps are tied to; where there is a fan, none are."""
    check: PlaneCheck | None = None
    """Of camera and fan by the known planes; None where there is no fan, or no plane."""
    notes: tuple[Message, ...] = ()
    """On the known planes."""
    disagreement: Message | None = None
    """The note among them that fan and known planes disagree, so that nothing measured is proof; None if not."""

    @property
    def checked(self) -> bool:
        """Whether known planes show that camera and fan were as calibrated in this very scan."""
        return self.check is not None and self.check.passed

    def evidence(self, deviations: Sequence[Deviation]) -> Evidence:
        """Compute what the scan's misclosures say about K deviations of camera and fan, as normal equations."""
        return scan_evidence(self.scan, self.calibration.camera.camera, self.calibration.control, deviations)


@dataclass(frozen=True, slots=True)
class SectionChange:
    """Change of the section of the fan's stripes since its calibration, with notes and the deviation it means.

    `surely` is None where it is not known. Notes and deviations are there only where it has surely changed.
    """

    surely: bool | None
    notes: tuple[Message, ...] = ()
    deviations: tuple[Deviation, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Judgement:
    """Judgement of a solved scan: its uncertainty, causes of misfit, and the facts that decide what it can prove.

    Parameters
    ----------
    change, section
        What may have changed since the calibration, of camera and fan and of the fan's light.
    common
        What displaced calibrations, and these changes, do to the scan.
    facts
        What decides whether anything measured in it can prove conformity.
    causes
        What explains most of what its crossings are off too much.
    likely
        The same in words; none where nothing is.
    """

    change: Change
    section: SectionChange
    common: CommonErrors
    facts: ScanFacts
    causes: Causes = ()
    likely: tuple[Message, ...] = ()

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on the most likely cause of misfit, on what has changed, and on why nothing measured is proof."""
        return (*self.likely, *self.change.notes, *self.section.notes, *notes_of(self.facts.doubts))


def solved_scan(
    features: ScanFeatures,
    calibration: Calibration,
    options: ReconstructOptions,
    progress: Progress,
    of_boards: Sequence[Message] = (),
) -> Solved:
    """Locate a scan's sweeps and triangulate its points, twice where its surface bends.

    Without a fan sweeps are tied to the known planes. Where there is one these check it, and move no value: a plane
    that it alone disagrees with is left out of that. `of_boards` are notes on the boards
    that were looked for.

    Raises
    ------
    InputError
        If it cannot be solved; what is wrong with its pictures is told first, what is wrong with its boards last.
    """
    planes = calibration.planes if options.method == Method.NETWORK else ()
    with told_of_boards(of_boards), cause_first(partial(at_fault, features.faults)):
        found = reconstruct_twice(features, calibration.camera.camera, calibration.fan.fan, options, progress, planes)
    solved = Solved(*found, calibration.with_planes(planes), notes=tuple(of_boards))
    return _checked_by_planes(solved) if calibration.fan.fan.lines else _tied_to_planes(solved)


def _tied_to_planes(solved: Solved) -> Solved:
    """Keep the known planes that sweeps without a fan are tied to, and tell how they agree."""
    planes, not_met = _met(solved.calibration.planes, solved.scan)
    notes = (*solved.notes, *not_met, note_on_planes_alone(solved.scan.planes))
    return replace(solved, calibration=solved.calibration.with_planes(planes), notes=notes)


def _checked_by_planes(solved: Solved) -> Solved:
    """Check the fan by the known planes of a scan that was solved with it alone, one that is off alone left out."""
    calibration, notes, check = solved.calibration, list(solved.notes), None
    planes = calibration.planes
    while planes:
        scan, control = with_plane_points(
            solved.scan, solved.features, calibration.camera.camera, calibration.with_planes(planes).control
        )
        solved = replace(solved, scan=replace(solved.scan, planes=scan.planes))
        planes, not_met = _met(planes, scan)
        notes.extend(not_met)
        if not planes:
            break
        check = _check(scan, calibration.with_planes(control.planes))
        off = None if check.agrees else check.alone_off
        notes.append(check.note)
        if off is None:
            break
        planes = tuple(one for one in planes if one.name != off.name)
    disagreement = None if check is None or check.agrees else check.note
    return replace(
        solved,
        calibration=calibration.with_planes(()),
        check=check,
        notes=tuple(notes),
        disagreement=disagreement,
    )


def _met(planes: Sequence[KnownPlane], scan: ScanResult) -> tuple[tuple[KnownPlane, ...], tuple[Message, ...]]:
    """Those of the known planes that sweeps of a scan meet, and notes on the others."""
    met = {one.name for one in scan.planes}
    return (
        tuple(one for one in planes if one.name in met),
        tuple(note_of("scan.board_not_met", board=one.name) for one in planes if one.name not in met),
    )


def _check(scan: ScanResult, calibration: Calibration) -> PlaneCheck:
    """Compare the fan with the known planes, all that their calibrations leave uncertain reckoned with."""
    camera, control, fan = calibration.camera.camera, calibration.control, calibration.fan
    usual = followed_by_planes(changes(camera, fan.fan), camera, control, fan.scale_sd)
    return check_by_planes(scan, camera, control, calibration.deviations, usual)


def judged_scan(
    solved: Solved,
    change_by: Callable[[Callable[[Sequence[Deviation]], Evidence]], Change],
    of_the_day: ScanFacts,
    section: SectionChange,
    method: Method = Method.NETWORK,
    progress: Progress = silent,
) -> Judgement:
    """Compute the uncertainty of a solved scan from calibration and later changes, and find the causes of its misfit.

    Parameters
    ----------
    solved, method
        The scan, and how its sweeps were located: only the network says anything of the calibrations.
    change_by
        Gives what has changed, by what the scan says of deviations, and all else that is known.
    of_the_day
        The facts of the planes' calibration, and of the day of the scan.
    section
        How the fan's light has changed.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        If the scan cannot be solved with a displaced calibration.
    """
    camera, control = solved.calibration.camera.camera, solved.calibration.control
    change = change_by(solved.evidence if method == Method.NETWORK else _nothing)
    own = own_deviations(camera, control, fan_has_scale=solved.calibration.fan.scale_sd > 0)
    deviations = (*change.deviations, *section.deviations, *own)
    common = solve_common(solved.scan, camera, control, deviations, method, progress)
    causes = _causes(solved, change) if method == Method.NETWORK else ()
    if solved.disagreement is not None:
        of_the_day = replace(of_the_day, of_the_day=(*of_the_day.of_the_day, Doubt.of(solved.disagreement)))
    facts = facts_of(of_the_day, change, section, solved.features.too_fine_for_mosaic, solved.scan)
    names = [frame.name for frame in solved.features.frames]
    likely = note_on_causes(causes, facts, solved.scan.movements, names)
    return Judgement(change, section, common, facts, causes, likely)


def _causes(solved: Solved, change: Change) -> Causes:
    """What explains most of what crossings are off too much; nothing is compared where nothing is too large."""
    if not solved.scan.needs_cause and change.p >= P_TOLD:
        return ()
    camera, fan, control = solved.calibration.camera, solved.calibration.fan, solved.calibration.control
    return compare_causes(
        solved.features,
        solved.scan,
        camera.camera,
        control.with_fan(replace(fan.fan, bends=fan.bends)),
        [one for one in solved.calibration.deviations if one.source != UNEXPLAINED],
        followed_by_planes(changes(camera.camera, fan.fan), camera.camera, control, fan.scale_sd),
    )


def _nothing(deviations: Sequence[Deviation]) -> Evidence:
    return Evidence.none(len(deviations))


def facts_of(
    of_the_day: ScanFacts,
    change: Change,
    section: SectionChange,
    too_fine_for_mosaic: bool | None,
    scan: ScanResult | None = None,
) -> ScanFacts:
    """Complete the facts that decide whether results can be proof by those of the change, the pictures and the scan.

    Without a `scan`, one picture was measured: within it nothing moves.
    """
    return replace(
        of_the_day,
        moved=False if scan is None else scan.moved,
        drifted=False if scan is None else scan.drifted,
        collapsed=scan is not None and scan.collapsed,
        fan_disagrees=scan is not None and scan.fan_disagrees,
        rig_changed=change.surely or (scan is not None and scan.rig_changed),
        rig_seems_changed=change.seemingly,
        section_changed=section.surely,
        too_fine_for_mosaic=too_fine_for_mosaic,
    )


@dataclass(frozen=True, eq=False, slots=True)
class StoredPoses:
    """Stored poses of a fan's calibration, () where none are stored, and a note if their file is damaged."""

    poses: tuple[PoseFeatures, ...] = ()
    notes: tuple[Message, ...] = ()

    @property
    def stripes(self) -> list[Sequence[Centreline]]:
        """Centrelines of the stripes on the plate, pose by pose."""
        return [pose.centrelines for pose in self.poses]


def stored_poses_of(work: Workspace, calibration: Calibration) -> StoredPoses:
    """Read the stored poses of the fan's calibration; for a re-adjusted fan those from before re-adjustment."""
    if not calibration.fan.fan.lines:
        return StoredPoses()
    try:
        return StoredPoses(read_poses(work.path("poses"), *_planes_of(calibration)))
    except InputError as error:  # a scan needs nothing of them
        return StoredPoses(notes=(error.message,))


def _planes_of(calibration: Calibration) -> Iterator[str]:
    """The id of the fan, and of each that it was re-adjusted from: a folder of results keeps the poses of the first."""
    yield planes_id(calibration.fan.fan)
    known = calibration.fan.readjusted
    while known is not None:
        yield planes_of(known.of)
        known = known.before


def section_since(
    calibration: Calibration, poses: Sequence[Sequence[Centreline]], fan: Sequence[Centreline]
) -> SectionChange:
    """Judge whether the skewness of the `fan`'s stripes in a scan has changed from that in its calibration's `poses`.

    A re-adjusted fan rests on stripes of the day, and where there is no fan nothing does: it has not.
    """
    if calibration.fan.readjusted is not None or not calibration.fan.fan.lines:
        return SectionChange(surely=False)
    camera, of = calibration.camera.camera, calibration.fan.fan
    found = changed_section(poses, fan, camera, of)
    if isinstance(found, Section):
        return SectionChange(surely=None if found is Section.NOT_KNOWN else False)
    return SectionChange(True, (found.note,), (found.deviation(fan, camera, of),))
