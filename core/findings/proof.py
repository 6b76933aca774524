"""What decides whether anything measured in a scan can prove conformity, however small its uncertainty.

Facts are fields: steps fill them, files keep them, and verdicts are made of them alone; no note is read back. A fact
that a file does not hold is not known, and what is not known proves nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from core.findings import of_proof
from core.findings.table import note_of
from core.messages import Field, Message

OF_SCAN: Mapping[str, Message] = {row.fact: row.note() for row in of_proof.SCAN}
"""Why nothing is proven where a fact of the scan holds, by its name, in the order in which they are said."""
OF_PLANES: Mapping[str, Message] = {row.fact: row.note() for row in of_proof.PLANES}
"""The same of the planes' calibration."""
SCAN_UNKNOWN, PLANES_UNKNOWN = note_of("validity.scan_unknown"), note_of("validity.planes_unknown")
"""Why nothing is proven where one of these facts is not known."""
SIZE_UNCONFIRMED = note_of("target.size_unconfirmed", field=Field("plane_target.scale_sd", whole=True))
"""Why only what is compared with a master is proven."""


@dataclass(frozen=True, slots=True)
class ScanFacts:
    """Facts of a scan, and of the calibrations that it rests on, each of which takes away every proof where it holds.

    Parameters
    ----------
    moved, drifted
        Whether part, table or camera moved within the scan, or the rig evenly from its first frame to its last.
    collapsed
        Whether the sweeps' light planes have fallen together into one.
    fan_disagrees
        Whether sweeps and fan disagree by more than U need contain, and no single change of the rig explains it.
    rig_changed, rig_seems_changed
        Whether camera or laser surely differ from their calibration; whether they seem to, and no check of the day is
        in order.
    section_changed
        Whether the fan's light is skewed otherwise than in its calibration, whose stripes may not tell.
    planes_unsettled, points_off_alike
        Whether the planes' calibration was not solved to its end, and whether its target's points lie off alike in all
        poses and no artefact holds what that may do.
    size_unconfirmed
        Whether the plane target's size is neither stated nor confirmed; it cancels in the comparison with a master.
    of_the_day
        Why calibration or check did not hold on the day of the scan.

    Each but the last is None where it is not known.
    """

    moved: bool | None = None
    drifted: bool | None = None
    collapsed: bool | None = None
    fan_disagrees: bool | None = None
    rig_changed: bool | None = None
    rig_seems_changed: bool | None = None
    section_changed: bool | None = None
    planes_unsettled: bool | None = None
    points_off_alike: bool | None = None
    size_unconfirmed: bool | None = None
    of_the_day: tuple[Message, ...] = ()

    @property
    def doubts(self) -> tuple[Message, ...]:
        """Why nothing measured proves conformity, but for the target's size; () where nothing speaks against it.

        Examples
        --------
        >>> nothing = dict.fromkeys([*OF_SCAN, *OF_PLANES], False)
        >>> ScanFacts(**nothing).doubts, ScanFacts(**{**nothing, "moved": True}).doubts == (OF_SCAN["moved"],)
        ((), True)
        >>> ScanFacts().doubts == (SCAN_UNKNOWN, PLANES_UNKNOWN)
        True
        """
        return (*self._held(OF_SCAN, SCAN_UNKNOWN), *self.of_the_day, *self._held(OF_PLANES, PLANES_UNKNOWN))

    @property
    def all_doubts(self) -> tuple[Message, ...]:
        """The same with that of the size, which is unconfirmed where it is not known."""
        return self.doubts if self.size_unconfirmed is False else (*self.doubts, SIZE_UNCONFIRMED)

    def _held(self, rows: Mapping[str, Message], unknown: Message) -> tuple[Message, ...]:
        """The doubts of those facts that hold, and `unknown` where one of them is not known."""
        facts = {name: getattr(self, name) for name in rows}
        holding = tuple(doubt for name, doubt in rows.items() if facts[name])
        return (*holding, unknown) if None in facts.values() else holding
