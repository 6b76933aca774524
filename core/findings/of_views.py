"""Findings of views joined by the marks of a carrier."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    Finding("views.overlap_disagrees", Weight.GRAVE, Effect.NO_PROOF,
            "Where the views {first} and {second} see the same surface they are {mm:+.3f} mm apart, with an "
            "uncertainty of {u_mm:.3f} mm: the part has moved on its carrier, or marks are not where they were "
            "calibrated. Fix the part, and take the views again.", fact="overlap_disagrees"),
    Finding("views.normals_opposed", Weight.GRAVE, Effect.NO_PROOF,
            "Where the views {first} and {second} meet, their surfaces face each other: one of them is put together "
            "inside out. Check which side of the carrier each shows.", fact="joint_inside_out"),
    Finding("views.carrier_as_printed", Weight.GRAVE, Effect.NO_PROOF,
            "The carrier is taken as it was printed: nobody has measured where its marks are. Have them measured, on "
            "both sides, and put their places and uncertainties into its carrier.toml, without as_printed.",
            fact="carrier_as_printed"),
    Finding("views.few_marks_fit", Weight.GRAVE, Effect.NO_PROOF,
            "Of the view {view} only {n} of {seen} marks fit each other: which of them are wrong is a guess. At least "
            "{least} must fit, and three quarters of those seen. Clean the marks, see that all are firm and without "
            "glare, and take the view again.", fact="few_marks_fit"),
    Finding("views.marks_disagree", Weight.GRAVE, Effect.NO_PROOF,
            "The carrier's marks are not where they were calibrated: their residuals are {times:.1f} times as large as "
            "stated, the largest {px:.2f} px at mark {number} of the view {view}. If that mark is smeared or in glare, "
            "clean it; else the carrier is bent, or marks were moved: have them measured again. Then take the views "
            "again.",
            fact="marks_disagree"),
    Finding("views.hangs_on_one_mark", Weight.GRAVE, Effect.NO_PROOF,
            "Without mark {number} of the view {view} the joint moves by {mm:+.3f} mm at the part, more than the "
            "marks' uncertainty explains ({u_mm:.3f} mm): look whether that mark is clean and firm, and take the views "
            "again.", fact="joint_hangs_on_one_mark"),
    Finding("views.pair_off", Weight.GRAVE, Effect.NO_PROOF,
            "In the view {view} marks {first} and {second} are {mm:+.3f} mm farther apart than calibrated, {z:.1f} "
            "times the uncertainty of that: one of them was moved, or the carrier is bent. Have the marks measured "
            "again, and take the views again.", fact="marks_apart"),
    Finding("views.marks_left_out", Weight.CAUTION, Effect.NONE,
            "Of the view {view} {n} mark is left out, as it does not fit the others: {numbers}. Look whether it is "
            "smeared, in glare, or moved.",
            "Of the view {view} {n} marks are left out, as they do not fit the others: {numbers}. Look whether they "
            "are smeared, in glare, or moved."),
    Finding("views.no_overlap", Weight.GRAVE, Effect.NO_PROOF,
            "No surface of the part is seen in two views: whether it stayed where it was on its carrier while that was "
            "turned is shown by nothing, and no thickness from one view to another is proven. Fasten it so that it "
            "cannot move, and turn a block of known thickness over in the same way to see what the carrier does.",
            fact="slip_unseen"),
    Finding("views.slip_unseen", Weight.GRAVE, Effect.NO_PROOF,
            "Surfaces that are seen in two views lie too steep to show whether the part has slipped along the "
            "thickness: they leave u = {u_mm:.2g} mm of that, the marks {joint_mm:.2g} mm, and no thickness from one "
            "view to another is proven. Fasten the part so that it cannot move, and turn a block of known thickness "
            "over in the same way to see what the carrier does.", fact="part_may_have_slipped"),
)  # fmt: skip
