"""Findings of checks by an artefact."""

from __future__ import annotations

from core.findings.finding import Effect, Finding, Weight

ROWS = (
    Finding("artefact.passed", Weight.INFORMATION, Effect.NONE,
            "{id} is measured to {error_mm:+.3f} mm (E_n = {e_n:.2f}), as its certificate and the uncertainty allow."),
    Finding("artefact.lapsed", Weight.CAUTION, Effect.NONE,
            "{id} is measured to {error_mm:+.3f} mm (E_n = {e_n:.2f}), but its certificate holds only until {due}: "
            "have it calibrated."),
    Finding("artefact.doubted", Weight.CAUTION, Effect.NONE,
            "{id} is measured to {error_mm:+.3f} mm (E_n = {e_n:.2f}), but by its own result that proves nothing "
            "({why:;}): measure it again."),
    Finding("artefact.failed", Weight.GRAVE, Effect.NO_PROOF,
            "{id} is measured wrong by {error_mm:+.3f} mm (E_n = {e_n:.2f}, above 1): look for what changed, and "
            "calibrate again.", fact="check_failed"),
)  # fmt: skip
