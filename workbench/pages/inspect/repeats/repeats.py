"""Repeats: the thickness of several scans of one part, each an independent measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from PySide6.QtCore import QObject, Signal

from core.files.project.data import Repeat
from core.files.recording.rig import GaugeSpec
from core.findings.proof import Doubt
from core.states import OUT_OF_DATE
from core.study.doubted import Doubted, doubted_among
from core.study.repeats import RepeatStatistics, repeat_statistics
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.inspect.faces import InspectFaces
from workbench.pages.inspect.scan import InspectScan
from workbench.reasons import first, why
from workbench.step_state import State
from workbench.work import jobs

if TYPE_CHECKING:
    from core.study.type1 import Type1Study


@dataclass(frozen=True, slots=True)
class RepeatsFacts:
    """Facts from which the buttons follow."""

    no_surface: str
    """Why no scan is shown."""
    stale: bool
    """What is shown is the one before: a newer one is being read."""
    thickness: bool
    """What is shown has one."""
    scan_old: bool
    """The scan is out of date."""
    outdated: bool
    """The thickness is."""
    among: bool
    """This scan is among the repeats already."""
    some: bool
    """There are repeats."""
    chosen: bool
    """One of them is."""


class RepeatsButtons(NamedTuple):
    """Reason for each disabled button, or ""."""

    add: str
    remove: str
    copy: str


def repeats_buttons(facts: RepeatsFacts) -> RepeatsButtons:
    """Derive from the facts why each button is disabled."""
    none = "" if facts.some else tr("There are no repeats yet.")
    choose = "" if facts.chosen else tr("Choose a repeat in the table first.")
    return RepeatsButtons(_why_not_add(facts), none or choose, none)


def _why_not_add(facts: RepeatsFacts) -> str:
    return first(
        facts.no_surface,
        why(facts.stale, tr("The scan is being read.")),
        why(not facts.thickness, tr("Measure the thickness first.")),
        why(facts.scan_old, tr(OUT_OF_DATE["scan"])),
        why(facts.outdated, tr(OUT_OF_DATE["gauge"])),
        why(
            facts.among,
            tr(
                "This scan is among the repeats already. A repeat is another scan of the part: measuring the same "
                "pictures again says nothing about how well the measurement repeats."
            ),
        ),
    )


class InspectRepeats(QObject):
    """Series of repeats in the project; every change is undoable."""

    changed = Signal()

    def __init__(self, bench: Bench, scan: InspectScan, faces: InspectFaces) -> None:
        super().__init__()
        self._bench, self._model, self._scan, self._faces = bench, bench.model, scan, faces
        self._type1: Type1Study | None = None
        self._type1_of: object = None
        self._asked: object = None

    @property
    def all(self) -> tuple[Repeat, ...]:
        """Repeats in the order they were added."""
        return self._model.project.repeats

    @property
    def spec(self) -> GaugeSpec:
        """Nominal value and tolerance for judging them."""
        return self._faces.spec

    @property
    def cannot_add(self) -> str:
        """Reason why the thickness shown cannot be added, or ""."""
        return self.buttons().add

    def buttons(self, *, chosen: bool = False) -> RepeatsButtons:
        """Return the reason for each disabled button, where one of them is `chosen` or none."""
        scan = self._scan
        return repeats_buttons(
            RepeatsFacts(
                no_surface=scan.buttons.use,
                stale=scan.stale,
                thickness=scan.gauge is not None,
                scan_old=scan.is_old,
                outdated=self._model.states["inspect"].state is not State.DONE,
                among=any(repeat.scan == scan.recording for repeat in self.all),
                some=bool(self.all),
                chosen=chosen,
            )
        )

    def add(self) -> None:
        """Add the thickness of this scan to the series; undoable. The same scan twice is refused with a sentence."""
        why_not, gauge, view = self.cannot_add, self._scan.gauge, self._scan.view
        scan = self._model.results.get("scan")
        if why_not or gauge is None or view is None or scan is None:
            self._bench.notices.warning(why_not or tr("Measure the thickness first."))
            return
        repeat = Repeat(
            scan=self._scan.recording,
            thickness_mm=gauge.thickness_mm,
            U_mm=gauge.U_mm,
            k=gauge.k,
            calibration_id=view.calibration_id,
            measured_at=scan.at,
            doubts=tuple(doubt.fact for doubt in gauge.doubts),
        )
        self._put((*self.all, repeat), tr("add a repeat"))

    def remove(self, rows: Sequence[int]) -> None:
        """Remove repeats from the series; undoable."""
        kept = tuple(repeat for row, repeat in enumerate(self.all) if row not in set(rows))
        count = len(self.all) - len(kept)
        label = tr("remove a repeat") if count == 1 else tr("remove {count} repeats", count=count)
        self._put(kept, label)

    def statistics(self) -> RepeatStatistics | None:
        """Compute the statistics of the repeats; None if there are none."""
        if not self.all:
            return None
        return repeat_statistics([repeat.thickness_mm for repeat in self.all], self.spec.nominal_mm)

    @property
    def type1(self) -> Type1Study | None:
        """Type-1 study of the repeats against the tolerance; None as long as there is none."""
        return self._type1 if self._type1_of == self._type1_wanted() else None

    @property
    def no_type1(self) -> str:
        """Reason why there is no type-1 study, or ""."""
        spec = self.spec
        if spec.nominal_mm is None or spec.tolerance_mm is None:
            return tr("A type-1 study needs a reference part: enter its thickness and the tolerance.")
        if len(self.all) < 2:
            return tr("A type-1 study needs two repeats; take at least 25, better 50.")
        return ""

    def study(self) -> None:
        """Compute the type-1 study, unless it is there or being computed."""
        wanted, spec = self._type1_wanted(), self.spec
        if self.no_type1 or spec.tolerance_mm is None or wanted in (self._type1_of, self._asked):
            return
        self._asked = wanted

        def done(study: Any) -> None:
            self._type1, self._type1_of = study, wanted
            self.changed.emit()

        def ended(*_: Any) -> None:
            self._asked = None if self._asked == wanted else self._asked

        task = self._bench.run_quick(
            self,
            jobs.TYPE1_STUDY,
            [repeat.thickness_mm for repeat in self.all],
            spec.nominal_mm,
            2 * spec.tolerance_mm,
            self.doubted,
            label=tr("Studying the repeats"),
            on_done=done,
            offers={},
        )
        task.ended.connect(ended)

    def _type1_wanted(self) -> object:
        spec = self.spec
        values = tuple((repeat.thickness_mm, repeat.doubts) for repeat in self.all)
        return values, spec.nominal_mm, spec.tolerance_mm

    @property
    def doubted(self) -> Doubted:
        """Repeats whose results prove nothing."""
        return doubted_among((repeat.scan, tuple(map(Doubt.named, repeat.doubts))) for repeat in self.all)

    def calibrations(self) -> int:
        """Count the different calibrations they were measured with."""
        return len({repeat.calibration_id for repeat in self.all})

    def _put(self, repeats: tuple[Repeat, ...], label: str) -> None:
        self._model.edit(label, replace(self._model.project, repeats=repeats))
