"""What decides whether anything measured in a scan can prove conformity, however small its uncertainty.

Facts are fields: steps fill them, files keep them, and verdicts are made of them alone; no note is read back. A fact
that a file does not hold is not known, and what is not known proves nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from core.messages import Field, Message

MOVED_WITHIN = Message(
    "inspection.moved_during_scan", "Something moved during the scan: nothing measured proves conformity."
)
DRIFTED_WITHIN = Message(
    "inspection.drifted_during_scan", "The rig drifted during the scan: nothing measured proves conformity."
)
COLLAPSED = Message(
    "inspection.planes_collapsed",
    "The sweeps' light planes have fallen together into one: nothing measured proves conformity.",
)
CHANGED = Message(
    "inspection.rig_has_changed",
    "Laser or camera have surely changed since they were calibrated: nothing measured proves conformity.",
)
MAY_HAVE_CHANGED = Message(
    "inspection.rig_may_have_changed",
    "Laser or camera seem to have changed since they were calibrated, and no check of the day is in order: nothing "
    "measured proves conformity. Check with one to three pictures of the plane target in the fan.",
)
SECTION_CHANGED = Message(
    "inspection.section_has_changed",
    "The light of the fan reaches further to one side than when it was calibrated: nothing measured proves conformity.",
)
SIZE_UNCONFIRMED = Message(
    "target.size_unconfirmed",
    "The size of the plane target, on which every length rests, is neither stated ({field}) nor confirmed, so that "
    "only what is compared with a master proves anything: state its standard uncertainty by its source, measure a "
    "known artefact, or take a picture of it fixed to the camera's target whose own size is stated.",
    field=Field("plane_target.scale_sd", whole=True),
)
UNSETTLED = Message(
    "validity.planes_not_settled",
    "The calibration of the laser planes had not settled: nothing measured proves conformity. Record more poses of the "
    "target, at different distances and tilts, and calibrate again.",
)
POINTS_UNCONFIRMED = Message(
    "validity.target_points_off",
    "In all poses of the laser planes' calibration the target's points lie off alike, which U need not contain: "
    "nothing measured proves conformity. Calibrate again with a true target and camera, or measure a known artefact.",
)
PLANES_UNKNOWN = Message(
    "validity.planes_unknown",
    "The file of the laser planes' calibration, of another program or an earlier version, does not say whether it had "
    "settled and fitted its target: nothing measured proves conformity. Calibrate the laser planes again.",
)
SCAN_UNKNOWN = Message(
    "validity.scan_unknown",
    "The file of the scan, of another program or an earlier version, does not say whether anything moved or changed: "
    "nothing measured proves conformity. Measure the scan again.",
)


@dataclass(frozen=True, slots=True)
class ScanFacts:
    """Facts of a scan, and of the calibrations that it rests on, each of which takes away every proof where it holds.

    Parameters
    ----------
    moved, drifted
        Whether part, table or camera moved within the scan, or the rig evenly from its first frame to its last.
    collapsed
        Whether the sweeps' light planes have fallen together into one.
    rig_changed, rig_seems_changed
        Whether camera or laser surely differ from their calibration; whether they seem to, and no check of the day is
        in order.
    section_changed
        Whether the fan's light is skewed otherwise than in its calibration.
    planes_unsettled, points_off_alike
        Whether the planes' calibration was not solved to its end, and whether its target's points lie off alike in all
        poses and no artefact holds what that may do.
    size_unconfirmed
        Whether the plane target's size is neither stated nor confirmed; it cancels in the comparison with a master.
    of_the_day
        Why calibration or check did not hold on the day of the scan.

    Each but the last is None where it is not known.
    """

    moved: bool | None = None
    drifted: bool | None = None
    collapsed: bool | None = None
    rig_changed: bool | None = None
    rig_seems_changed: bool | None = None
    section_changed: bool | None = None
    planes_unsettled: bool | None = None
    points_off_alike: bool | None = None
    size_unconfirmed: bool | None = None
    of_the_day: tuple[Message, ...] = ()

    @property
    def doubts(self) -> tuple[Message, ...]:
        """Why nothing measured proves conformity, but for the target's size; () where nothing speaks against it.

        Examples
        --------
        >>> nothing = dict.fromkeys([*OF_SCAN, *OF_PLANES], False)
        >>> ScanFacts(**nothing).doubts, ScanFacts(**{**nothing, "moved": True}).doubts == (MOVED_WITHIN,)
        ((), True)
        >>> ScanFacts().doubts == (SCAN_UNKNOWN, PLANES_UNKNOWN)
        True
        """
        return (*self._held(OF_SCAN, SCAN_UNKNOWN), *self.of_the_day, *self._held(OF_PLANES, PLANES_UNKNOWN))

    @property
    def all_doubts(self) -> tuple[Message, ...]:
        """The same with that of the size, which is unconfirmed where it is not known."""
        return self.doubts if self.size_unconfirmed is False else (*self.doubts, SIZE_UNCONFIRMED)

    def _held(self, rows: Mapping[str, Message], unknown: Message) -> tuple[Message, ...]:
        """The doubts of those facts that hold, and `unknown` where one of them is not known."""
        facts = {name: getattr(self, name) for name in rows}
        holding = tuple(doubt for name, doubt in rows.items() if facts[name])
        return (*holding, unknown) if None in facts.values() else holding


OF_SCAN: Mapping[str, Message] = {
    "moved": MOVED_WITHIN,
    "drifted": DRIFTED_WITHIN,
    "collapsed": COLLAPSED,
    "rig_changed": CHANGED,
    "rig_seems_changed": MAY_HAVE_CHANGED,
    "section_changed": SECTION_CHANGED,
}
"""Why nothing is proven where a fact of the scan holds, by its name, in the order in which they are said."""
OF_PLANES: Mapping[str, Message] = {"planes_unsettled": UNSETTLED, "points_off_alike": POINTS_UNCONFIRMED}
"""The same of the planes' calibration."""
