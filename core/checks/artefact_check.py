"""A check by a known artefact: its measured length against its certificate.

References
----------
ISO/IEC 17043:2010, B.3.1.3 (normalised error E_n).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from typing import Literal, TypeAlias

from core.findings.proof import Doubts, notes_of
from core.findings.table import note_of
from core.messages import Message, label
from core.model.certificate import Certificate

CHECKED = frozenset((
    "size_unconfirmed", "points_off_alike", "planes_unknown", "rig_seems_changed", "of_the_day", "calibration_undated",
    "calibration_lapsed", "never_checked", "check_lapsed", "check_failed", "history_unreadable",
))  # fmt: skip
"""Facts that an artefact is measured to clear up: its own check is not in doubt by them."""


def left_by_check(doubts: Doubts) -> Doubts:
    """Remove from doubts, reasons why a result proves nothing, those that measuring a known artefact answers."""
    return tuple(doubt for doubt in doubts if doubt.fact not in CHECKED)


ArtefactKind: TypeAlias = Literal["block", "sphere", "step"]
KINDS: Mapping[ArtefactKind, str] = {
    "block": label("block, thickness"),
    "sphere": label("sphere, diameter"),
    "step": label("step, height"),
}
"""Each kind with the length that its certificate states."""


@dataclass(frozen=True, slots=True)
class Artefact:
    """Block, sphere or step whose length a certificate states.

    Parameters
    ----------
    id
        What is engraved on it.
    value_mm, U_mm, k
        Its length at 20 °C (thickness, diameter or height), the expanded uncertainty of that, and its coverage factor.
    certificate
        Number of the certificate.
    due
        The last day on which the certificate holds; None: nothing is stated.
    kind
        What it is, and so which length is compared.
    laboratory
        Who has issued the certificate.
    """

    id: str
    value_mm: float
    U_mm: float
    k: float = 2.0
    certificate: str = ""
    due: date | None = None
    kind: ArtefactKind = "block"
    laboratory: str = ""

    @property
    def of_certificate(self) -> Certificate:
        """Number, laboratory and last valid day of the artefact's certificate."""
        return Certificate(self.certificate, self.laboratory, self.due)


@dataclass(frozen=True, slots=True)
class ArtefactCheck:
    """Measurement of an artefact on a `day`, in mm, with its standard uncertainty.

    `characteristic` is the name of what was measured, as "ball diameter"; "" is the thickness of the part as a whole.
    `outside` says of one that lies outside the limits of the rig's own history that it does. By its `doubts` what was
    measured proves nothing.
    """

    artefact: Artefact
    measured_mm: float
    u_mm: float
    day: date
    characteristic: str = ""
    outside: Message | None = None
    doubts: Doubts = ()

    @property
    def error_mm(self) -> float:
        """Error of the measured length in mm, measured − certified."""
        return self.measured_mm - self.artefact.value_mm

    @property
    def u_error_mm(self) -> float:
        """Standard uncertainty in mm of the error, of measurement and certificate together."""
        return math.hypot(self.u_mm, self.artefact.U_mm / self.artefact.k)

    @property
    def e_n(self) -> float:
        """Normalised error E_n, with its sign: error over its expanded uncertainty (k = 2)."""
        return self.error_mm / (2 * self.u_error_mm)

    @property
    def p(self) -> float:
        """Probability that an error as large as this one arises by chance, for normally distributed errors."""
        return math.erfc(abs(self.error_mm) / (self.u_error_mm * math.sqrt(2)))

    @property
    def lapsed(self) -> bool:
        """Whether the certificate had expired on the day of the check."""
        return self.artefact.of_certificate.lapsed(self.day)

    @property
    def own_doubts(self) -> Doubts:
        """Doubts, reasons why the measurement proves nothing, without those that an artefact's measurement answers."""
        return left_by_check(self.doubts)

    @property
    def verdict(self) -> Literal["passed", "doubtful", "failed"]:
        """Verdict on the check: failed if |E_n| is above 1, else doubtful or passed.

        Doubtful by its doubts, a lapsed certificate or the rig's history.
        """
        if abs(self.e_n) > 1:
            return "failed"
        return "doubtful" if self.own_doubts or self.lapsed or self.outside is not None else "passed"

    @property
    def sentence(self) -> Message:
        """Sentence with the result of the check, and what to do."""
        if self.verdict == "failed":
            return note_of("artefact.failed", id=self.artefact.id, error_mm=self.error_mm, e_n=self.e_n)
        if self.own_doubts:
            why = notes_of(self.own_doubts)
            return note_of("artefact.doubted", id=self.artefact.id, error_mm=self.error_mm, e_n=self.e_n, why=why)
        if self.lapsed:
            return note_of(
                "artefact.lapsed", due=str(self.artefact.due), id=self.artefact.id, error_mm=self.error_mm, e_n=self.e_n
            )
        if self.outside is not None:
            return self.outside
        return note_of("artefact.passed", id=self.artefact.id, error_mm=self.error_mm, e_n=self.e_n)
