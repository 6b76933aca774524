"""Findings of what the rig has done since its calibrations: stated, assumed, and seen by checks."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # How far it may have changed
    Finding("scan.stability_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "How far the rig may have changed since its calibration is not stated ([stability] in rig.toml); "
            "assumed are standard uncertainties of {turn_urad:.0f} µrad, {shift_um:.0f} µm and {centre_px:.3g} px."),
    Finding("scan.calibrated_in_this_sitting", Weight.INFORMATION, Effect.NONE,
            "The laser planes were calibrated {hours:.1f} h before the end of the scan by the same camera, as the logs "
            "of both recordings say: that is as good as a check of the day, and what may have changed before it is not "
            "reckoned with."),
    Finding("scan.stability_charted", Weight.INFORMATION, Effect.NONE,
            "How far the rig may have changed since its calibration is from its control chart: {times:.2f} times "
            "what is assumed of a rig without a history, by checks on {days} days from {first} to {last}. What has "
            "knocked it since then is not in that: only a check of the day shows it."),
    Finding("scan.stability_more_than_stated", Weight.CAUTION, Effect.WIDENS_U,
            "By checks on {days} days from {first} to {last} the rig changes by {times:.2f} times what is assumed "
            "of a rig without a history, which is more than rig.toml states ([stability]): that is reckoned with."),
    Finding("scan.change_by_warmth_and_time", Weight.INFORMATION, Effect.NONE,
            "By {kelvins:.1f} K and {hours:.1f} h since its calibration the rig may have changed by standard "
            "uncertainties of {turn_urad:.0f} µrad, {shift_um:.0f} µm and {centre_px:.2g} px."),
    Finding("scan.warmer_than_usual", Weight.CAUTION, Effect.WIDENS_U,
            "The rig was calibrated at a temperature {kelvins:g} K away, and how far it changes by that is not "
            "stated ({field}): what is assumed for {usual:g} K is reckoned with in proportion."),
    Finding("scan.kelvins_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "How warm it was is not stated for both times ([air] in rig.toml): a difference of {kelvins:g} K is "
            "assumed."),
    Finding("scan.kelvins_since_check_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "How warm it was at the check and at the scan is not stated for both ([air] in rig.toml): a difference "
            "of {kelvins:g} K between them is assumed."),
    Finding("scan.hours_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "No picture of the calibration is there to tell when it was made: {hours:g} hours ago is assumed."),
    # That it has changed
    Finding("scan.fan_has_moved", Weight.GRAVE, Effect.NO_PROOF,
            "Laser or camera have changed since they were calibrated, by {times:.1f} times what the calibrations "
            "allow (probability that it is chance: {p:.1g}), or the target was not true: calibrate again.",
            fact="rig_changed"),
    Finding("scan.fan_seems_moved", Weight.CAUTION, Effect.NONE,
            "Laser or camera seem to have changed since they were calibrated, by {times:.1f} times what the "
            "calibrations allow (probability that it is chance: {p:.1g}), but the check of the day is in order."),
    Finding("scan.fan_is_elsewhere", Weight.GRAVE, Effect.NO_PROOF,
            "In the pictures of the check no stripe is where the calibration has the fan: laser or camera were "
            "moved since; calibrate again.", fact="rig_changed"),
    Finding("scan.section_changed", Weight.GRAVE, Effect.NO_PROOF,
            "The fan's stripes are skewed otherwise than when it was calibrated (skewness {now:.2f}, then "
            "{then:.2f}, u of the change {error:.2f}): their light reaches further to one side, as behind a lens that "
            "was knocked or smeared, or from a laser in another mode. They may lie up to {shift_px:.1f} px aside, "
            "which U contains. Clean the lens, set the focus back, or calibrate again.", fact="section_changed"),
    # Checks
    Finding("check.another_day", Weight.CAUTION, Effect.NONE,
            "The pictures of the check were taken {days:.0f} days from those of the scan: they say nothing of its "
            "day and were not used; check again."),
    Finding("check.without_fan", Weight.INFORMATION, Effect.NONE,
            "The pictures of the check are not used: they check a fan, and the rig has none."),
    Finding("check.pose_left_out", Weight.CAUTION, Effect.NONE,
            "Picture {pose} of the check says nothing: {reason}."),
    Finding("check.leaves_much", Weight.CAUTION, Effect.NONE,
            "The check leaves a step of {step_mm:g} mm uncertain by U = {unseen_mm:.2g} mm, the calibrations alone "
            "by {calibrations_mm:.2g} mm. Take twice as many pictures more, near and far, each tilted by about 40° "
            "to another side: seen nearly square on, a target's few corners say little of how it is tilted, a black "
            "square's four less than a grid of them."),
    # How long calibrations and checks hold
    Finding("validity.not_stated", Weight.CAUTION, Effect.NONE,
            "How long a calibration or a check holds is not stated in full ([validity] in rig.toml): what is not "
            "stated has no limit."),
    Finding("validity.calibration_undated", Weight.GRAVE, Effect.NO_PROOF,
            "It is not known when camera and laser were calibrated, and a calibration holds for {days:g} days only: "
            "nothing measured proves conformity.", fact="calibration_undated"),
    Finding("validity.calibration_lapsed", Weight.GRAVE, Effect.NO_PROOF,
            "Camera and laser were calibrated {n} day before this was recorded, and a calibration holds for "
            "{days:g}: nothing measured proves conformity; calibrate again.",
            "Camera and laser were calibrated {n} days before this was recorded, and a calibration holds for "
            "{days:g}: nothing measured proves conformity; calibrate again.", fact="calibration_lapsed"),
    Finding("validity.never_checked", Weight.GRAVE, Effect.NO_PROOF,
            "Camera and laser were never checked with these calibrations, and are to be every {days:g} days: "
            "nothing measured proves conformity; check.", fact="never_checked"),
    Finding("validity.check_lapsed", Weight.GRAVE, Effect.NO_PROOF,
            "The check of camera and laser nearest to this recording is of {date}, and they are to be checked every "
            "{days:g} days: nothing measured proves conformity; check again.", fact="check_lapsed"),
    Finding("validity.check_failed", Weight.GRAVE, Effect.NO_PROOF,
            "The check of camera and laser of {date} failed: nothing measured with these calibrations proves "
            "conformity; calibrate again.", fact="check_failed"),
    Finding("validity.history_unreadable", Weight.GRAVE, Effect.NO_PROOF,
            "The history of this rig's checks cannot be read ({reason}): nothing measured proves conformity.",
            fact="history_unreadable"),
)  # fmt: skip
