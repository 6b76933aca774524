"""Numbers and sentences of the report: rounding by the uncertainty, the verdict in words, what is not covered."""

from __future__ import annotations

import math
from decimal import ROUND_HALF_EVEN, Decimal

from core.image.targets import Charuco, Checkerboard, CircleGrid, Target
from core.inspect.results import GaugeResult

COVERAGE = {1.0: "68 %", 2.0: "95 %", 3.0: "99.7 %"}
"""Coverage of a normal distribution, for the factors k in common use."""

VERDICTS = {
    "conforming": "Conforming",
    "not conforming": "Not conforming",
    "not proven": "Not proven",
    "": "No verdict",
}


def decimals_of(uncertainty: float) -> int:
    """Decimals that show `uncertainty` with two significant digits (GUM 7.2.6); 3 if it is not a positive number."""
    if not math.isfinite(uncertainty) or uncertainty <= 0:
        return 3
    exponent = int(f"{uncertainty:.1e}".partition("e")[2])  # after rounding: 0.0996 is shown as 0.10
    return 1 - exponent


def fixed(value: float, decimals: int, *, signed: bool = False) -> str:
    """`value` with so many decimals (negative: rounded to tens, hundreds), true minus sign, no minus zero."""
    if not math.isfinite(value):
        return "unknown"
    step = Decimal(1).scaleb(-decimals)
    rounded = Decimal(repr(float(value))).quantize(step, rounding=ROUND_HALF_EVEN)
    if rounded == 0:
        rounded = abs(rounded)
    text = f"{rounded:+f}" if signed and rounded != 0 else f"{rounded:f}"
    return text.replace("-", "−")


def with_uncertainty(value: float, uncertainty: float) -> tuple[str, str]:
    """Value and uncertainty rounded alike, the uncertainty to two significant digits."""
    decimals = decimals_of(uncertainty)
    return fixed(value, decimals), fixed(uncertainty, decimals)


def count(number: int, noun: str) -> str:
    """'1 frame', '1 204 frames' (no-break spaces between thousands)."""
    plural = "" if number == 1 else "s"
    return f"{grouped(number)} {noun}{plural}"


def grouped(number: int) -> str:
    """An integer with no-break spaces between thousands."""
    return f"{number:,}".replace(",", "\u00a0")


def thickness_line(gauge: GaugeResult) -> str:
    """'50.012 mm ± 0.024 mm (k = 2)'."""
    if not math.isfinite(gauge.U_mm):
        return f"{fixed(gauge.thickness_mm, 3)} mm (uncertainty unknown)"
    value, uncertainty = with_uncertainty(gauge.thickness_mm, gauge.U_mm)
    return f"{value} mm ± {uncertainty} mm (k = {gauge.k:g})"


def uncertainty_sentence(gauge: GaugeResult) -> str:
    """What the number behind ± means."""
    if not math.isfinite(gauge.U_mm):
        return "Without an uncertainty the value is no complete result of a measurement."
    coverage = COVERAGE.get(float(gauge.k))
    about = f", which covers about {coverage} of a normal distribution" if coverage else ""
    return f"± is the expanded uncertainty U = k·u with k = {gauge.k:g}{about}; u is the combined standard uncertainty."


def verdict_sentence(gauge: GaugeResult) -> str:
    """Why the verdict is what it is (ISO 14253-1), with the numbers that decide."""
    if not gauge.verdict or gauge.nominal_mm is None or gauge.tolerance_mm is None or gauge.deviation_mm is None:
        return "No nominal value with a tolerance was given, so the thickness is stated without a verdict."
    if not math.isfinite(gauge.U_mm):
        return "The uncertainty is unknown, so neither conformity nor non-conformity is proven."
    decimals = max(decimals_of(gauge.U_mm), 0)
    deviation = fixed(abs(gauge.deviation_mm), decimals)
    U = fixed(gauge.U_mm, decimals)
    tolerance = f"{gauge.tolerance_mm:g}"
    span = f"the deviation of {deviation} mm from the nominal value"
    if gauge.verdict == "conforming":
        return f"Conformity is proven: {span}, enlarged by U = {U} mm, stays within the tolerance of ±{tolerance} mm."
    if gauge.verdict == "not conforming":
        return (
            f"Non-conformity is proven: {span}, even lessened by U = {U} mm, "
            f"is outside the tolerance of ±{tolerance} mm."
        )
    return (
        f"Neither conformity nor non-conformity is proven: a limit of the tolerance of ±{tolerance} mm lies inside the "
        f"interval of {deviation} mm ± {U} mm (deviation and U). A smaller uncertainty is needed for a decision."
    )


def limits_of_thickness(gauge: GaugeResult, *, temperatures: bool = False) -> tuple[str, ...]:
    """What no thickness of this instrument covers; `temperatures`: whether somebody stated them."""
    rule = gauge.rule or "distance of two parallel planes fitted to the points of both faces"
    return (
        f"The thickness is the {rule}. It is no local length: form deviations of the faces are stated apart, as "
        "flatness.",
        "The result rests on one scan. Repeatability over several scans is in it only where the uncertainty "
        "budget names it.",
        limit_of_temperature(temperatures),
        "Faces turned away from the camera or in the shadow of a laser were not measured.",
    )


def limits_of_cloud(*, temperatures: bool = False) -> tuple[str, ...]:
    """What no cloud of this instrument covers; `temperatures`: whether somebody stated them."""
    return (
        "The σ of a point is the standard uncertainty of its depth within this scan. What is common to all points "
        "(camera, fan) comes on top and is not in it.",
        limit_of_temperature(temperatures),
        "Surfaces turned away from the camera or in the shadow of a laser were not measured.",
    )


def limit_of_temperature(stated: bool) -> str:
    """What a temperature, stated or not, did not do."""
    if stated:
        return "Temperatures are those the operator stated; nothing is corrected to 20 °C."
    return "Temperature was not measured; nothing is corrected to 20 °C."


def temperatures_line(air_celsius: float | None, part_celsius: float | None) -> str:
    """'air 20.4 °C, part 21.0 °C; not corrected to 20 °C', or nothing where neither is known."""
    known = {"air": air_celsius, "part": part_celsius}
    words = [f"{name} {fixed(value, 1)} °C" for name, value in known.items() if value is not None]
    return f"{', '.join(words)}; no correction to 20 °C was made" if words else ""


def target_in_words(target: Target) -> str:
    """'checkerboard, 17 × 12 inner corners, 10 mm'."""
    if isinstance(target, Checkerboard):
        return f"checkerboard, {target.columns} × {target.rows} inner corners, {target.square_mm:g} mm"
    if isinstance(target, Charuco):
        return (
            f"ChArUco board, {target.columns} × {target.rows} squares of {target.square_mm:g} mm, "
            f"markers {target.marker_mm:g} mm"
        )
    if isinstance(target, CircleGrid):
        kind = "asymmetric circle grid" if target.asymmetric else "circle grid"
        return f"{kind}, {target.columns} × {target.rows}, pitch {target.pitch_mm:g} mm"
    return f"black square, side {target.side_mm:g} mm"
