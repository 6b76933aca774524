"""Findings of studies: of the way of measuring, and of series of parts."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    # All studies
    Finding("study.doubted", Weight.GRAVE, Effect.NO_PROOF,
            "By their own results {names} prove nothing, and so the study does not.", fact="results_doubted"),
    # Repeats
    Finding("study.scatter_alone", Weight.GRAVE, Effect.NO_PROOF,
            "U of the mean holds the scatter of the repeats alone: no scan states its own uncertainty, so what is "
            "common to all of them (calibration) is not in it, and nothing is proven.", fact="scatter_alone"),
    Finding("study.beyond_run_chart", Weight.CAUTION, Effect.NONE,
            "Beyond the limits of the run chart: {names}; look for what changed there."),
    # Type-1 study
    Finding("study.few_repeats", Weight.CAUTION, Effect.NONE,
            "{n} repeats say little about the spread: take at least {least}, better 50."),
    Finding("study.no_spread", Weight.CAUTION, Effect.NONE,
            "All values are the same: the resolution hides the spread."),
    Finding("study.bias_significant", Weight.CAUTION, Effect.NONE,
            "The bias differs from zero (t-test, p = {p:.2g})."),
    Finding("study.bias_too_large", Weight.CAUTION, Effect.NONE,
            "The spread would suffice; the bias does not: correct it, or calibrate anew."),
    # Gauge R&R
    Finding("study.few_measurements", Weight.CAUTION, Effect.NONE,
            "{p} × {o} × {r} measurements are few: 10 parts, 3 operators and 2 to 3 repeats are usual."),
    Finding("study.one_operator", Weight.INFORMATION, Effect.NONE,
            "One operator alone shows no reproducibility: gauge R&R is the repeatability."),
    Finding("study.interaction_pooled", Weight.INFORMATION, Effect.NONE,
            "The interaction of parts and operators is not significant (p > {limit}) and is pooled with the error."),
    Finding("study.few_categories", Weight.CAUTION, Effect.NONE,
            "{n} distinct categories: with fewer than {least} the gauge hardly tells these parts apart."),
    # Series of parts
    Finding("study.series_without_u", Weight.CAUTION, Effect.NONE,
            "No uncertainty is stated: what moves all values alike (calibration) is not in the intervals of the "
            "indices."),
    Finding("study.series_too_short", Weight.CAUTION, Effect.NONE,
            "The chart has {n} points; limits need {least} or more, so none are drawn, and no Cp or Cpk given."),
    Finding("study.series_no_spread", Weight.CAUTION, Effect.NONE,
            "Values one after another are all the same: the resolution hides the spread, and no limits are drawn."),
    Finding("study.series_values_over", Weight.CAUTION, Effect.NONE,
            "Values at the end that make no whole subgroup: {n}."),
    Finding("study.rule_broken", Weight.CAUTION, Effect.NONE,
            "Rule {rule} ({words}): broken at {names}."),
    Finding("study.spread_beyond_limits", Weight.CAUTION, Effect.NONE,
            "The spread is beyond its limits at {names}."),
    Finding("study.breaks_by_chance", Weight.INFORMATION, Effect.NONE,
            "A steady process breaks one of the four rules about once in {every:.0f} points: look for what changed, "
            "before anything is adjusted."),
    Finding("study.not_steady", Weight.CAUTION, Effect.NONE,
            "The process was not steady: Cp and Cpk say what it could do, not what it does."),
    Finding("study.not_normal", Weight.CAUTION, Effect.NONE,
            "The values are not normally distributed (Anderson–Darling test, 5 %), as the indices and their "
            "intervals assume."),
    # Acceptance
    Finding("study.after_the_guideline", Weight.INFORMATION, Effect.NONE,
            "Acceptance check after the pattern of VDI/VDE 2634 part 2; not a certificate."),
    Finding("study.few_positions", Weight.CAUTION, Effect.NONE,
            "{what}: {n} of the {all} positions the guideline asks for."),
    Finding("study.artefact_without_u", Weight.GRAVE, Effect.NO_PROOF,
            "{what}: no uncertainty of the artefact was stated, so it proves nothing.", fact="artefact_without_u"),
)  # fmt: skip
