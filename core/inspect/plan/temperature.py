"""Lengths at 20 °C, and lengths compared with a known one.

A part of expansion coefficient α that is θ away from 20 °C is longer by αθ than the length that drawings mean
(ISO 1: 20 °C). So the length at 20 °C is::

    L20 = L (1 − αθ + α_s θ_s)          u² = L² (θ² u_α² + α² u_θ²)

with α_s, θ_s of the measuring scale, which here is the printed calibration target: it was longer by α_s θ_s too when
the camera was calibrated with it, and everything measured with it is smaller by as much.

A master block measured in the same way shows what the rig gets wrong now: the part is longer than the master by as much
as both were measured to differ, plus what the certificate says (substitution, as in GUM H.1).

References
----------
JCGM 100:2008 (GUM), H.1 End-gauge calibration. ISO 1:2022, standard reference temperature.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from core.findings.table import note_of
from core.inspect.causes import CALIBRATIONS, OF_BOARDS, OF_TARGET, Cause
from core.inspect.characteristic import Characteristic
from core.inspect.plan.conditions import REFERENCE_C, Master, Temperature
from core.inspect.plan.kinds import expands
from core.inspect.results import Contribution
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.coverage import student_factor
from core.inspect.uncertainty.part import Part, TargetTemperature
from core.messages import Message

ALIKE = 0.2
"""A master is of use to lengths that differ from its own by no more than this share of it."""


def at_reference(length: Characteristic, temperature: Temperature, k: float) -> Characteristic:
    """Convert a measured length to 20 °C, add the rows for temperatures and expansion to its budget, and a note.

    Form, angles and everything else that does not grow with the part is returned as it is. `k` is the coverage factor
    where u is known.

    Examples
    --------
    >>> hot = Temperature(part_celsius=30.0, u_part_celsius=0.5, alpha=11.5e-6, u_alpha=1e-6)
    >>> cold = at_reference(Characteristic("bar", "thickness", 100.0, 0.001, doubts=()), hot, 2.0)
    >>> round(cold.value, 6), [round(row.u_mm, 6) for row in cold.budget]
    (99.9885, [0.000575, 0.001])
    """
    if not expands(length):
        return length
    change, rows, notes = correction_to_reference(length.value, temperature)
    return replace(
        length,
        value=length.value + change,
        u=math.hypot(length.u, combined(rows)),
        k=student_factor(k, (*length.budget, *rows)),
        budget=(*length.budget, *rows),
        notes=(*length.notes, *notes),
        at_20=not temperature.celsius_assumed,
    )


def correction_to_reference(
    length_mm: float, temperature: Temperature
) -> tuple[float, tuple[Contribution, ...], tuple[Message, ...]]:
    """Compute the correction in mm of a length to 20 °C, the rows it adds to the uncertainty budget, and notes on it.

    Nothing is said of a temperature that is assumed: nothing is added then.
    """
    rows = temperature_contributions(length_mm, temperature)
    by_scale = length_mm * temperature.scale_alpha * (temperature.scale_celsius - REFERENCE_C)
    change = by_scale - length_mm * temperature.alpha * (temperature.part_celsius - REFERENCE_C)
    if temperature.celsius_assumed:
        return change, rows, (_of_scale_alone(by_scale, temperature.scale_celsius),) if by_scale else ()
    note = note_of("feature.stated_at_20", change_um=change * 1000, part_celsius=temperature.part_celsius)
    return change, rows, (note,)


def _of_scale_alone(change_mm: float, celsius: float) -> Message:
    return note_of("feature.scale_at_20", change_um=change_mm * 1000, celsius=celsius)


def temperature_of(part: Part) -> Temperature | None:
    """Make the temperatures and expansions of part and scale, assumed if not stated; None if surely at 20 °C."""
    alpha, u_alpha = part.expansion
    celsius, u_celsius, assumed = part.warmth
    known = Temperature(
        celsius, u_celsius, alpha, u_alpha, celsius_assumed=assumed, alpha_assumed=part.expansion_assumed
    )
    known = with_scale(known, part.target)
    at_20 = known.part_celsius == known.scale_celsius == REFERENCE_C
    return None if at_20 and not known.u_part_celsius and not known.u_scale_celsius else known


def with_scale(temperature: Temperature, target: TargetTemperature) -> Temperature:
    """Fill in the temperature and expansion of the scale from those of the plane target, where they are missing."""
    if temperature.scale_alpha or temperature.u_scale_alpha:
        return temperature
    alpha, u_alpha = target.expansion
    if temperature.scale_celsius != REFERENCE_C or temperature.u_scale_celsius:
        return replace(temperature, scale_alpha=alpha, u_scale_alpha=u_alpha, scale_alpha_assumed=target.alpha is None)
    celsius, u_celsius, assumed = target.warmth
    return replace(
        temperature,
        scale_celsius=celsius,
        u_scale_celsius=u_celsius,
        scale_alpha=alpha,
        u_scale_alpha=u_alpha,
        scale_celsius_assumed=assumed,
        scale_alpha_assumed=target.alpha is None,
    )


def larger_by_warmth(target: TargetTemperature) -> tuple[float, float]:
    """Compute by what share a target is larger than at 20 °C, and the standard uncertainty of that share."""
    (alpha, u_alpha), warmth = target.expansion, target.warmth
    above = warmth.celsius - REFERENCE_C
    return alpha * above, math.hypot(alpha * warmth.u_celsius, above * u_alpha)


def temperature_contributions(length_mm: float, temperature: Temperature) -> tuple[Contribution, ...]:
    """Compute the budget rows of temperatures and expansion coefficients for a length at 20 °C; no zero rows."""
    part, scale = temperature.part_celsius - REFERENCE_C, temperature.scale_celsius - REFERENCE_C
    of_celsius = Cause.PART_TEMPERATURE_ASSUMED if temperature.celsius_assumed else Cause.PART_TEMPERATURE
    of_alpha = Cause.PART_EXPANSION_ASSUMED if temperature.alpha_assumed else Cause.PART_EXPANSION
    of_scale = Cause.SCALE_TEMPERATURE_ASSUMED if temperature.scale_celsius_assumed else Cause.SCALE_TEMPERATURE
    of_scale_alpha = Cause.SCALE_EXPANSION_ASSUMED if temperature.scale_alpha_assumed else Cause.SCALE_EXPANSION
    rows = (
        (of_celsius, temperature.part_celsius, temperature.u_part_celsius, temperature.alpha, "°C"),
        (of_alpha, temperature.alpha, temperature.u_alpha, part, "1/K"),
        (of_scale, temperature.scale_celsius, temperature.u_scale_celsius, temperature.scale_alpha, "°C"),
        (of_scale_alpha, temperature.scale_alpha, temperature.u_scale_alpha, scale, "1/K"),
    )
    return tuple(
        Contribution(source, abs(length_mm * sensitivity * u), u, value=value, unit=unit)
        for source, value, u, sensitivity, unit in rows
        if u and sensitivity
    )


def compared(length: Characteristic, master: Master, k: float) -> Characteristic:
    """Correct a measured length by a master of the same size: certified + (measured − master measured).

    What camera and fan get wrong is the same for both if one calibration measured both, so of each such cause only the
    difference stays; everything else of both measurements and the certificate adds up. A length that differs from the
    master's by more than a fifth is returned as it is, with a note. `k` is the coverage factor where u is known.
    """
    if not expands(length):
        return length
    if abs(length.value - master.measured_mm) > ALIKE * master.measured_mm:
        note = note_of("feature.master_too_different", master=master.name, certified_mm=master.certified_mm)
        return replace(length, notes=(*length.notes, note))
    correction = master.certified_mm - master.measured_mm
    rows = _difference(length.budget, master)
    note = note_of("feature.compared_with_master", master=master.name, correction_um=correction * 1000)
    return replace(
        length,
        value=length.value + correction,
        u=combined(rows),
        k=student_factor(k, rows),
        budget=rows,
        notes=(*length.notes, note),
    )


def _difference(budget: Sequence[Contribution], master: Master) -> tuple[Contribution, ...]:
    """The budget of a part's length less the master's."""
    of_master = dict(master.budget)
    rows = []
    alike = (cause for cause in (*CALIBRATIONS.values(), *OF_TARGET) if cause not in OF_BOARDS)
    cancelling = tuple(alike) if master.same_calibration else ()
    own = [u for source, u in master.budget if source not in cancelling]
    for row in budget:
        cancels = row.source in cancelling
        rows.append(replace(row, u_mm=abs(row.u_mm - of_master.get(row.source, 0.0))) if cancels else row)
    measured = math.hypot(*own) if own else 0.0
    rows.append(Contribution(Cause.MASTER_MEASURED, measured, measured, value=master.measured_mm))
    rows.append(
        Contribution(Cause.CERTIFICATE, master.u_certified_mm, master.u_certified_mm, value=master.certified_mm)
    )
    return tuple(rows)
