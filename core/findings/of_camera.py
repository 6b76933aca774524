"""Findings of the camera's calibration, and of the targets that calibrations are made with."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # Views and their corners
    Finding("camera.few_views", Weight.CAUTION, Effect.NONE,
            "Only {n} views are used: take at least {least}, better 10 to 15."),
    Finding("camera.views_without_target", Weight.CAUTION, Effect.NONE,
            "{n} of {all} views show no usable target, the first {name}: {reason}."),
    Finding("camera.view_left_out", Weight.CAUTION, Effect.NONE,
            "{view} is left out: {reason}."),
    Finding("camera.views_left_out_by_hand", Weight.CAUTION, Effect.NONE,
            "{n} of {all} views are left out by hand: {names}."),
    Finding("camera.views_repeated", Weight.CAUTION, Effect.NONE,
            "{n} of {all} views left out ({reason}): {names}."),
    Finding("camera.misfound_corners", Weight.CAUTION, Effect.NONE,
            "One misfound corner of {view} is left out.",
            "{n} misfound corners of {view} are left out."),
    Finding("camera.worse_view", Weight.CAUTION, Effect.NONE,
            "{view} fits {times:.0f} times worse than most views ({rms:.2f} px against {usual:.2f} px): look at its "
            "corners, and take it again or leave it out."),
    Finding("camera.hot_pixels", Weight.CAUTION, Effect.NONE,
            "{n} pixel of {all} shines by itself in all pictures (hot pixel): it pulls corners and stripes. Map it "
            "out in the camera, cool it or expose for a shorter time.",
            "{n} pixels of {all} shine by themselves in all pictures (hot pixels): they pull corners and stripes. "
            "Map them out in the camera, cool it or expose for a shorter time."),
    # Where corners are, and how the views are tilted
    Finding("camera.empty_regions", Weight.CAUTION, Effect.NONE,
            "There is no corner in the {places:and} of the picture: take a view that reaches there."),
    Finding("camera.small_tilts", Weight.CAUTION, Effect.NONE,
            "The views are tilted by at most {tilt:.0f}° against each other: tilt the target by about 30° in "
            "different directions, or the focal length stays uncertain."),
    Finding("camera.too_few_to_compare", Weight.CAUTION, Effect.NONE,
            "With fewer than six views two halves of them cannot be checked against each other."),
    # The fit
    Finding("camera.not_converged", Weight.GRAVE, Effect.NO_PROOF,
            "The camera was not solved to the end: a further step would still change it, and what is measured with it "
            "may be off by more than U. Take more views, tilted by about 30° in different directions, and calibrate "
            "again.", fact="camera_unsettled"),
    Finding("camera.bad_fit", Weight.GRAVE, Effect.WIDENS_U,
            "The calibration is bad: corners fit to {rms:.2f} px only, {times:.0f} times what they were found to. "
            "Look for views with blur or a moved target, check the target's corners and how flat it is, or take the "
            "views again."),
    Finding("camera.third_radial", Weight.INFORMATION, Effect.NONE,
            "The lens asks for its third radial coefficient k₃, which is solved for: with it, each view fits the "
            "camera of all others better, by {gain:.1%} (u = {gain_error:.1%}) of its squared residuals in the mean. "
            "It moves corners by up to {px:.2f} px ({mm:.3f} mm at a distance of {depth_mm:.0f} mm)."),
    Finding("camera.corners_err_together", Weight.CAUTION, Effect.WIDENS_U,
            "Corners of one view err together (a target that is not flat, blur, or a detector's bias): the standard "
            "deviations are {times:.1f} times those of independent corners."),
    Finding("camera.corners_err_alike", Weight.CAUTION, Effect.WIDENS_U,
            "Corners of the target err alike in every view (a print that is not true): the standard deviations are "
            "{times:.1f} times those of independent corners."),
    Finding("camera.pattern_outwards", Weight.CAUTION, Effect.NONE,
            "In all views corners lie too far {direction} by {px:.2f} px ({mm:.3f} mm at a distance of "
            "{depth_mm:.0f} mm) at {share:.0%} of the way from the picture's centre to its farthest corner: the "
            "lens is not fully described. The standard deviations contain it."),
    Finding("camera.pattern_in_region", Weight.CAUTION, Effect.NONE,
            "In all views corners in the {place} of the picture lie too far {direction} by {px:.2f} px ({mm:.3f} mm "
            "at a distance of {depth_mm:.0f} mm): the lens or the print is not fully described, or corners are "
            "drawn aside by blur. The standard deviations contain it."),
    Finding("camera.imported", Weight.GRAVE, Effect.NO_PROOF,
            "The camera was calibrated by another program and read from {name}: its standard deviations are not "
            "known, so no uncertainty here holds the camera's share, and nothing measured proves conformity.",
            fact="u_incomplete"),
    # Targets: their size and form
    Finding("camera.bowed_target", Weight.CAUTION, Effect.WIDENS_U,
            "The target is bowed by {bow:.2f} mm from its lowest to its highest place, which is taken into account: "
            "better fix it to something flat."),
    Finding("target.flatness_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "How flat the target is, is not stated ({field}): {mm:g} mm is assumed as standard deviation."),
    Finding("target.size_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "How true the target's size is, is not stated ({field}): {per_mille:g} ‰ of it is assumed as standard "
            "uncertainty, as of an office laser printer's print."),
    Finding("target.sizes_agree", Weight.INFORMATION, Effect.NONE,
            "{n} pictures show the plane target beside {other}: it is {percent:+.2f} % ± {U:.2f} % larger against "
            "that than stated, as what is stated lets one expect."),
    Finding("target.sizes_disagree", Weight.GRAVE, Effect.WIDENS_U,
            "{n} pictures show the plane target beside {other}: it is {percent:+.2f} % ± {U:.2f} % larger against "
            "that than stated (probability that it is chance: {p:.1g}); one of the two sizes is wrong, and all "
            "lengths are uncertain by as much: measure both."),
    Finding("target.not_fixed", Weight.CAUTION, Effect.NONE,
            "The {n} pictures that show the plane target beside {other} do not have them in one place against each "
            "other (probability {p:.1g}): fix one to the other; they say nothing of the sizes."),
    Finding("target.not_both", Weight.CAUTION, Effect.NONE,
            "{picture} does not show both targets: {reason}."),
)  # fmt: skip
