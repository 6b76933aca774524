"""The inspect page: the surface in 3D, its picture and the repeats in the middle; thickness and points at the side."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QTimer
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QWidget

from core.states import DECISIONS
from workbench.language import sentence, sentences, tr
from workbench.pages.inspect import words
from workbench.pages.inspect.features.conditions_panel import ConditionsPanel
from workbench.pages.inspect.features.form import CLICK
from workbench.pages.inspect.features.panel import FeaturesPanel
from workbench.pages.inspect.features.plot import PlotTab
from workbench.pages.inspect.panels import FacesPanel, PartPanel, PicksPanel, ResultPanel
from workbench.pages.inspect.picture import PictureTab
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.repeats.tab import RepeatsTab
from workbench.pages.inspect.stage import Stage
from workbench.pages.inspect.surface import SurfaceTab
from workbench.pages.step_page import StepPage
from workbench.views.layouts import Tabs
from workbench.views.stage_card import CardButton, StageCard
from workbench.wing import PartOfWing, inspect_tabs, repeats_parts

REPEATS, PLOT = 2, 3
"""Places of these tabs."""

USUAL = "50.012\N{NO-BREAK SPACE}mm ± 0.024\N{NO-BREAK SPACE}mm (k\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}2)"
"""A thickness as the card's title tells it."""

STEADY = (Stage.MEASURING, Stage.UNMEASURED, Stage.MEASURED, Stage.OUTDATED)
"""From one to another of these a thickness comes or is no longer true, while its nominal value may be in hand."""


