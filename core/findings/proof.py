"""What decides whether anything measured in a scan can prove conformity, however small its uncertainty.

Facts are fields: steps fill them, files keep them by their names, and verdicts are made of them alone; no note is read
back. A fact that a file does not hold is not known, and what is not known proves nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from core.findings import of_proof
from core.findings.table import fact_of, note_of
from core.messages import Field, Message


@dataclass(frozen=True, slots=True)
class Doubt:
    """Fact by which nothing is proven, by its name in files, with its note."""

    fact: str
    note: Message

    @classmethod
    def of(cls, note: Message) -> Doubt:
        """Make the doubt, a fact by which no measured value proves conformity, that this note tells.

        Raises
        ------
        ValueError
            If the finding takes away no proof.

        Examples
        --------
        >>> Doubt.of(note_of("inspection.planes_collapsed")).fact
        'collapsed'
        """
        fact = fact_of(note)
        if not fact:
            raise ValueError(f"this takes away no proof: {note}")
        return cls(fact, note)

    @classmethod
    def named(cls, fact: str) -> Doubt:
        """Make the doubt, a fact by which nothing is proven, from its name in a file; an unknown name is its own note.

        Examples
        --------
        >>> str(Doubt.named("moved").note), str(Doubt.named("melted").note)
        ('something moved during the scan', 'melted')
        """
        known = of_proof.REASONS.get(fact)
        return cls(fact, Message("doubt.of_other_version", "{fact}", fact=fact) if known is None else known)


Doubts: TypeAlias = tuple[Doubt, ...]
"""Why nothing is proven, each fact once; () where nothing speaks against it."""


def notes_of(doubts: Iterable[Doubt]) -> tuple[Message, ...]:
    """List the notes on these doubts, facts by which no measured value proves conformity."""
    return tuple(doubt.note for doubt in doubts)


def doubts_named(facts: Sequence[str], *, complete: bool) -> Doubts:
    """Make the doubts that a file states by the names `facts`; an unnamed one if the file may not name all of them.

    Only files of an earlier version, not `complete`, tell whether there are doubts without naming them.
    """
    return tuple(map(Doubt.named, facts or (() if complete else (of_proof.UNNAMED,))))


def check_doubted(notes: Iterable[Message], doubts: Doubts) -> None:
    """Raise ValueError if `notes` tell a fact by which nothing is proven, and `doubts` is empty."""
    if not doubts and (told := list(filter(None, map(fact_of, notes)))):
        raise ValueError(f"notes of a result tell {told}, by which nothing is proven, and it has no doubts")


def notes_beside(doubts: Doubts, notes: Iterable[Message]) -> tuple[Message, ...]:
    """Select the notes to keep beside `doubts`; if these are (), no note that tells a doubt is kept."""
    return tuple(note for note in notes if doubts or not fact_of(note))


OF_SCAN: Mapping[str, Doubt] = {row.fact: Doubt.of(row.note()) for row in of_proof.SCAN}
"""Why nothing is proven where a fact of the scan holds, by its name, in the order in which they are said."""
OF_PLANES: Mapping[str, Doubt] = {row.fact: Doubt.of(row.note()) for row in of_proof.PLANES}
"""The same of the calibrations of camera and planes."""
SCAN_UNKNOWN = Doubt.of(note_of("validity.scan_unknown"))
PLANES_UNKNOWN = Doubt.of(note_of("validity.planes_unknown"))
"""Why nothing is proven where one of these facts is not known."""
SIZE_UNCONFIRMED = Doubt.of(note_of("target.size_unconfirmed", field=Field("plane_target.scale_sd", whole=True)))
"""Why only what is compared with a master is proven."""


@dataclass(frozen=True, slots=True)
class ScanFacts:
    """Facts of a scan and of its calibrations, each of which takes away every proof where it holds.

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
    too_fine_for_mosaic
        Whether the fan's stripes are too fine for the tiles of a colour camera's mosaic, which draws them aside.
    camera_unsettled, planes_unsettled, points_off_alike
        Whether the calibration of the camera, or of the planes, was not solved to its end, and whether the plane
        target's points lie off alike in all poses and no artefact holds what that may do.
    size_unconfirmed
        Whether the plane target's size is neither stated nor confirmed; it cancels in the comparison with a master.
    of_the_day
        By what facts calibration or check did not hold on the day of the scan.

    Each but the last is None where it is not known.
    """

    moved: bool | None = None
    drifted: bool | None = None
    collapsed: bool | None = None
    fan_disagrees: bool | None = None
    rig_changed: bool | None = None
    rig_seems_changed: bool | None = None
    section_changed: bool | None = None
    too_fine_for_mosaic: bool | None = None
    camera_unsettled: bool | None = None
    planes_unsettled: bool | None = None
    points_off_alike: bool | None = None
    size_unconfirmed: bool | None = None
    of_the_day: Doubts = ()

    @property
    def displaced(self) -> bool:
        """Whether light, camera or part are surely or seemingly elsewhere than taken: plane faces may slant by that."""
        return any((self.moved, self.drifted, self.fan_disagrees, self.rig_changed, self.rig_seems_changed))

    @property
    def doubts(self) -> Doubts:
        """Facts by which no value measured in the scan proves conformity; () where there are none.

        That of the target's size, which is unconfirmed where it is not known, is the last.

        Examples
        --------
        >>> nothing = dict.fromkeys([*OF_SCAN, *OF_PLANES, "size_unconfirmed"], False)
        >>> ScanFacts(**nothing).doubts, ScanFacts(**{**nothing, "moved": True}).doubts == (OF_SCAN["moved"],)
        ((), True)
        >>> ScanFacts().doubts == (SCAN_UNKNOWN, PLANES_UNKNOWN, SIZE_UNCONFIRMED)
        True
        """
        size = () if self.size_unconfirmed is False else (SIZE_UNCONFIRMED,)
        of_planes = self._held(OF_PLANES, PLANES_UNKNOWN)
        every = (*self._held(OF_SCAN, SCAN_UNKNOWN), *self.of_the_day, *of_planes, *size)
        return tuple(dict.fromkeys(every))

    def _held(self, rows: Mapping[str, Doubt], unknown: Doubt) -> Doubts:
        """The doubts of those facts that hold, and `unknown` where one of them is not known."""
        facts = {name: getattr(self, name) for name in rows}
        holding = tuple(doubt for name, doubt in rows.items() if facts[name])
        return (*holding, unknown) if None in facts.values() else holding
