"""Findings of the calibration of the laser planes."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # Poses and their stripes
    Finding("stripes.told_width_wrong", Weight.CAUTION, Effect.NONE,
            "The stripes were told to be {told_px:.1f} px wide, but are {measured_px:.1f} px: the measured width "
            "was used instead."),
    Finding("fan.saturated_stripes", Weight.CAUTION, Effect.NONE,
            "the stripes are saturated at {share:.0%} of their points, which can shift them: expose shorter, dim "
            "the laser, or set {field} to a colour in which the laser is weaker"),
    Finding("fan.brightness_changed", Weight.CAUTION, Effect.NONE,
            "the pictures with the fan on and off are not exposed alike in {n} of {all} poses, the first {pose}: they "
            "differ by up to {percent:.0f} %, as with automatic exposure or a lamp that is not steady, which is taken "
            "off by the plate's light. Fix exposure and gain of the camera"),
    Finding("fan.further_plane", Weight.CAUTION, Effect.NONE,
            "a further light plane is seen in {n} poses: check {field}"),
    Finding("fan.outlying_pose", Weight.CAUTION, Effect.NONE,
            "its stripes or target points fit {times:.0f} times worse than in the other poses"),
    Finding("fan.poses_left_out", Weight.CAUTION, Effect.NONE,
            "{n} of {all} poses left out: {names:;}", told_of="poses"),
    Finding("fan.few_poses", Weight.CAUTION, Effect.NONE,
            "a single pose of {all} fixes the planes: nothing checks it. Record {least} or more",
            "only {n} of {all} poses fix the planes, too few to foretell one by the others: nothing checks them. "
            "Record {least} or more at different distances and tilts"),
    Finding("fan.poorly_predicted", Weight.CAUTION, Effect.NONE,
            "the other poses foretell the stripes of {pose} to {error:.3f} mm only, those of a usual pose to "
            "{usual:.3f} mm: look at its pictures, or take more poses like it"),
    # The fit
    Finding("fan.not_converged", Weight.GRAVE, Effect.NO_PROOF,
            "Planes and poses had not settled after {n} steps and stay as they were then: what is measured with "
            "them may be off by more than U. Record more poses of the target, at different distances and tilts, and "
            "calibrate again.", fact="planes_unsettled"),
    Finding("fan.poses_scatter", Weight.CAUTION, Effect.WIDENS_U,
            "the poses scatter by {scatter:.2f} mm, {times:.0f} times their noise, which the planes' uncertainty "
            "contains: is the target curled, its size as stated, the camera well calibrated?"),
    Finding("fan.channels_differ", Weight.CAUTION, Effect.WIDENS_U,
            "by the {channel} channel alone the laser planes lie {mm:.2f} mm off those in use (RMS), {times:.1f} times "
            "what both leave uncertain, which the planes' uncertainty contains: expose so that no channel saturates, "
            "and record without compression"),
    Finding("fan.readjusted", Weight.INFORMATION, Effect.NONE,
            "Re-adjustment of camera and fan by {poses} poses of a check of {date}: fan turned by {turn_urad:.0f} "
            "µrad and moved by {shift_um:.0f} µm, picture by {drift_px:.2f} px, focal length by "
            "{focal_ppm:+.0f}·10⁻⁶ (p before {p_before:.1g}, after {p_after:.2g})."),
    # The target
    Finding("fan.bowed_target", Weight.CAUTION, Effect.WIDENS_U,
            "the plane target is bowed by {bow:.2f} mm from its lowest to its highest place, which is taken into "
            "account: better fix it to something flat"),
    Finding("fan.bow_or_bend", Weight.CAUTION, Effect.WIDENS_U,
            "in all poses the stripes bend alike by {mm:.3f} mm: a bowed target does that, and light that is no "
            "plane. Taken is a bowed target, as its flatness is not stated to be better; the uncertainty contains "
            "the other. Use a flat target and state its flatness ({field})"),
    Finding("fan.point_off_target", Weight.GRAVE, Effect.NO_PROOF,
            "in all poses the target's point at ({x:g}, {y:g}) mm lies off its place by ({dx:.2f}, {dy:.2f}) mm, "
            "which U need not contain: the print is not true, or the camera is not as it was calibrated",
            fact="points_off_alike"),
    Finding("fan.points_off_in_region", Weight.GRAVE, Effect.NO_PROOF,
            "in all poses the target's points in the {place} of the picture lie too far {direction} by {px:.2f} px, "
            "which U need not contain: calibrate the camera anew, or look for a print that is not true",
            fact="points_off_alike"),
    Finding("fan.points_not_judged", Weight.GRAVE, Effect.NO_PROOF,
            "the target's points lie off alike in {n} poses, too few to tell whether by chance, or because the print "
            "is not true or the camera not as it was calibrated, which U need not contain: record {least} or more at "
            "different distances and tilts", fact="points_off_alike"),
    # The light
    Finding("fan.lines_bent", Weight.CAUTION, Effect.WIDENS_U,
            "the lines are no planes of light: in all poses their ends bend {where} the camera by {mm:.3f} mm "
            "(residuals {rms:.3f} mm, expected {expected:.3f} mm), which their uncertainty contains: the laser's "
            "line lens, a target that is curled alike in every pose (state its flatness), or the camera's "
            "calibration"),
    Finding("fan.lines_wavy", Weight.CAUTION, Effect.WIDENS_U,
            "the lines are no planes of light: in all poses their stripes bend to and fro by {mm:.3f} mm (residuals "
            "{rms:.3f} mm, expected {expected:.3f} mm), which their uncertainty contains: is the camera well "
            "calibrated, the laser's lens clean?"),
)  # fmt: skip
