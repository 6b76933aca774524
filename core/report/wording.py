"""Words and numbers of the report in its language: rounding by the uncertainty, the verdict, what is not covered."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import date, datetime
from decimal import ROUND_HALF_EVEN, Decimal

from core import messages
from core.image.targets import Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.inspect.characteristic import Characteristic, thickness_characteristic
from core.inspect.conformity import Verdict
from core.inspect.results import GaugeResult
from core.messages import NO_BREAK_SPACE, Language, Message, capital, decimals_of, label, plain, plural_message
from core.states import DECISIONS
from core.translations import language

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, slots=True)
class Words:
    """Words of one language and the numbers of a report in it: `words("{n} of {m} used", n=3, m=5)`."""

    language: Language = messages.ENGLISH

    @classmethod
    def of(cls, name: str) -> Words:
        """Load the words of the language called `name`, as "de"."""
        return cls(language(name))

    def __call__(self, said: str | Message, /, **values: object) -> str:
        """Fixed words, their places filled with `values`, or a message."""
        return self.language(said) if isinstance(said, Message) else self.language.label(said, **values)

    def known(self, said: str | Message) -> str:
        """Translate a message or fixed words of another module; a name, which is in no catalogue, stays as it is."""
        return self.language(said) if isinstance(said, Message) and said.code else self.language.label(str(said))

    def fixed(self, value: float, decimals: int, *, signed: bool = False) -> str:
        """Format `value` with `decimals` decimals, a true minus sign and no minus zero; `signed`: with its sign.

        With negative decimals it is rounded to tens, hundreds.
        """
        if not math.isfinite(value):
            return self("unknown")
        step = Decimal(1).scaleb(-decimals)
        rounded = Decimal(repr(float(value))).quantize(step, rounding=ROUND_HALF_EVEN)
        if rounded == 0:
            rounded = abs(rounded)
        return self.numeral(f"{rounded:+f}" if signed and rounded != 0 else f"{rounded:f}")

    def general(self, value: float) -> str:
        """Format a number to at most six significant digits, with a power of ten if very small or large."""
        digits, _, power = f"{value:g}".partition("e")
        return self.numeral(digits) + (f"·10{str(int(power)).translate(RAISED)}" if power else "")

    def joined(self, texts: Sequence[str], how: str = "") -> str:
        """Join texts to a list by commas; `how` ";" joins by semicolons, and "and" puts "and" before the last."""
        return self.language.joined(texts, how)

    def in_unit(self, quantity: str, unit: str) -> str:
        """Write the heading of a column or an axis, the quantity and its unit: 'height, mm'."""
        return self.language.label("{quantity}, {unit}", quantity=quantity, unit=unit)

    def time(self, at: datetime, *, seconds: bool = False) -> str:
        """Format date and time of day in the time zone of `at`; with seconds if `seconds`."""
        return self.language.time(at, seconds=seconds)

    def day(self, on: date) -> str:
        """Format a date, without the time of day."""
        return self.language.day(on)

    def numeral(self, digits: str) -> str:
        """Convert a number's digits to the language's decimal sign and a true minus sign."""
        return self.language.numeral(digits)


ENGLISH = Words()


SHORT_HASH = 12
"""Hex digits of a hash that name a file where the whole of it is kept beside the report."""


def short_hash(digest: str) -> str:
    """Shorten a hash to its first characters: '522c08e52394…'."""
    return f"{digest[:SHORT_HASH]}…"


def points_counted(number: int) -> Message:
    """Make the message on a number of points: '1 204 points'."""
    return plural_message("report.points", "{n:,} point", "{n:,} points", n=number)


def grouped(number: int) -> str:
    """Format an integer with no-break spaces between groups of three digits."""
    return f"{number:,}".replace(",", NO_BREAK_SPACE)


__all__ = ["grouped"]

COVERAGE = {1.0: "68", 2.0: "95", 3.0: "99.7"}
"""Coverage of a normal distribution in %, for the factors k in common use."""

SIGNS = {Verdict.CONFORMING: "✓", Verdict.NOT_CONFORMING: "✗", Verdict.NOT_PROVEN: "?", Verdict.NONE: "–"}
"""Of each verdict: it is never told by colour alone."""


def fixed(value: float, decimals: int, *, signed: bool = False) -> str:
    """Format `value` in English with `decimals` decimals, a true minus sign and no minus zero."""
    return ENGLISH.fixed(value, decimals, signed=signed)


def with_uncertainty(value: float, uncertainty: float, words: Words = ENGLISH) -> tuple[str, str]:
    """Format a value and its uncertainty with the same decimals, the uncertainty to two significant digits."""
    decimals = decimals_of(uncertainty)
    return words.fixed(value, decimals), words.fixed(uncertainty, decimals)


def count(number: int, noun: str) -> str:
    """Write a number with an English noun: '1 frame', '1 204 frames'."""
    return f"{grouped(number)} {noun}{'' if number == 1 else 's'}"


def thickness_line(gauge: GaugeResult, words: Words = ENGLISH) -> str:
    """Write a thickness with its U: '50.012 mm ± 0.024 mm (k = 2)'."""
    return " ".join(_parts(gauge.thickness_mm, gauge.U_mm, gauge.k, "mm", words))


def value_line(one: Characteristic, words: Words = ENGLISH) -> str:
    """Write a characteristic's value with its U: '50.012 mm ± 0.024 mm (k = 2)'; angles in degrees."""
    return " ".join(value_parts(one, words))


