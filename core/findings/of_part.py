"""Findings of what is measured on a part."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # What is stated of the part
    Finding("part.material_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "What the part is made of is not stated ({field}): the uncertainty holds light from below its surface "
            "as far as nothing excludes it, and an expansion of {alpha:g}·10⁻⁶/K (u = {u_alpha:g}·10⁻⁶/K)."),
    Finding("part.temperature_assumed", Weight.CAUTION, Effect.WIDENS_U,
            "The part's temperature is not stated ({field}): {celsius:g} °C with a standard uncertainty of {u:g} °C "
            "is assumed."),
    Finding("part.surface_corrected", Weight.INFORMATION, Effect.NONE,
            "Corrected by {change_um:+.1f} µm for what is stated of the part: its material is seen {offset_um:g} µm "
            "below the surface, a layer of spray adds {spray_um:g} µm."),
    Finding("part.thicknesses_alone", Weight.INFORMATION, Effect.NONE,
            "What is stated of the part's surface, a layer of spray or how deep its material is seen, is taken off "
            "thicknesses alone: all else is as light shows it."),
    # Its faces
    Finding("gauge.several_faces", Weight.GRAVE, Effect.NO_PROOF,
            "There are {n} pairs of parallel faces that could be meant. Measured is the one of {mm:.1f} mm, its upper "
            "face at pixel {u:.0f}, {v:.0f}; the next is one of {other_mm:.1f} mm at pixel {other_u:.0f}, "
            "{other_v:.0f}. Nothing is proven until the faces are outlined, as [gauge] upper_polygon_px and {lower}; "
            "gauge.json has the outlines of each pair.", fact="several_faces"),
    Finding("surface.faces_not_spanned", Weight.GRAVE, Effect.NO_PROOF,
            "The points of {name:and} lie on one stripe, or too near to each other for their noise: nothing says how "
            "it lies, or whether it is a face, and what is measured from it proves nothing. Scan it with more sweeps, "
            "or, if it leaves most of its points out, raise the scan's σ cut{command}.", fact="faces_not_spanned"),
    Finding("form.scatter", Weight.CAUTION, Effect.WIDENS_U,
            "Points scatter about {name:and} {times:.1f} times as much as their uncertainty says: something acts on "
            "them that is not known (gloss, vibration, a laser out of focus). U contains the scatter as noise."),
    Finding("form.askew", Weight.CAUTION, Effect.WIDENS_U,
            "Between {name:and} there is an angle of about {deg:.2g}°: it explains {percent:.0f} % of what their "
            "points are off parallel planes. U contains what that does to the value. Lay the part flat, without chips "
            "or burrs under it, and scan again; a part that is so gets a feature for the angle."),
    Finding("form.levels_askew", Weight.CAUTION, Effect.WIDENS_U,
            "Not parallel to {reference}: {name:and}, by up to about {deg:.2g}°. That explains {percent:.0f} % of what "
            "the points of all levels are off parallel planes. U contains what that does to the heights. Levels that "
            "are made so get a feature for the angle."),
    Finding("form.bowed", Weight.CAUTION, Effect.WIDENS_U,
            "The form of {name} is not true: it is bowed, its middle is {mm:.2g} mm {where} its rim. U contains "
            "what that does to the value."),
    Finding("form.uneven", Weight.CAUTION, Effect.WIDENS_U,
            "The form of {name} is not true: at the {place}, as the camera sees it, it is {mm:.2g} mm {where}. U "
            "contains what that does to the value."),
    Finding("form.uneven_along", Weight.CAUTION, Effect.WIDENS_U,
            "The form of {name} is not true: {at_mm:.1f} mm along the section it is {mm:.2g} mm {where}. U contains "
            "what that does to the value."),
    Finding("form.off_nominal", Weight.CAUTION, Effect.WIDENS_U,
            "However the part is laid on its nominal surface: at the {place}, as the camera sees it, it is {mm:.2g} "
            "mm {where}, more than the uncertainty of its points explains."),
    # The thickness from one picture
    Finding("profile.mean_of", Weight.INFORMATION, Effect.NONE,
            "The thickness is that of {n} picture.",
            "The thickness is the mean of {n} pictures."),
    Finding("profile.stood_still", Weight.CAUTION, Effect.NONE,
            "The pictures show one and the same place, so that they are no surer together than one of them: move "
            "the part a little between pictures."),
    Finding("profile.one_line_on_part", Weight.CAUTION, Effect.NONE,
            "One line alone meets the upper face: that it is plane, and parallel to the lower one, is taken for "
            "granted."),
    Finding("profile.assumes_rest", Weight.CAUTION, Effect.NONE,
            "The part is taken to have been at rest during each exposure, and its two faces to be parallel."),
    Finding("profile.assumes_stage", Weight.CAUTION, Effect.WIDENS_U,
            "The faces are taken to be parallel to the plate of {stage}, to a standard uncertainty of {sd_deg:.2g}°."),
    Finding("profile.assumes_square", Weight.CAUTION, Effect.WIDENS_U,
            "The light plane is taken to stand at right angles on the faces, to a standard uncertainty of "
            "{sd_deg:.2g}°; no picture shows whether it does."),
    Finding("profile.not_straight", Weight.CAUTION, Effect.WIDENS_U,
            "The profiles of {name} are not straight: at {share:.0%} of its length from the left they are {mm:.2g} "
            "mm {where} their line. The face is not plane, or the light is bent; more pictures do not average it "
            "out."),
    # Features and their lengths
    Finding("feature.frame_not_measured", Weight.GRAVE, Effect.NO_RESULT,
            "{name} was not measured as a plane, axis or point."),
    Finding("feature.stated_at_20", Weight.INFORMATION, Effect.NONE,
            "Stated at 20 °C: {change_um:+.2f} µm for a part at {part_celsius:g} °C."),
    Finding("feature.scale_at_20", Weight.INFORMATION, Effect.NONE,
            "Corrected by {change_um:+.2f} µm for a calibration target at {celsius:g} °C."),
    Finding("feature.compared_with_master", Weight.INFORMATION, Effect.NONE,
            "Compared with master {master}: {correction_um:+.2f} µm."),
    Finding("feature.master_doubted", Weight.GRAVE, Effect.NO_PROOF,
            "By its own results master {master} proves nothing ({why:;}), and so nothing that is compared with it "
            "does. Measure the master again.", fact="master_doubted"),
    Finding("feature.master_too_different", Weight.CAUTION, Effect.NONE,
            "Not compared with master {master}, whose length of {certified_mm:g} mm is too different."),
    Finding("plugin.measured_by", Weight.INFORMATION, Effect.NONE,
            "Measured by the package {package} {version}, which is no part of Trisect."),
    Finding("plugin.unusable", Weight.CAUTION, Effect.NONE,
            "{name} of the package {package} {version} cannot be used: {why}."),
    Finding("plugin.studies_not_printed", Weight.CAUTION, Effect.NONE,
            "The project's studies are not printed, as no wing that reads them is there: {names:;}."),
    Finding("plugin.comparison_not_printed", Weight.CAUTION, Effect.NONE,
            "The comparison with another surface is not printed, as the wing {name} is not there."),
    Finding("plugin.trail_not_printed", Weight.CAUTION, Effect.NONE,
            "The hash of the project's audit trail is not printed, as the wing {name} is not there."),
    # Results and their uncertainty
    Finding("gauge.none_measured", Weight.GRAVE, Effect.NO_RESULT,
            "No thickness was measured: {reason}"),
    Finding("inspection.no_frame", Weight.GRAVE, Effect.NO_RESULT,
            "There are no part coordinates: {why}"),
    Finding("inspection.missing_in_u", Weight.GRAVE, Effect.NO_PROOF,
            "The stated uncertainties do not hold {missing}: they are less than is known, and prove nothing.",
            fact="u_incomplete"),
    Finding("inspection.light_is_skewed", Weight.GRAVE, Effect.NO_PROOF,
            "On what was measured the laser's light is skewed in depth, or wider than on the table: part of it comes "
            "from below the surface (plastic, wax, paper), or shines to one side. U holds what that may do, but "
            "nothing is proved: spray the part matt, or compare it with a master of its material.",
            fact="light_skewed"),
    Finding("scan.stripes_wider_on_part", Weight.CAUTION, Effect.WIDENS_U,
            "Stripes on the part are ({percent:.1f} ± {U:.1f}) % wider than on the table, besides what distance, "
            "slant and focus do: light from below the surface? It may come from {behind_mm:.2f} mm behind it. U of "
            "what is measured on the part contains that; where it is stated how far below its surface the part is "
            "seen, that does instead. Spray the part matt, or compare it with a master of its material."),
    Finding("inspection.rig_not_checked", Weight.CAUTION, Effect.WIDENS_U,
            "U is large because the rig was not checked on the day of the scan: {part_mm:.2g} mm of {U_mm:.2g} mm. "
            "Take 3 pictures of the plane target in the fan (1 min)."),
)  # fmt: skip
