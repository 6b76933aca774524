"""Findings that say why nothing proves conformity: one for each fact that takes away every proof."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

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
)  # fmt: skip
"""Why nothing is proven where a fact of the scan holds, in the order in which it is said."""
PLANES = (
    Finding("validity.planes_not_settled", Weight.GRAVE, Effect.NO_PROOF,
            "The calibration of the laser planes had not settled: nothing measured proves conformity. Record more "
            "poses of the target, at different distances and tilts, and calibrate again.", fact="planes_unsettled"),
    Finding("validity.target_points_off", Weight.GRAVE, Effect.NO_PROOF,
            "In all poses of the laser planes' calibration the target's points lie off alike, which U need not "
            "contain: nothing measured proves conformity. Calibrate again with a true target and camera, or measure "
            "a known artefact.", fact="points_off_alike"),
)  # fmt: skip
"""The same of the planes' calibration."""
OTHERS = (
    Finding("target.size_unconfirmed", Weight.GRAVE, Effect.NO_PROOF,
            "The size of the plane target, on which every length rests, is neither stated ({field}) nor confirmed, "
            "so that only what is compared with a master proves anything: state its standard uncertainty by its "
            "source, measure a known artefact, or take a picture of it fixed to the camera's target whose own size "
            "is stated.", fact="size_unconfirmed"),
    Finding("validity.scan_unknown", Weight.GRAVE, Effect.NO_PROOF,
            "The file of the scan, of another program or an earlier version, does not say whether anything moved or "
            "changed, or the stripes of the laser planes' calibration are not kept or too short to show it: nothing "
            "measured proves conformity. Measure the scan again, or first calibrate the laser planes again."),
    Finding("validity.planes_unknown", Weight.GRAVE, Effect.NO_PROOF,
            "The file of the laser planes' calibration, of another program or an earlier version, does not say "
            "whether it had settled and fitted its target: nothing measured proves conformity. Calibrate the laser "
            "planes again."),
)  # fmt: skip
"""That of the size, which a comparison with a master does not need, and of what a file does not say."""
ROWS = (*SCAN, *PLANES, *OTHERS)