def value_parts(one: Characteristic, words: Words = ENGLISH) -> tuple[str, str]:
    """Write a value with its U as two texts: '50.012 mm ± 0.024 mm', and '(k = 2)' or that U is not known."""
    unit, factor = shown_unit(one)
    return _parts(factor * one.value, factor * one.U, one.k, unit, words)


def shown_name(one: Characteristic, words: Words = ENGLISH) -> str:
    """Write the name of a characteristic with its kind translated: "top flatness", "stairs height 2"."""
    return words(result_name(one))


def result_name(one: Characteristic) -> Message:
    """Make the name of a characteristic as a message, in which the kind is translated."""
    feature, kind, number = one.name.rpartition(one.kind)
    if not kind or not re.fullmatch(r"(.* )?", feature) or not re.fullmatch(r"( \d+)?", number):
        return plain(one.name)  # somebody's own name, as of a cut
    return Message("report.result_name", "{feature}{kind}{number}", feature=feature, kind=label(kind), number=number)


def name_within(one: Characteristic, feature: str, words: Words = ENGLISH) -> str:
    """Write the name of a characteristic without its feature's: "flatness", "height 2", or the name a user gave it."""
    own = one.name.removeprefix(f"{feature} ")
    return words(result_name(replace(one, name=own)))


def headed_name(one: Characteristic, words: Words = ENGLISH) -> str:
    """Write the name of a characteristic for the start of a line: "Thickness"; a feature's name stays as typed."""
    shown = shown_name(one, words)
    return capital(shown) if one.name.startswith(one.kind) else shown


def verdict_title(verdict: str, words: Words = ENGLISH) -> str:
    """Write a verdict as a title: "Not conforming"."""
    return capital(words(DECISIONS[verdict]))


def shown_unit(one: Characteristic) -> tuple[str, float]:
    """Return the unit a characteristic is printed in, and the factor from its value's unit to that unit."""
    return ("°", math.degrees(1.0)) if one.quantity == "angle" else ("mm", 1.0)


def with_unit(shown: str, unit: str, space: str = "\u00a0") -> str:
    """Write a number with its unit, without a line break between them: '0.02 mm', '90°'."""
    return f"{shown}{unit}" if unit == "°" else f"{shown}{space}{unit}"


def unbroken(text: str) -> str:
    """Replace the spaces of a text by no-break spaces."""
    return text.replace(" ", NO_BREAK_SPACE)


def _parts(value: float, U: float, k: float, unit: str, words: Words) -> tuple[str, str]:
    if not math.isfinite(U):
        return with_unit(words.fixed(value, 3), unit, " "), f"({words('uncertainty unknown')})"
    decimals = decimals_of(U)
    value_shown, U_shown = (with_unit(words.fixed(one, decimals), unit, " ") for one in (value, U))
    return f"{value_shown} ± {U_shown}", f"(k = {words.general(k)})"


