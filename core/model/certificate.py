"""What a calibration certificate says of itself: what a measurement's traceability is shown by."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date


@dataclass(frozen=True, slots=True)
class Certificate:
    """The certificate of a target or an artefact.

    Parameters
    ----------
    number
        Of the certificate; "" where none is stated.
    laboratory
        Who has issued it; "" where that is not stated.
    due
        The last day on which it holds; None: nothing is stated.
    """

    number: str = ""
    laboratory: str = ""
    due: date | None = None

    @property
    def stated(self) -> bool:
        """Whether number, laboratory or due date of the certificate is stated."""
        return self != Certificate()

    def lapsed(self, day: date) -> bool:
        """Whether the certificate's due date is before this `day`; False where no due date is stated."""
        return self.due is not None and day > self.due