class InspectPage(StepPage):
    """Page of the inspection: look, measure, judge."""

    presenter: InspectPresenter

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.tabs = Tabs()
        self.surface, self.picture = SurfaceTab(presenter), PictureTab(presenter)
        self.series = RepeatsTab(presenter.repeats, repeats_parts(presenter.bench, presenter))
        self.plot = PlotTab(presenter.features, presenter.feature)
        for tab, title, tip in (
            (self.surface, tr("Surface"), tr("The measured points and the mesh in 3D")),
            (self.picture, tr("Picture"), tr("The two faces in the camera's picture; draw regions here")),
            (self.series, tr("Repeats"), tr("The thickness over several scans of the part")),
            (self.plot, tr("Plot"), tr("The profile or the deviations of the chosen feature")),
        ):
            self.tabs.add(tab, title, tip)
        for one, made in inspect_tabs(presenter.bench, presenter):
            self.tabs.add(made, tr(one.title), tr(one.tip))
        self.centre.addWidget(self.tabs, 1)
        self.card = StageCard(
            [
                CardButton("measure", tr("Measure"), "mdi6.ruler-square", presenter.do_run),
                CardButton("repeat", tr("Add to repeats"), "mdi6.playlist-plus", self._add_repeat),
            ]
        )
        self.card.title.setObjectName("title")
        self.card.title.to_come = (USUAL,)
        self.pin_to_side(self.card)
        self.features = FeaturesPanel(presenter.features, presenter.feature, presenter.templates, presenter.scan)
        self.pin_to_side(self.features)
        self.add_to_side(self.features.state)  # of three lines, whatever it says: it pushes nothing as it changes
        self.add_to_side(self.features.form)  # above what would push it down as it comes
        self.faces = FacesPanel(presenter)
        self.faces_fold = self.add_panel(tr("What is measured"), self.faces, kept="faces")
        self.part = PartPanel(presenter)
        self.part_fold = self.add_panel(tr("The part"), self.part, collapsed=True, kept="part")
        self.conditions = ConditionsPanel(presenter.conditions)
        self.conditions_fold = self.add_panel(
            tr("Conditions and frame"), self.conditions, collapsed=True, kept="conditions"
        )
        self.layers: dict[str, PartOfWing] = {}
        self.layer_folds: dict[str, Any] = {}
        for layer in presenter.layers.values():
            if (panel := layer.panel(presenter.bench, presenter)) is not None:
                name, title = layer.one.name, tr(layer.one.panel_title)
                self.layers[name] = panel
                self.layer_folds[name] = self.add_panel(title, panel.widget, collapsed=True, kept=name)
        self.picks = PicksPanel(presenter)
        self.add_panel(tr("Points and distances"), self.picks, kept="points")
        self.add_to_side(self.features.notes)  # what results say is last: there it pushes nothing as it comes
        self.result = ResultPanel(presenter)
        self.result_fold = self.add_panel(tr("Result"), self.result, kept="result")
        self._chosen = ""
        self.tabs.currentChanged.connect(self._tab_changed)
        self.faces.draw.connect(self._draw)
        self.features.draw.connect(self._draw)
        self.features.show_place.connect(self._show_place)
        self.features.ask_thickness.connect(self._ask_thickness)
        self.features.ask_limits.connect(self.enter)
        self.features.measure_thickness.connect(presenter.do_run)
        self.picks.pick.connect(self._pick)
        self.surface.notice.connect(presenter.bench.notices.warning)
        presenter.model.opened.connect(self._show_first_tab)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.features.fit(self.height())

    def _show_first_tab(self) -> None:
        self.tabs.setCurrentIndex(0)

    def refresh(self) -> None:
        p = self.presenter
        self._show_stage(p.stage)
        if p.features.chosen != self._chosen:
            self._chosen = p.features.chosen
            self.scroll_to_top()  # where its form begins
        self.result_fold.setVisible(p.scan.gauge is not None)
        self.conditions_fold.setVisible(bool(p.features.plan.features))
        said = p.conditions.in_short
        self.conditions_fold.setText(
            tr("Conditions and frame ({said})", said=said) if said else tr("Conditions and frame")
        )
        before: tuple[Any, ...] = (self.result, self.faces, self.features, self.part, self.conditions)
        for panel in (*before, *self.layers.values(), self.picks):
            panel.refresh()
        count = len(p.repeats.all)
        self.tabs.setTabText(REPEATS, tr("Repeats ({count})", count=count) if count else tr("Repeats"))
        self.tabs.setTabVisible(PLOT, bool(p.features.plan.features))
        self._refresh_tab()

    def _refresh_tab(self) -> None:
        tab: Any = self.tabs.currentWidget()
        tab.refresh()

    def _tab_changed(self) -> None:
        if self.tabs.currentWidget() is not self.surface:
            self.presenter.end_picking()
        self._refresh_tab()

    def _add_repeat(self) -> None:
        """Add it, and go and see it: in the next round of the event loop, as the plot is drawn for the first time."""
        self.presenter.repeats.add()
        QTimer.singleShot(1, self, lambda: self.tabs.setCurrentWidget(self.series))

    def _draw(self, face: str, kind: Any) -> None:
        if kind == CLICK:
            self.tabs.setCurrentWidget(self.surface)
            self.presenter.click_region(face)
            return
        if self.tabs.currentWidget() not in (self.surface, self.picture):
            self.tabs.setCurrentWidget(self.picture)
        tab: Any = self.tabs.currentWidget()
        tab.start_region(face, kind)

    def _show_place(self, name: str) -> None:
        self.tabs.setCurrentWidget(self.surface)
        self.surface.show_place(name)

    def _ask_thickness(self) -> None:
        self.faces_fold.expand(animate=False)
        self.enter(self.faces.form.editor("nominal_mm"))

    def _pick(self, mode: Any) -> None:
        if mode:
            self.tabs.setCurrentWidget(self.surface)
        self.presenter.start_picking(mode)

    def _show_stage(self, stage: Stage) -> None:
        p = self.presenter
        title, said = self._words()[stage]
        why_not = p.repeats.cannot_add
        self.card.buttons["measure"].setText(tr("Measure again") if p.scan.gauge is not None else tr("Measure"))
        fresh = stage is Stage.MEASURED
        self.card.show_stage(
            title,
            said,
            {
                "measure": (p.cannot_measure, tr("Measure the thickness of the two faces (Ctrl+R)")),
                "repeat": (why_not, tr("Add this scan's thickness to the series of repeats")),
            },
            "" if fresh else "measure",
            steady=stage in STEADY,
            verdict=words.verdict(p.results) if fresh else "",
        )

    def _words(self) -> dict[Stage, tuple[str, str]]:
        p = self.presenter
        gauge, verdict = p.scan.gauge, words.verdict(p.results)
        value = words.thickness(gauge) if gauge is not None else ""
        decided = sentence(tr(DECISIONS[verdict])) if verdict else ""
        return {
            Stage.NO_SCAN: (tr("Nothing to inspect yet"), tr("Scan the part first, then come back.")),
            Stage.READING: (tr("Reading the scan …"), tr("The surface is being prepared.")),
            Stage.UNREADABLE: (tr("The scan cannot be shown"), p.scan.problem),
            Stage.MEASURING: (
                tr("Measuring the thickness …"),
                tr("The faces are fitted, and the calibrations' share of the uncertainty is worked out."),
            ),
            Stage.UNMEASURED: (tr("No thickness yet"), p.warning()),
            Stage.FAILED: (tr("No thickness was measured"), p.problem_of_measuring),
            Stage.MEASURED: (value, sentences(decided, p.state.sentence)),
            Stage.OUTDATED: (value, sentences(p.state.sentence, p.warning())),
        }