def uncertainty_sentence(k: float, U: float, words: Words = ENGLISH) -> str:
    """Write the sentence that explains what ± means: U = k·u, its coverage, and u; or that there is no uncertainty."""
    if not math.isfinite(U):
        return words("Without an uncertainty the value is no complete result of a measurement.")
    coverage = COVERAGE.get(float(k))
    meaning = words("± is the expanded uncertainty U = k·u with k = {k}", k=words.general(k))
    if coverage:
        share = words.numeral(coverage)
        meaning += words(", which covers about {share} % of a normal distribution", share=share)
    return meaning + words("; u is the combined standard uncertainty.")


PROVES_NOTHING = label(
    "Neither conformity nor non-conformity is proven, whatever the uncertainty says: the notes tell why."
)


def verdict_sentence(gauge: GaugeResult, words: Words = ENGLISH) -> str:
    """Write why a thickness has its verdict (ISO 14253-1), with the numbers that decide."""
    if gauge.limits is None:
        return words("No nominal value with a tolerance was given, so the thickness is stated without a verdict.")
    return decision_sentence(thickness_characteristic(gauge), words)


def decision_sentence(one: Characteristic, words: Words = ENGLISH) -> str:
    """Write why a characteristic has its verdict (ISO 14253-1), with the numbers that decide."""
    if one.limits is None or one.deviation is None:
        return words("No nominal value with a tolerance was given, so the result is stated without a verdict.")
    if one.doubts:
        return words(PROVES_NOTHING)
    unit, factor = shown_unit(one)
    deviation = factor * one.deviation
    return _reason(one.verdict, deviation, factor * one.U, tolerance_words(one, words), unit, words)


def tolerance_words(one: Characteristic, words: Words = ENGLISH) -> str:
    """Write the permitted deviations: '±0.2 mm', '−0.1 to +0.3 mm', 'at most +0.05 mm'; "" without limits."""
    allowed = permitted(one)
    return "" if allowed is None else words(allowed)


def permitted(one: Characteristic) -> Message | None:
    """Make the message on a characteristic's permitted deviations; None without any finite limit."""
    unit, factor = shown_unit(one)
    if one.limits is None:
        return None
    low, high = factor * one.limits.lower, factor * one.limits.upper
    end = with_unit("", unit)
    if math.isinf(low) and math.isinf(high):
        return None
    if math.isinf(low):
        if not one.limits.nominal:  # of a form: the largest there may be
            return Message("told.at_most", "at most {limit:g}{unit}", limit=high, unit=end)
        return Message("told.below", "at most {limit}{unit}", limit=_signed(high), unit=end)
    if math.isinf(high):
        return Message("told.above", "at least {limit}{unit}", limit=_signed(low), unit=end)
    if math.isclose(-low, high):
        return Message("told.within", "±{limit:g}{unit}", limit=high, unit=end)
    return Message("told.between", "{low} to {high}{unit}", low=_signed(low), high=_signed(high), unit=end)


def _signed(value: float) -> Message:
    return Message("told.signed", "{value:+g}", value=value) if value else plain("0")


def _reason(verdict: Verdict, deviation: float, U: float, tolerance: str, unit: str, words: Words) -> str:
    if not math.isfinite(U):
        return words("The uncertainty is unknown, so neither conformity nor non-conformity is proven.")
    decimals = max(decimals_of(U), 0)
    shown = {
        "deviation": with_unit(words.fixed(abs(deviation), decimals), unit, " "),
        "U": with_unit(words.fixed(U, decimals), unit, " "),
        "tolerance": tolerance,
    }
    if verdict == Verdict.CONFORMING:
        return words(
            "Conformity is proven: the deviation of {deviation} from the nominal value, enlarged by U = {U}, stays "
            "within the tolerance of {tolerance}.",
            **shown,
        )
    if verdict == Verdict.NOT_CONFORMING:
        return words(
            "Non-conformity is proven: the deviation of {deviation} from the nominal value, even lessened by U = {U}, "
            "is outside the tolerance of {tolerance}.",
            **shown,
        )
    return words(
        "Neither conformity nor non-conformity is proven: a limit of the tolerance of {tolerance} lies inside the "
        "interval of {deviation} ± {U} (deviation and U). A smaller uncertainty is needed for a verdict.",
        **shown,
    )


