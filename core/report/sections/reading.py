"""How to read the report: what its letters and its table of uncertainties mean, for a reader who did not measure."""

from __future__ import annotations

from reportlab.platypus import Flowable

from core.messages import label
from core.report.content import ReportContent
from core.report.layout.blocks import GAP, pairs_table, section, side_by_side
from core.report.layout.style import TEXT_WIDTH, ReportLook
from core.states import DECISIONS

TERM = 24 * 72 / 25.4
"""Width of the column of terms, in points."""

OF_RESULTS = {
    "± U, k": label(
        "The value lies within ± U = k·u, with k = 2 in about 95 of 100 cases; u is the standard uncertainty."
    ),
    DECISIONS["conforming"]: label("The deviation stays within the tolerance even when it is enlarged by U."),
    DECISIONS["not conforming"]: label("It is outside the tolerance even when it is made smaller by U."),
    DECISIONS["not proven"]: label("U is too large to tell, or something that is needed for a proof is not known."),
}
OF_BUDGETS = {
    label("value, u(x)"): label("Best estimate of an input, and its standard uncertainty, both in its own unit."),
    label("sensitivity"): label("How much of u(x) arrives in the result; “u of it” is that amount."),
    label("share"): label("What part of u² of the result an input has. All contributions, squared, add up to u²."),
    "ν": label("Degrees of freedom: from how many independent observations u(x) is known; ∞ where it is stated."),
    "ν_eff": label("Effective degrees of freedom of u, by Welch and Satterthwaite. Where they are few, k is above 2."),
}
OF_CALIBRATIONS = {
    "α, β": label("Focal length of the camera in pixels, along the rows and along the columns of the picture."),
    "γ": label("Skew: by how much the axes of the picture are not at right angles, in pixels."),
    "u₀, v₀": label("Where the axis of the lens meets the picture, in pixels."),
    "k₁, k₂, p₁, p₂": label("Distortion of the lens: radial and tangential."),
    label("normal, d"): label("Direction at right angles to a plane of light; its distance from the camera."),
    "σ": label("Standard uncertainty of the depth of one measured point."),
    "SHA-256": label("Fingerprint of a file: if anything in the file changes, so does this number."),
}
OF_ARTEFACTS = {"E_n": label("Error over the expanded uncertainty of measurement and certificate; up to 1 is good.")}


def reading(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the section that explains the report's terms: results and budgets left, calibrations right."""
    shown = content.printable.keys() - content.hidden
    left = (OF_RESULTS if content.characteristics else {}) | (OF_BUDGETS if "budget" in shown else {})
    right = (OF_CALIBRATIONS if "calibrations" in shown else {}) | (OF_ARTEFACTS if "artefacts" in shown else {})
    if not left and not right:
        return []
    width, words = (TEXT_WIDTH - GAP) / 2, look.words
    columns = [
        pairs_table(look, {words(term): words(text) for term, text in terms.items()}, width, TERM)
        for terms in (left, right)
        if terms
    ]
    body: list[Flowable] = columns if len(columns) == 1 else [side_by_side([columns[0]], [columns[1]], TEXT_WIDTH)]
    return [section(look, "reading", "How to read this report", body)]
