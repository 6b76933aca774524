"""The scan page: the picture and the growing cloud in the middle; recording, frames, settings, result at the side."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtCore import QEvent, Qt, QTimer
from PySide6.QtGui import QKeyEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QAbstractSpinBox, QComboBox, QLineEdit, QSizePolicy, QStackedWidget, QWidget

from core.pipeline.live.events import LiveView, ScanDetail
from core.scan.preview.preflight import Check
from workbench.language import tr
from workbench.pages.scan import words
from workbench.pages.scan.bar import FrameBar
from workbench.pages.scan.check_card import CheckCard
from workbench.pages.scan.cloud import ScanCloud
from workbench.pages.scan.guide import GuideBand
from workbench.pages.scan.panels import PlateQuestion, ResultPanel, RunningPanel, ScanCard, SettingsPanel
from workbench.pages.scan.picture import ScanPicture, View
from workbench.pages.scan.presenter import ScanPresenter
from workbench.pages.scan.profiles import ProfilesPanel
from workbench.pages.scan.run import short
from workbench.pages.scan.stage import Stage
from workbench.pages.sources import scan_begins_live
from workbench.pages.step_page import StepPage
from workbench.pages.words import sigma
from workbench.views.forms.live_panel import LivePanel, LiveStrip
from workbench.views.forms.source_chooser import SourceChooser
from workbench.views.image.side_by_side import SideBySide
from workbench.views.lists.checks_card import ChecksCard
from workbench.views.lists.view_list import ListRow, ViewList

STAGES_BEFORE = ("boards", "reference", "ready")
"""Stages of a live scan in which nothing is recorded yet; later only those checks are shown that failed."""


def unchecked(check: Check) -> bool:
    """Whether a check before the scan says that camera and laser were not checked today."""
    return check.name == "check" and check.state == "unknown"


EXCHANGE, LEGEND = Qt.Key.Key_X, Qt.Key.Key_L
"""Keys while frames are recorded."""
_STEPS = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}
"""Keys that go through the frames."""


class ScanPage(StepPage):
    """Page of the scan: record, measure, look through the frames, measure again."""

    presenter: ScanPresenter
    card: ScanCard

    def __init__(self, presenter: ScanPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.guide, self.strip = GuideBand(presenter), LiveStrip(presenter.live, asks=False)
        self.views = SideBySide()
        self.check_strip = LiveStrip(presenter.check_live)
        self.picture = ScanPicture(presenter, lambda: self.source.next_action(presenter.live))
        self.cloud = ScanCloud(presenter)
        self.views.add_view(tr("Picture"), self.picture)
        self.views.add_view(tr("Points"), self.cloud)
        self.running, self.bar = RunningPanel(), FrameBar(presenter)
        for above in (self.guide, self.strip, self.check_strip):
            self.centre.addWidget(above)
        self.centre.addWidget(self.views, 1)
        self.below = QStackedWidget()  # one as high as the other: the views keep their size
        self.below.addWidget(self.bar)
        self.below.addWidget(self.running)
        self.below.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.centre.addWidget(self.below)

        self.card = ScanCard(presenter)
        self.add_to_side(self.card)
        self.plate = PlateQuestion(presenter)
        self.add_to_side(self.plate)
        self.check = CheckCard(presenter.check, presenter.artefacts, presenter.check_live)
        self.add_to_side(self.check)
        self.checks = ChecksCard()
        self.add_to_side(self.checks)
        self.live_panel = LivePanel(presenter.live, keys_on=self)
        self.source = SourceChooser(self.live_panel, what=tr("Folder with the frames of a scan"))
        self.source_fold = self.add_panel(tr("Recording"), self.source)
        self.frames = ViewList(thumbnails_later=True)
        self.frames.set_headers(tr("Frame"), tr("Median σ [mm]"))
        self.frames_fold = self.add_list(tr("Frames"), self.frames)
        self.settings = SettingsPanel(presenter)
        self.settings_fold = self.add_panel(tr("Settings"), self.settings, collapsed=True, kept="settings")
        self.profiles = ProfilesPanel(presenter.bench)
        self.profiles_fold = self.add_panel(tr("Fixed lines alone"), self.profiles, collapsed=True, kept="profiles")
        self.result = ResultPanel(presenter)  # last: there it pushes nothing as it comes
        self.result_fold = self.add_panel(tr("Result"), self.result)
        self._rows: Any = None
        self._room = False
        self._keys = {key: QShortcut(QKeySequence(key), self) for key in (EXCHANGE, LEGEND, Qt.Key.Key_Space)}
        self._connect()

    @property
    def takes_the_window(self) -> bool:
        return self.presenter.recording

    def refresh(self) -> None:
        p, stage = self.presenter, self.presenter.stage
        live = stage is Stage.LIVE
        self._take_room(self.takes_the_window)
        self.guide.setVisible(live)
        if live:
            self.guide.refresh()
        self.card.refresh()
        self.card.setVisible(not live)
        self.plate.setVisible(p.asks_for_plate and self.source.mode == "live")
        check_is_due = p.check_is_due and self.source.mode == "live"
        self.check.setVisible(p.has_fan)
        self.check.refresh(wanted=check_is_due)
        before = p.live_stage in STAGES_BEFORE
        self.checks.show_checks([one for one in p.live.checks if before or one.state == "failed" or unchecked(one)])
        self.source.set_folder(p.folder, self._folder_words())
        self.live_panel.set_primary(stage in (Stage.NONE, Stage.EMPTY) and not check_is_due)
        self.live_panel.refresh()
        if live:
            self.source.set_mode("live")
        measuring = stage is Stage.MEASURING
        self.below.setVisible(measuring or p.scrubbing)
        self.below.setCurrentWidget(self.running if measuring else self.bar)
        if p.scrubbing:
            self.bar.refresh()
        self.settings.refresh()
        self.settings.setEnabled(not live)
        self.profiles.refresh(p.cannot_measure)
        self.profiles_fold.setVisible(p.has_fan and bool(p.work.names) and not live)
        self.result.refresh()
        self.result_fold.setVisible(p.work.look is not None and not live)
        self.frames_fold.setVisible(bool(p.work.names) and not live)
        self._show_frames()
        self.picture.refresh()
        self.cloud.refresh()

    def closeEvent(self, event: Any) -> None:
        self.cloud.scene.close()
        super().closeEvent(event)

    def _connect(self) -> None:
        p = self.presenter
        self.source.folder_chosen.connect(p.use_folder)
        self.source.mode_changed.connect(self.refreshing.soon)
        self.source.accept_drops_on(self.picture.image)
        self.frames.toggled_together.connect(lambda names, used: p.set_used(list(names), used))
        self.frames.current_changed.connect(lambda name: p.scrub.choose(name))
        self.frames.thumbnail_wanted.connect(p.thumbnails.request)
        p.thumbnails.changed.connect(self._show_frames)
        self.bar.view_chosen.connect(self.picture.show_view)
        self.bar.choose(View.CROSSINGS)
        p.live.started.connect(self._begin_live)
        p.live.show_by(self._show_live)
        p.check_live.started.connect(self._begin_check)
        p.check_live.show_by(self._show_check)
        p.run.started.connect(self._begin_measuring)
        p.run.frame_seen.connect(self._show_measured)
        p.model.opened.connect(self._opened)
        self.cloud.scene.notice.connect(p.bench.notices.info)
        self.guide.exchange_wanted.connect(self.views.show_next)
        does = {EXCHANGE: self.views.show_next, LEGEND: self._show_legend, Qt.Key.Key_Space: p.live.go_on}
        for key, shortcut in self._keys.items():
            shortcut.setEnabled(False)
            shortcut.activated.connect(does[key])
        p.live.asked.connect(self._focus_answer)
        self.picture.image.installEventFilter(self)
        for key, by in _STEPS.items():
            shortcut = QShortcut(QKeySequence(key), self)
            shortcut.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
            shortcut.activated.connect(lambda by=by: self._step(by))

    def _take_room(self, wanted: bool) -> None:
        """While frames are recorded: the picture with a few points beside it, and nothing at the side, no legend."""
        if wanted == self._room:
            return
        self._room = wanted
        self.side_panel.setVisible(not wanted)
        self.picture.image.set_legend_visible(not wanted)
        self.views.show_main(0 if wanted else None)
        for shortcut in self._keys.values():
            shortcut.setEnabled(wanted)

    def _show_legend(self) -> None:
        """Show the legend, or hide it."""
        image = self.picture.image
        image.set_legend_visible(not image.legend_titles)

    def _begin_check(self, _: object) -> None:
        self.picture.refresh()

    def eventFilter(self, watched: Any, event: QEvent) -> bool:
        """Go through the frames by the arrow keys also on a picture that is shown whole: there is nothing to pan."""
        if (
            isinstance(event, QKeyEvent)
            and event.key() in _STEPS
            and event.modifiers() in (Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.KeypadModifier)
            and self.presenter.scrubbing
            and self.picture.image.fitted
        ):
            if event.type() == QEvent.Type.ShortcutOverride:
                event.ignore()
                return True
            if event.type() == QEvent.Type.KeyPress:
                self._step(_STEPS[Qt.Key(event.key())])
                return True
        return super().eventFilter(watched, event)

    def _opened(self) -> None:
        """What a result was made from is folded here, and never as one comes: the hand may be on what is below it."""
        self._rows = None
        if "scan" in self.presenter.model.results:
            self.source_fold.collapse(animate=False)
        else:
            self.source_fold.expand(animate=False)
        self.views.show_alone(None)
        self.source.set_mode("live" if scan_begins_live(self.presenter.model) else "folder")

    def _focus_answer(self, asked: str, _button: str) -> None:
        """The Space bar answers, unless something is being typed in or chosen at the side."""
        if (
            asked
            and self.guide.isVisible()
            and not isinstance(self.window().focusWidget(), QLineEdit | QComboBox | QAbstractSpinBox)
        ):
            self.guide.go.setFocus()

    def _begin_live(self, _: Any) -> None:
        self.source_fold.expand(animate=False)
        self.cloud.begin_live()

    def _begin_measuring(self) -> None:
        self.running.show_detail(None, 0.0)
        self.cloud.begin_measuring()

    def _step(self, by: int) -> None:
        if self.presenter.scrubbing:
            self.presenter.scrub.step(by)

    def _show_live(self, view: LiveView) -> None:
        self.picture.show_live(view)
        self.cloud.show_live(view)
        self.guide.refresh()

    def _show_check(self, view: LiveView) -> None:
        self.picture.show_check(view)
        self.check.show_detail(view.detail)

    def _show_measured(self, detail: ScanDetail, picture: Any, scale: int) -> None:
        try:
            if self.presenter.run.measuring:
                self.picture.show_measured(detail, picture, scale)
                self.cloud.grow(detail)
                self.running.show_detail(detail, picture.shape[1] * scale)
                self._show_frames()
        finally:
            self.presenter.run.shown()

    def _folder_words(self) -> str:
        work = self.presenter.work
        if self.presenter.folder is None or work.frames is None:
            return ""
        reference = tr("with a reference") if work.reference is not None else tr("without a reference")
        return tr("{count} frames, {reference}", count=len(work.frames), reference=reference)

    def _show_frames(self) -> None:
        p = self.presenter
        running = p.run.measuring
        records, seen = ({}, p.run.seen) if running else (p.work.records(), {})
        rows = []
        for name in p.work.names:
            record = records.get(name)
            known = record.sigma_mm if record is not None and not math.isnan(record.sigma_mm) else None
            text = sigma(known) if known is not None else ""
            said = words.frame_line(record, seen.get(name), marked=name in p.work.marked)
            picture = p.thumbnails.pictures.get(name)
            rows.append(ListRow(name, known, text, not p.is_left_out(name), said, picture, short(name)))
        shown = [(row.name, row.text, row.used, row.reason, row.thumbnail is None) for row in rows]
        if shown != self._rows:
            self._rows = shown
            self.frames.set_rows(rows)
        current = p.run.newest if running else p.scrub.current
        if current and self.frames.current() != current:
            self.frames.set_current(current)
            QTimer.singleShot(0, self, self._scroll_to_current)  # the list may not be laid out yet

    def _scroll_to_current(self) -> None:
        self.frames.table.scrollTo(self.frames.table.currentIndex())
