"""Findings of the pictures of a scan."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # Files of a set
    Finding("set.not_read", Weight.CAUTION, Effect.NONE,
            "{n} file in {folder} is of a kind that is not read ({names}): convert it to png.",
            "{n} files in {folder} are of a kind that is not read ({names}): convert them to png."),
    Finding("set.films_not_read", Weight.CAUTION, Effect.NONE,
            "{n} film in {folder} is not read ({names}): import its frames.",
            "{n} films in {folder} are not read ({names}): import the frames of one."),
    Finding("set.log_not_read", Weight.CAUTION, Effect.WIDENS_U,
            "The log of a recording is damaged ({reason}): when and by which camera it was made, and whether frames "
            "were lost, is not known, and U may be larger by what may have changed since the calibration. Remove the "
            "file if it cannot be mended; pictures do not need it."),
    # Camera, light and surface
    Finding("scan.no_reference", Weight.CAUTION, Effect.NONE,
            "There is no scan/reference.png: the darkest third of {n} frames stands for it, pixel by pixel."),
    Finding("scan.frames_lost", Weight.CAUTION, Effect.NONE,
            "{n} frame was lost while recording: camera, computer or disk were too slow.",
            "{n} frames were lost while recording: camera, computer or disk were too slow."),
    Finding("scan.shutter_assumed", Weight.CAUTION, Effect.NONE,
            "Whether the camera's shutter is global or rolling is not stated ({field}); assumed is a global one. "
            "With a rolling one and a hand that moves, points are off by more than their σ says. State 0 for a "
            "global shutter."),
    Finding("scan.compressed", Weight.CAUTION, Effect.WIDENS_U,
            "The frames are compressed, as JPEG or in a film: that loses {grey:.1f} grey levels, more than their noise "
            "of {noise:.1f}. σ contains it; record PNG."),
    Finding("scan.compression_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "The frames are of a film that does not tell what its compression loses: {grey:.1f} grey levels are "
            "assumed; their noise is {noise:.1f}. σ contains it; record PNG."),
    Finding("scan.colour_mosaic", Weight.GRAVE, Effect.NO_PROOF,
            "The pictures are interpolated from a colour mosaic; stripes of σ {width_px:.1f} px are too fine "
            "for its tiles and may be off by more than their σ. Use a grey camera, raw pictures (mosaic in rig.toml), "
            "or stripes of σ {least_px:g} px or more.", fact="too_fine_for_mosaic"),
    Finding("scan.raw_mosaic", Weight.GRAVE, Effect.NO_PROOF,
            "The pictures look like the raw ones of a colour camera: the laser is seen {times:.1f} times as bright "
            "at some pixels of each 2 × 2 as at others. State mosaic in rig.toml.", fact="too_fine_for_mosaic"),
    Finding("scan.speckled", Weight.CAUTION, Effect.WIDENS_U,
            "The fan's light scatters by {percent:.0f} % from point to point beyond noise: strong speckle, or a "
            "grainy surface. Open the lens's aperture, spray the part, or use wider lines."),
    Finding("scan.shines", Weight.CAUTION, Effect.NONE,
            "{fan:.1f} % of the fan's points and {sweeps:.1f} % of the hand-held laser's are saturated: the surface "
            "shines there (gloss), or the exposure is too long. Nothing is measured there, and points beside it may "
            "be off: expose {stops:g} EV less, add second exposures that much shorter (NAME@2.png beside NAME.png), "
            "or spray the part matt."),
    Finding("scan.bright_in_part", Weight.CAUTION, Effect.NONE,
            "{fan:.1f} % of the fan's points and {sweeps:.1f} % of the hand-held laser's are saturated, here and there "
            "along stripes that are bright all over: the exposure is too long for what is nearest to the laser or "
            "faces it. Nothing is measured there: expose {stops:g} EV less, or add second exposures that much shorter "
            "(NAME@2.png beside NAME.png)."),
    Finding("scan.brightness_changed", Weight.CAUTION, Effect.NONE,
            "The brightness of {n} of {all} frames, the first {name}, differs from that of the reference by up to "
            "{percent:.0f} %, as with automatic exposure or a laser that is not steady: taken off by the fan's light. "
            "Fix exposure and gain of the camera."),
    Finding("scan.room_light_changed", Weight.CAUTION, Effect.NONE,
            "The room's light changed in {n} of {all} frames, the first {name}: the background is up to "
            "{percent:.0f} % {which} than in the reference, which makes stripes less sure. Keep the light as it is "
            "during a scan, or scan again."),
    # Frames without points
    Finding("scan.frames_without_points", Weight.CAUTION, Effect.NONE,
            "{n} of {all} frames gave no points ({reason}): {names}.", told_of="frames"),
    Finding("scan.many_frames_without_points", Weight.CAUTION, Effect.NONE,
            "{n} of {all} frames gave no points ({reason}): {names} and others.", told_of="frames"),
    Finding("scan.frames_moved", Weight.CAUTION, Effect.NONE,
            "Object or camera moved during the scan: {n} of {all} frames were left out, the first {name} (the fan's "
            "light is {shift_px:.1f} px or more aside, measured across its lines). Hold both still and scan again "
            "to use them all."),
    # Further exposures
    Finding("scan.further_exposures", Weight.INFORMATION, Effect.NONE,
            "{n} of {all} frames have an exposure @{number}, {stops:.1f} EV {which} than the first one: "
            "{percent:.1f} % of the points on their stripes are from it."),
    Finding("scan.further_exposures_moved", Weight.INFORMATION, Effect.NONE,
            "Between the first exposure and @{number} of {n} of {all} frames, the first {name}, the hand-held laser "
            "moved: the stripe lies {shift_px:.1f} px aside, and that exposure is not used there. Hold the laser "
            "still for all of them."),
    # The hand's motion while a picture was taken
    Finding("scan.exposure_blur", Weight.CAUTION, Effect.WIDENS_U,
            "In {n} of {known} frames the stripe is blurred by the hand's motion or tremor within the exposure, by "
            "up to {blur_px:.1f} px (σ; at rest it is {at_rest_px:.1f} px). σ holds how much less sure these points "
            "are. Expose shorter, with more light or gain, or move slower and rest the hand.",
            "In {n} of {known} frames the stripe is blurred by the hand's motion or tremor within the exposure, by "
            "up to {blur_px:.1f} px (σ; at rest it is {at_rest_px:.1f} px). σ holds how much less sure these points "
            "are. Expose shorter, with more light or gain, or move slower and rest the hand."),
    Finding("scan.hand_moved", Weight.CAUTION, Effect.NONE,
            "The hand moved at about {speed:.0f} mm/s while the camera read its rows out for {time_ms:.0f} ms: "
            "sheets of light are twisted by {twist_mm:.2g} mm. Their planes follow it row by row, and σ holds what "
            "that leaves unsure. Move slower, rest the hand, or use a camera that reads out faster."),
    Finding("scan.rows_roll", Weight.CAUTION, Effect.WIDENS_U,
            "The sheets of light are twisted, by about {twist_mm:.2g} mm: rows of the camera see them one after "
            "another while the hand moves (rolling shutter). Their planes follow the hand row by row, and σ holds "
            "what that leaves unsure. State {field}, move slower, or use a global shutter."),
    Finding("scan.points_unsure_by_motion", Weight.CAUTION, Effect.NONE,
            "{percent:.0f} % of the points are left out: the hand's motion while rows were read out leaves them "
            "less sure than {cut_mm:g} mm. Move slower, rest the hand, or take more sweeps."),
)  # fmt: skip
