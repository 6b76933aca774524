"""Findings that say why nothing proves conformity: one for each fact that takes away every proof."""

from __future__ import annotations

from collections.abc import Mapping

from core.findings.finding import Effect, Finding, Weight
from core.messages import Message

SCAN = (
    Finding("inspection.moved_during_scan", Weight.GRAVE, Effect.NO_PROOF,
            "Something moved during the scan: nothing measured proves conformity.", fact="moved"),
    Finding("inspection.drifted_during_scan", Weight.GRAVE, Effect.NO_PROOF,
            "The rig drifted during the scan: nothing measured proves conformity.", fact="drifted"),
    Finding("inspection.planes_collapsed", Weight.GRAVE, Effect.NO_PROOF,
            "The sweeps' light planes have fallen together into one: nothing measured proves conformity.",
            fact="collapsed"),
    Finding("inspection.fan_disagrees", Weight.GRAVE, Effect.NO_PROOF,
            "Sweeps and fan disagree by more than U need contain: nothing measured proves conformity.",
            fact="fan_disagrees"),
    Finding("inspection.rig_has_changed", Weight.GRAVE, Effect.NO_PROOF,
            "Laser or camera have surely changed since they were calibrated: nothing measured proves conformity.",
            fact="rig_changed"),
    Finding("inspection.rig_may_have_changed", Weight.GRAVE, Effect.NO_PROOF,
            "Laser or camera seem to have changed since they were calibrated, and no check of the day is in order: "
            "nothing measured proves conformity. Check with one to three pictures of the plane target in the fan.",
            fact="rig_seems_changed"),
    Finding("inspection.section_has_changed", Weight.GRAVE, Effect.NO_PROOF,
            "The light of the fan reaches further to one side than when it was calibrated: nothing measured proves "
            "conformity.", fact="section_changed"),
    Finding("inspection.too_fine_for_mosaic", Weight.GRAVE, Effect.NO_PROOF,
            "The stripes are too fine for the tiles of the colour camera's mosaic, which draws them aside by more than "
            "U need contain: nothing measured proves conformity.", fact="too_fine_for_mosaic"),
)  # fmt: skip
"""Why nothing is proven where a fact of the scan holds, in the order in which it is said."""
PLANES = (
    Finding("validity.camera_not_settled", Weight.GRAVE, Effect.NO_PROOF,
            "The calibration of the camera had not settled: nothing measured proves conformity. Take more views of the "
            "target, tilted in different directions, and calibrate again.", fact="camera_unsettled"),
    Finding("validity.planes_not_settled", Weight.GRAVE, Effect.NO_PROOF,
            "The calibration of the laser planes had not settled: nothing measured proves conformity. Record more "
            "poses of the target, at different distances and tilts, and calibrate again.", fact="planes_unsettled"),
    Finding("validity.target_points_off", Weight.GRAVE, Effect.NO_PROOF,
            "In all poses of the laser planes' calibration the target's points lie off alike, which U need not "
            "contain: nothing measured proves conformity. Calibrate again with a true target and camera, or measure "
            "a known artefact.", fact="points_off_alike"),
)  # fmt: skip
"""The same of the calibrations of camera and planes."""
OTHERS = (
    Finding("target.size_unconfirmed", Weight.GRAVE, Effect.NO_PROOF,
            "The size of the plane target, on which every length rests, is neither stated ({field}) nor confirmed, "
            "so that only what is compared with a master proves anything: state its standard uncertainty by its "
            "source, measure a known artefact, or take a picture of it fixed to the camera's target whose own size "
            "is stated.", fact="size_unconfirmed"),
    Finding("validity.scan_unknown", Weight.GRAVE, Effect.NO_PROOF,
            "The file of the scan, of another program or an earlier version, does not say whether anything moved or "
            "changed, or whether the stripes are too fine for a colour mosaic, its frames are too few to tell, or the "
            "stripes of the laser planes' calibration are not kept or too short to show it: nothing measured proves "
            "conformity. Measure the scan again, with more frames, or first calibrate the laser planes again.",
            fact="scan_unknown"),
    Finding("validity.planes_unknown", Weight.GRAVE, Effect.NO_PROOF,
            "The file of the camera's or the laser planes' calibration, of another program or an earlier version, does "
            "not say whether it had settled and fitted its target, or not all that U is made of, or the planes' poses "
            "are too few to tell: nothing measured proves conformity. Calibrate again, the laser planes with eight "
            "poses or more.",
            fact="planes_unknown"),
)  # fmt: skip
"""That of the size, which a comparison with a master does not need, and of what a file does not say."""
ROWS = (*SCAN, *PLANES, *OTHERS)
DAY = "of_the_day"
"""Stands for what did not hold on the day of a scan whose file, of an earlier version, has the words of it alone."""
UNNAMED = "unnamed"
"""Stands for the doubts of a result whose file, of an earlier version, says only that there are some."""
REASONS: Mapping[str, Message] = {
    "moved": Message("doubt.moved", "something moved during the scan"),
    "drifted": Message("doubt.drifted", "the rig drifted during the scan"),
    "collapsed": Message("doubt.collapsed", "the sweeps' light planes have fallen together"),
    "fan_disagrees": Message("doubt.fan_disagrees", "sweeps and fan disagree"),
    "rig_changed": Message("doubt.rig_changed", "camera or laser have changed"),
    "rig_seems_changed": Message("doubt.rig_seems_changed", "camera or laser seem to have changed"),
    "section_changed": Message("doubt.section_changed", "the fan's light is skewed otherwise than when calibrated"),
    "too_fine_for_mosaic": Message(
        "doubt.too_fine_for_mosaic", "the stripes are too fine for the camera's colour mosaic"
    ),
    "scan_unknown": Message(
        "doubt.scan_unknown",
        "it is not known whether anything moved or changed, or the stripes are too fine for a colour mosaic",
    ),
    DAY: Message("doubt.of_the_day", "calibration or check did not hold on the day"),
    "calibration_undated": Message("doubt.calibration_undated", "it is not known when the rig was calibrated"),
    "calibration_lapsed": Message("doubt.calibration_lapsed", "the calibration was too old"),
    "never_checked": Message("doubt.never_checked", "camera and laser were never checked"),
    "check_lapsed": Message("doubt.check_lapsed", "the check of camera and laser was too old"),
    "planes_disagree": Message("doubt.planes_disagree", "fan and known planes disagree"),
    "check_failed": Message("doubt.check_failed", "the check of camera and laser failed"),
    "history_unreadable": Message("doubt.history_unreadable", "the history of the rig's checks cannot be read"),
    "camera_unsettled": Message("doubt.camera_unsettled", "the camera's calibration had not settled"),
    "planes_unsettled": Message("doubt.planes_unsettled", "the laser planes' calibration had not settled"),
    "points_off_alike": Message("doubt.points_off_alike", "the plane target's points lie off alike in all poses"),
    "planes_unknown": Message("doubt.planes_unknown", "it is not known whether the planes' calibration had settled"),
    "size_unconfirmed": Message("doubt.size_unconfirmed", "the size of the plane target is not confirmed"),
    "u_incomplete": Message("doubt.u_incomplete", "U does not hold all that is known"),
    "light_skewed": Message("doubt.light_skewed", "the light on the part is skewed or wider than on the table"),
    "faces_not_spanned": Message("doubt.faces_not_spanned", "the points do not span a face"),
    "several_faces": Message("doubt.several_faces", "several pairs of faces could be meant"),
    "overlap_disagrees": Message("doubt.overlap_disagrees", "two views disagree where they show the same surface"),
    "joint_inside_out": Message("doubt.joint_inside_out", "two views meet with their surfaces facing each other"),
    "marks_disagree": Message("doubt.marks_disagree", "the carrier's marks are not where they were calibrated"),
    "slip_unseen": Message("doubt.slip_unseen", "nothing shows whether the part has slipped on its carrier"),
    "part_may_have_slipped": Message(
        "doubt.part_may_have_slipped", "the surfaces that two views share do not show a slip along the thickness"
    ),
    "carrier_as_printed": Message("doubt.carrier_as_printed", "the carrier's marks were never measured"),
    "few_marks_fit": Message("doubt.few_marks_fit", "too few of the carrier's marks fit each other"),
    "marks_apart": Message("doubt.marks_apart", "two of the carrier's marks are not as far apart as calibrated"),
    "joint_hangs_on_one_mark": Message("doubt.joint_hangs_on_one_mark", "the joint hangs on one mark"),
    "master_doubted": Message("doubt.master_doubted", "the master that it is compared with proves nothing"),
    "results_doubted": Message("doubt.results_doubted", "results that it rests on prove nothing"),
    "scatter_alone": Message("doubt.scatter_alone", "U holds the scatter of the repeats alone"),
    "artefact_without_u": Message("doubt.artefact_without_u", "no uncertainty of the artefact is stated"),
    UNNAMED: Message("doubt.unnamed", "its file does not say why"),
}
"""Each fact that takes away a proof, in few words, by its name in files."""
