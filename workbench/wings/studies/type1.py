"""The type-1 study of the repeats as they are: worked out as they change, shown below their statistics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from core.findings.proof import Doubt
from core.report.facts.fact import Fact
from core.wings.studies.kinds.doubted import Doubted, doubted_among
from core.wings.studies.kinds.study import KINDS
from core.wings.studies.study_facts import study_facts
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.repeats.repeats import InspectRepeats
from workbench.pages.words import show_facts
from workbench.views.layouts import heading, in_column, muted, set_text
from workbench.views.lists.value_rows import ValueRows
from workbench.wings.studies import jobs

if TYPE_CHECKING:
    from core.wings.studies.kinds.type1 import Type1Study


def type1_part(presenter: InspectPresenter) -> Type1Part:
    """Make the widget of the type-1 study below the statistics of the repeats."""
    study = Type1OfRepeats(presenter.bench, presenter.repeats)
    study.changed.connect(presenter.changed)
    return Type1Part(presenter.repeats, study)


def no_type1(repeats: InspectRepeats) -> str:
    """Return the reason why there is no type-1 study of the repeats; "" if there is one."""
    if repeats.spec.nominal_mm is None or repeats.spec.tolerance_mm is None:
        return tr("A type-1 study needs a reference part: enter its thickness and the tolerance.")
    if len(repeats.all) < 2:
        return tr("A type-1 study needs two repeats; take at least 25, better 50.")
    return ""


class Type1OfRepeats(QObject):
    """Presenter of the study of the repeats against the tolerance."""

    changed = Signal()

    def __init__(self, bench: Bench, repeats: InspectRepeats) -> None:
        super().__init__()
        self._bench, self._repeats = bench, repeats
        self._made: Type1Study | None = None
        self._made_of: object = None
        self._asked: object = None

    @property
    def study(self) -> Type1Study | None:
        """Type-1 study of the present repeats; None while it is not computed, or if it is not possible."""
        return self._made if self._made_of == self._wanted() else None

    def make(self) -> None:
        """Compute the type-1 study in the background, unless it is computed or being computed."""
        repeats, wanted = self._repeats, self._wanted()
        spec = repeats.spec
        if no_type1(repeats) or spec.tolerance_mm is None or wanted in (self._made_of, self._asked):
            return
        self._asked = wanted

        def done(study: Any) -> None:
            self._made, self._made_of = study, wanted
            self.changed.emit()

        def ended(*_: Any) -> None:
            self._asked = None if self._asked == wanted else self._asked

        task = self._bench.run_quick(
            self,
            jobs.TYPE1_STUDY,
            [repeat.thickness_mm for repeat in repeats.all],
            spec.nominal_mm,
            2 * spec.tolerance_mm,
            self._doubted(),
            label=tr("Studying the repeats"),
            on_done=done,
            offers={},
        )
        task.ended.connect(ended)

    def _wanted(self) -> object:
        spec = self._repeats.spec
        values = tuple((repeat.thickness_mm, repeat.doubts) for repeat in self._repeats.all)
        return values, spec.nominal_mm, spec.tolerance_mm

    def _doubted(self) -> Doubted:
        """Repeats whose results prove nothing."""
        return doubted_among((one.scan, tuple(map(Doubt.named, one.doubts))) for one in self._repeats.all)


class Type1Part(QWidget):
    """Widget with the study where there can be one, else with what it needs, as soon as there is a repeat."""

    def __init__(self, repeats: InspectRepeats, type1: Type1OfRepeats) -> None:
        super().__init__()
        self.type1, self._repeats = type1, repeats
        self.title, self.rows, self.words = heading(tr(KINDS["type1"])), ValueRows(), muted()
        in_column(self.title, self.rows, self.words, on=self)

    def refresh(self) -> None:
        """Show the type-1 study of the repeats, or what it still needs."""
        self.type1.make()
        study = self.type1.study
        self.title.setVisible(study is not None)
        show_facts(self.rows, self.facts())
        told = no_type1(self._repeats) if study is None else "\n".join(map(text_of, study.notes))
        set_text(self.words, told if self._repeats.all else "")

    def facts(self) -> Sequence[Fact]:
        """Return the facts of the type-1 study; () if there is none."""
        study = self.type1.study
        return () if study is None else study_facts(study)