def limits_of_thickness(
    gauge: GaugeResult, words: Words = ENGLISH, *, temperatures: bool = False, corrected: bool = False
) -> tuple[str, ...]:
    """List in sentences what a thickness does not cover; `temperatures`: whether temperatures are stated.

    `corrected`: whether it is stated at 20 °C.
    """
    rule = words(gauge.rule or label("distance of two parallel planes fitted to the points of both faces"))
    return (
        words(
            "The thickness is the {rule}. It is no local length: form deviations of the faces are stated apart, as "
            "flatness.",
            rule=rule,
        ),
        words(
            "The result rests on one scan. Repeatability over several scans is in it only where the uncertainty "
            "budget names it."
        ),
        _temperatures_used(words) if corrected else limit_of_temperature(temperatures, words),
        words("Faces turned away from the camera or in the shadow of a laser were not measured."),
    )


def limits_of_inspection(
    words: Words = ENGLISH, *, temperatures: bool = False, corrected: bool = False
) -> tuple[str, ...]:
    """List in sentences what a plan's results do not cover; `corrected`: whether a length is stated at 20 °C."""
    return (
        words("Each result is what its rule says, of the points that were measured; it is no local length."),
        words(
            "The result rests on one scan. Repeatability over several scans is in it only where the uncertainty "
            "budget names it."
        ),
        words(
            "The verdicts are given one by one: that all characteristics together conform is less probable than that "
            "each does."
        ),
        _temperatures_used(words) if corrected else limit_of_temperature(temperatures, words),
        words("Surfaces turned away from the camera or in the shadow of a laser were not measured."),
    )


def limits_of_cloud(words: Words = ENGLISH, *, temperatures: bool = False) -> tuple[str, ...]:
    """List in sentences what a measured cloud does not cover; `temperatures`: whether temperatures are stated."""
    return (
        words(
            "The σ of a point is the standard uncertainty of its depth within this scan. What is common to all points "
            "(camera, fan) comes on top and is not in it."
        ),
        limit_of_temperature(temperatures, words),
        words("Surfaces turned away from the camera or in the shadow of a laser were not measured."),
    )


def _temperatures_used(words: Words) -> str:
    return words(
        "Lengths are stated at 20 °C only where a note of theirs says so; the temperatures used are those that are "
        "stated of the part."
    )


def limit_of_temperature(stated: bool, words: Words = ENGLISH) -> str:
    """Write that nothing is corrected to 20 °C, and where temperatures, if `stated`, come from."""
    if stated:
        return words("Temperatures are those the operator stated; nothing is corrected to 20 °C.")
    return words("Temperature was not measured; nothing is corrected to 20 °C.")


def temperatures_line(
    air_celsius: float | None, part_celsius: float | None, words: Words = ENGLISH, *, corrected: bool = False
) -> str:
    """Write the temperatures in °C: 'air 20.4 °C, part 21.0 °C; no correction to 20 °C was made'; "" without.

    The note on the correction is left out if `corrected`.
    """
    known = {label("air {value}"): air_celsius, label("part {value}"): part_celsius}
    shown = [words(name, value=f"{words.fixed(value, 1)} °C") for name, value in known.items() if value is not None]
    if not shown or corrected:
        return words.joined(shown)
    return words.joined([words.joined(shown), words("no correction to 20 °C was made")], ";")


def target_in_words(target: Target, words: Words = ENGLISH) -> str:
    """Describe a calibration target: 'checkerboard, 17 × 12 inner corners, 10 mm'."""
    if isinstance(target, Checkerboard):
        corners = words("inner corners")
        size = f"{words.general(target.square_mm)} mm"
        return words.joined([words("checkerboard"), f"{target.columns} × {target.rows} {corners}", size])
    if isinstance(target, Charuco):
        return words(
            "ChArUco board, {columns} × {rows} squares of {square} mm, markers {marker} mm",
            columns=target.columns,
            rows=target.rows,
            square=words.general(target.square_mm),
            marker=words.general(target.marker_mm),
        )
    if isinstance(target, CircleGrid):
        kind = words("asymmetric circle grid" if target.asymmetric else "circle grid")
        pitch = f"{words('pitch')} {words.general(target.pitch_mm)} mm"
        return words.joined([kind, f"{target.columns} × {target.rows}", pitch])
    if isinstance(target, Rectangle):
        kind = words("outlined rectangle" if target.line_mm else "dark rectangle")
        size = f"{words.general(target.width_mm)} × {words.general(target.height_mm)} mm"
        return words.joined([kind, size])
    return words.joined([words("black square"), f"{words('side')} {words.general(target.side_mm)} mm"])
