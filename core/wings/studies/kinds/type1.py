"""The type-1 gauge study: one reference part measured again and again; is the gauge fit for a tolerance?

References
----------
Bosch, Booklet 10, Capability of measurement and test processes, procedure 1 (Cg, Cgk, limit 1.33, resolution at most
5 % of T). AIAG, Measurement systems analysis, 4th ed., chapter III-B (t-test on the bias).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.special import chdtri, stdtr, stdtrit

from core.errors import WrongValue
from core.findings.proof import notes_of
from core.findings.table import note_of
from core.messages import Message
from core.model.arrays import Array
from core.wings.studies.kinds.doubted import Doubted, doubts_of_study

Capability: TypeAlias = Literal["capable", "not capable", "not proven"]
CAPABLE, NOT_CAPABLE = get_args(Capability)[:2]
LIMIT = 1.33
"""What Cg and Cgk must reach."""
RESOLUTION_SHARE = 0.05
"""Of the tolerance: what the resolution may be at most."""
SIGNIFICANCE = 0.05
"""Level of the t-test, and of the intervals: 95 %."""
FEW_MEASUREMENTS = 25
"""Repeats below which a study says little; 50 are usual."""


@dataclass(frozen=True, eq=False, slots=True)
class Type1Study:
    """Type-1 study: how well a reference part is measured, against a tolerance of full width T.

    Parameters
    ----------
    values
        (n,) in the order of measuring.
    reference
        The part's calibrated value.
    tolerance
        T = upper − lower limit: the full width, twice a ± tolerance.
    mean, s
        Of the values; s over n − 1.
    bias
        mean − reference.
    cg, cgk
        0.2 T / (6 s) and (0.1 T − |bias|) / (3 s); inf if all values are the same.
    cg_interval
        95 % confidence interval of Cg, from χ² of s.
    t, p
        Statistic of the bias against zero, and how probable one as large is without any bias (two-sided).
    bias_interval
        95 % confidence interval of the bias.
    resolution
        Of the gauge; None if it is not stated.
    unit
        Of all values.
    doubted
        Repeats whose results prove nothing: nor does the study.
    """

    values: Array
    reference: float
    tolerance: float
    mean: float
    s: float
    bias: float
    cg: float
    cgk: float
    cg_interval: tuple[float, float]
    t: float
    p: float
    bias_interval: tuple[float, float]
    resolution: float | None = None
    unit: str = "mm"
    doubted: Doubted = ()

    @property
    def n(self) -> int:
        """Number of repeats in the study."""
        return len(self.values)

    @property
    def dof(self) -> int:
        """Degrees of freedom of the standard deviation s, n − 1."""
        return self.n - 1

    @property
    def bias_is_significant(self) -> bool:
        """Whether the t-test finds the bias significant at 5 %."""
        return self.p < SIGNIFICANCE

    @property
    def resolution_share(self) -> float | None:
        """Resolution of the gauge as a fraction of T; None if no resolution is stated."""
        return None if self.resolution is None else self.resolution / self.tolerance

    @property
    def resolution_suffices(self) -> bool | None:
        """Whether the resolution is 5 % of T or less; None if no resolution is stated."""
        return None if self.resolution_share is None else self.resolution_share <= RESOLUTION_SHARE * (1 + 1e-9)

    @property
    def smallest_tolerance(self) -> float:
        """Smallest T for which Cgk, and so Cg, reaches the limit: 10 (|bias| + 3 · 1.33 s)."""
        return 10 * (abs(self.bias) + 3 * LIMIT * self.s)

    @property
    def verdict(self) -> Capability:
        """Verdict: CAPABLE if Cg and Cgk reach the limit and the resolution, if stated, suffices; else NOT_CAPABLE.

        Not proven where results of repeats prove nothing.
        """
        if self.doubted:
            return "not proven"
        suffices = min(self.cg, self.cgk) >= LIMIT and self.resolution_suffices is not False
        found: Capability = CAPABLE if suffices else NOT_CAPABLE
        return found

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes on what limits the type-1 study: doubts, too few repeats, a bias, or no scatter; () for none."""
        said = [*notes_of(doubts_of_study(self.doubted))]
        if self.n < FEW_MEASUREMENTS:
            said.append(note_of("study.few_repeats", n=self.n, least=FEW_MEASUREMENTS))
        if self.cgk < LIMIT <= self.cg:
            said.append(note_of("study.bias_too_large"))
        if self.bias_is_significant:
            said.append(note_of("study.bias_significant", p=self.p))
        if self.s == 0:
            said.append(note_of("study.no_spread"))
        return tuple(said)


def type1_study(
    values: Sequence[float], reference: float, tolerance: float, doubted: Doubted = (), *,
    resolution: float | None = None, unit: str = "mm",
) -> Type1Study:  # fmt: skip
    """Analyse n ≥ 2 repeats of a reference part: bias, Cg and Cgk, against `tolerance`, the full width T.

    Parameters
    ----------
    values
        In the order of measuring.
    reference
        The part's calibrated value.
    tolerance
        T, the full width of the tolerance to be measured against, above 0.
    doubted
        See `Type1Study`.
    resolution
        Of the gauge, if known.
    unit
        Of all these.

    Raises
    ------
    WrongValue
        If there are fewer than two values, one is not finite, or the tolerance or the resolution is not above 0.
    """
    measured = np.array(values, dtype=np.float64)
    if measured.ndim != 1 or len(measured) < 2 or not np.isfinite(measured).all():
        raise WrongValue(Message("study.type1_too_few", "a type-1 study needs two finite values or more"))
    if not tolerance > 0 or not math.isfinite(tolerance) or not math.isfinite(reference):
        raise WrongValue(
            Message(
                "study.type1_reference",
                "a type-1 study needs a reference value and a tolerance above 0, not {reference} and {tolerance}",
                reference=reference,
                tolerance=tolerance,
            )
        )
    if resolution is not None and not resolution > 0:
        raise WrongValue(
            Message(
                "study.resolution_not_positive",
                "the resolution must be above 0, not {resolution}",
                resolution=resolution,
            )
        )
    measured.setflags(write=False)
    n, mean = len(measured), float(measured.mean())
    s = float(measured.std(ddof=1)) if np.ptp(measured) else 0.0
    bias = mean - reference
    cg = 0.2 * tolerance / (6 * s) if s else math.inf
    cgk = (0.1 * tolerance - abs(bias)) / (3 * s) if s else math.copysign(math.inf, 0.1 * tolerance - abs(bias))
    low, high = (math.sqrt(chdtri(n - 1, tail) / (n - 1)) for tail in (1 - SIGNIFICANCE / 2, SIGNIFICANCE / 2))
    t, p, half = _t_test(bias, s, n)
    return Type1Study(
        measured, reference, tolerance, mean, s, bias, cg, cgk, (cg * low, cg * high), t, p, (bias - half, bias + half),
        resolution, unit, doubted,
    )  # fmt: skip


def _t_test(bias: float, s: float, n: int) -> tuple[float, float, float]:
    """The statistic t = bias √n / s, its two-sided p, and half the width of the bias's 95 % interval."""
    if not s:
        return (math.copysign(math.inf, bias), 0.0, 0.0) if bias else (0.0, 1.0, 0.0)
    error = s / math.sqrt(n)
    t = bias / error
    return t, 2 * float(stdtr(n - 1, -abs(t))), float(stdtrit(n - 1, 1 - SIGNIFICANCE / 2)) * error
