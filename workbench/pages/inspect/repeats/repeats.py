"""Repeats: the thickness of several scans of one part, each an independent measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from PySide6.QtCore import QObject, Signal

from core.checks.repeats import RepeatStatistics, repeat_statistics
from core.files.project.data import Repeat
from core.files.recording.rig import GaugeSpec
from core.states import OUT_OF_DATE
from workbench.bench import Bench
from workbench.language import tr
from workbench.pages.inspect.faces import InspectFaces
from workbench.pages.inspect.scan import InspectScan
from workbench.reasons import first, why
from workbench.step_state import State


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
    """Derive why each button of the repeats is disabled; "" for each that is enabled."""
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

    @property
    def all(self) -> tuple[Repeat, ...]:
        """Repeated measurements in the project, in the order they were added."""
        return self._model.project.repeats

    @property
    def spec(self) -> GaugeSpec:
        """Nominal value and tolerance by which the repeats are judged."""
        return self._faces.spec

    @property
    def cannot_add(self) -> str:
        """Reason why the thickness shown cannot be added to the repeats; "" if it can."""
        return self.buttons().add

    def buttons(self, *, chosen: bool = False) -> RepeatsButtons:
        """Return why each button is disabled ("" if enabled); `chosen`: whether a repeat is selected."""
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
        """Add the thickness of the scan shown to the repeats, unless that scan is there already; undoable."""
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
        """Remove the repeats with these row numbers; undoable."""
        kept = tuple(repeat for row, repeat in enumerate(self.all) if row not in set(rows))
        count = len(self.all) - len(kept)
        label = tr("remove a repeat") if count == 1 else tr("remove {count} repeats", count=count)
        self._put(kept, label)

    def statistics(self) -> RepeatStatistics | None:
        """Compute the statistics of the repeats; None if there are none."""
        if not self.all:
            return None
        return repeat_statistics([repeat.thickness_mm for repeat in self.all], self.spec.nominal_mm)

    def calibrations(self) -> int:
        """Count the different calibrations that the repeats were measured with."""
        return len({repeat.calibration_id for repeat in self.all})

    def _put(self, repeats: tuple[Repeat, ...], label: str) -> None:
        self._model.edit(label, replace(self._model.project, repeats=repeats))
