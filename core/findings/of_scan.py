"""Findings of a scan's light planes and surface."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # What explains most of what is too large
    Finding("scan.most_likely_cause", Weight.GRAVE, Effect.NONE,
            "Most likely cause: {causes:;}."),
    Finding("scan.most_likely_scatter", Weight.CAUTION, Effect.NONE,
            "Most likely cause of crossings that are off: {causes:;}."),
    # What moved within it
    Finding("scan.moved", Weight.GRAVE, Effect.NO_PROOF,
            "Object or camera moved {when:and}: crossings of the frames before and after disagree. Only {n} frames "
            "between which nothing moved are used. Hold both still and scan again to use them all.", fact="moved"),
    Finding("scan.fan_shifted", Weight.GRAVE, Effect.NO_PROOF,
            "Something moved during the scan, {what}, {when:and}: {percent:.0f} % of the fan's light lies about "
            "{shift_px:.2g} px aside, which is {shift_mm:.2g} mm in depth. Only {n} frames between which nothing "
            "moved are used. Hold part and camera still and scan again.", fact="moved"),
    Finding("scan.drifted", Weight.GRAVE, Effect.NO_PROOF,
            "The rig drifts: from the first frame to the last the fan's light moves evenly, by {shift_px:.2g} px, "
            "which is {shift_mm:.2g} mm in depth. Let camera and lasers warm up before a scan, "
            "and scan faster.", fact="drifted"),
    Finding("scan.rest_not_judged", Weight.GRAVE, Effect.NO_PROOF,
            "Whether the rig drifted or anything moved during the scan cannot be told from {n} frames with {stretches} "
            "stretches of the fan's light: scan again with {least} frames or more, and the fan's lines in view.",
            fact="drifted"),
    # Where the light planes are
    Finding("scan.collapsed", Weight.GRAVE, Effect.NO_PROOF,
            "The sweeps' light planes have fallen together into one: no depth can be trusted. Move and tilt the "
            "hand-held laser more between frames, and cross the fan on object and table. Shiny sides that mirror "
            "the laser onto the table do this, too: spray them matt.", fact="collapsed"),
    Finding("scan.collapsed_in_spite_of_relief", Weight.GRAVE, Effect.NO_RESULT,
            "the sweeps' light planes have fallen together into one although the fan meets relief, so no depth can be "
            "trusted and nothing is written"),
    Finding("scan.crossings_scatter", Weight.CAUTION, Effect.WIDENS_U,
            "Crossings of the stripes disagree {times:.1f} times as much as their noise explains, everywhere alike; "
            "the points' σ contains it. The hand may have moved during exposures, or the laser is out of focus."),
    Finding("scan.fan_disagrees", Weight.GRAVE, Effect.NO_PROOF,
            "Many crossings with the fan disagree with the sweeps; none was left out: check the laser planes, "
            "and that object and camera stood still.", fact="fan_disagrees"),
    Finding("scan.explained_by_change", Weight.GRAVE, Effect.NO_PROOF,
            "Camera or laser are not as calibrated: crossings disagree {times:.2g} times as much as their noise "
            "explains. What would explain it: {changes:;}. Set sensor region, focus and mounts as they "
            "were, or calibrate again.", fact="rig_changed"),
    Finding("scan.fan_off_in_region", Weight.GRAVE, Effect.NO_PROOF,
            "In the {place} of the picture the sweeps lie {mm:.2g} mm {where} than the fan's light, more than its "
            "speckle explains: laser or camera are not as calibrated, or something moved after the reference was "
            "taken. U need not contain it: check the rig, and scan again.", fact="fan_disagrees"),
    # Known planes
    Finding("scan.board_not_found", Weight.CAUTION, Effect.NONE,
            "The board {board} is not used: {reasons:;}."),
    Finding("scan.board_picture_left_out", Weight.CAUTION, Effect.NONE,
            "A picture of the board {board} is not used: {reason}."),
    Finding("scan.board_moved", Weight.CAUTION, Effect.NONE,
            "The board {board} moved between its pictures, by {mm:.2g} mm and more than noise: it is not used. Let it "
            "lie as it is from the first picture to the last frame."),
    Finding("scan.board_warm", Weight.INFORMATION, Effect.NONE,
            "The size of the board {board} counts as {ppm:+.0f} ppm larger than stated, by its temperature of "
            "{celsius:.1f} °C and that of the plane target."),
    Finding("scan.board_not_met", Weight.CAUTION, Effect.NONE,
            "No sweep is seen on the board {board}: it is not used. Let sweeps cross it."),
    Finding("scan.boards_not_used", Weight.CAUTION, Effect.NONE,
            "The boards beside the part are not used: by the method three-crossings the fan alone locates each sweep. "
            "Choose the method network."),
    Finding("scan.board_off", Weight.CAUTION, Effect.NONE,
            "The board {board} moved or is bent: the fan, which agrees with the others, has it {mm:.2g} mm aside and "
            "turned by {degrees:.2g}°, {times:.1f} times what is expected. It is not used."),
    Finding("scan.checked_by_planes", Weight.INFORMATION, Effect.NONE,
            "Checked in this scan: the fan agrees with {boards:and} (within {mm:.2g} mm, p = {p:.2g}), so camera and "
            "fixed laser are as calibrated."),
    Finding("scan.planes_see_little", Weight.INFORMATION, Effect.NONE,
            "The fan agrees with {boards:and} (within {mm:.2g} mm, p = {p:.2g}), but that sees little: of usual "
            "changes of the rig since its calibration it would show {percent:.0f} %, of which a check has to show "
            "{least:.0f} %. It is no check of camera and fixed laser."),
    Finding("scan.planes_alone", Weight.INFORMATION, Effect.NONE,
            "Measured by known planes alone, {boards:and}: {points:,} points of sweeps on them agree to {mm:.2g} mm."),
    Finding("scan.planes_disagree", Weight.GRAVE, Effect.NO_PROOF,
            "Fan and {boards:and} disagree in this scan: {mm:.2g} mm and {degrees:.2g}°, {times:.1f} times what is "
            "expected. Most likely {cause}. The scan is measured by the fan alone: check the rig with the plane "
            "target.",
            fact="planes_disagree"),
    # What fixes the scale of heights
    Finding("scan.scale_fixed", Weight.INFORMATION, Effect.NONE,
            "The relief under the fan fixes the scale to {percent:.2g} %."),
    Finding("scan.scale_by_planes", Weight.INFORMATION, Effect.NONE,
            "The known planes fix the scale to {percent:.2g} %."),
    Finding("scan.scale_weak", Weight.CAUTION, Effect.WIDENS_U,
            "The scale of heights is fixed only to {percent:.2g} %: {error_mm:.2g} mm on a height of {height_mm:.0f} "
            "mm. {missing}."),
    Finding("scan.scale_unknown", Weight.CAUTION, Effect.WIDENS_U,
            "Nothing fixes the scale of heights. {missing}. The fan's own points and flat faces are right all the "
            "same."),
    # Light that is left out
    Finding("scan.second_bounces", Weight.CAUTION, Effect.NONE,
            "Second bounces: {n} piece of the hand-held laser's stripe is left out. Shiny sides mirror its light "
            "onto table or part: spray the part matt, or lay it on something dark.",
            "Second bounces: {n} pieces of the hand-held laser's stripe are left out, in {frames} frames. Shiny "
            "sides mirror its light onto table or part: spray the part matt, or lay it on something dark."),
    Finding("scan.fan_light_unused", Weight.CAUTION, Effect.NONE,
            "Not used of the fan's light: {n} stretch ({reason}).",
            "Not used of the fan's light: {n} stretches ({reason})."),
)  # fmt: skip
