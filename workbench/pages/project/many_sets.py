"""Tools, Measure many sets: recording sets measured in one go, each into a folder of its name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QObject, Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QLabel, QLineEdit, QProgressBar, QPushButton, QWidget

from core.errors import InputError
from core.files.results.export_list import EXPORTS
from core.messages import capital
from core.pipeline.set_result import SET_COLUMNS, SetProgress, SetResult, set_cells
from core.remaining import Remaining, in_words
from core.settings.options import Options
from core.states import SET_STATES
from workbench.bench import Bench
from workbench.language import joined, named, text_of, tr
from workbench.pages.channels import add_channel
from workbench.pages.setting_fields import add_settings, set_stripe_editable
from workbench.pages.settings import changed_options, values_of
from workbench.pages.words import wording
from workbench.theme import icon, shades
from workbench.views import ask
from workbench.views.common import dress
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import STRETCH, UpAndDown, enable, in_column, in_row, muted, resize_on_screen, set_text
from workbench.views.lists.data_table import DataTable
from workbench.work import jobs
from workbench.work.tasks import Task
from workbench.work.worker import Failure

SIZE = (1000, 560)
"""Width and height of the window at first, in pixels."""
SETTINGS_WIDTH = 320
"""Pixels of the settings beside the table."""
PARTS = 1000
"""A bar is so many parts long."""
_UNITS = {"thickness": "mm", "U": "mm"}


@dataclass(slots=True)
class ChosenSet:
    """Recording set of the table, with its progress and its result; both None until it is measured."""

    folder: Path
    running: SetProgress | None = None
    result: SetResult | None = None

    @property
    def state(self) -> str:
        """State of the set, a key of `SET_STATES`: "todo", "running", "done" or "failed"."""
        if self.result is None:
            return "running" if self.running is not None else "todo"
        return "failed" if self.result.error else "done"

    @property
    def reason(self) -> str:
        """Reason why the set could not be measured; "" if it could, or is not measured yet."""
        return text_of(self.result.error) if self.result is not None and self.result.error else ""


class ManySets(QObject):
    """Owner of the window, which is kept: its measurements go on while it is closed."""

    def __init__(self, bench: Bench, window: QWidget) -> None:
        super().__init__(window)
        self._bench, self._window = bench, window
        self.shown: ManySetsWindow | None = None

    def open(self) -> None:
        """Show the window of many sets, with its earlier sets and results."""
        if self.shown is None:
            self.shown = ManySetsWindow(self._bench, self._window)
        self.shown.show()
        self.shown.raise_()
        self.shown.activateWindow()


class ManySetsWindow(QWidget):
    """Window with recording sets in a table, the folder of results, options, and two bars: one set, and all.

    What cannot be done is said in this window, over the bars.
    """

    def __init__(self, bench: Bench, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Measure many sets"))
        resize_on_screen(self, *SIZE)
        self._bench = bench
        self._sets: list[ChosenSet] = []
        self._measured: list[ChosenSet] = []
        """Those of the batch that runs, or ran last, in its order."""
        self._task: Task | None = None
        self._options, self._remaining, self._done_share = Options(), Remaining({}), 0.0
        self.add = QPushButton(icon("mdi6.folder-plus-outline"), tr("Add sets …"))
        self.add.setToolTip(tr("Choose a recording set, or a folder with recording sets in it"))
        self.remove = QPushButton(icon("mdi6.playlist-remove"), tr("Remove"))
        self.out, self.browse = QLineEdit(), QPushButton(tr("Browse …"))
        self.out.setPlaceholderText(tr("Folder for the results: each set gets a folder of its name in it"))
        self.out.setAccessibleName(tr("Results folder"))
        self.settings, self.form = QPushButton(icon("mdi6.tune-variant"), tr("Settings")), SettingsForm()
        self.settings.setCheckable(True)
        add_settings(self.form, "scan")
        add_channel(self.form)
        self._beside = UpAndDown(self.form, SETTINGS_WIDTH)
        self.table, self.reason, self.problem = DataTable(), muted(), QLabel()
        self.problem.setWordWrap(True)
        self.within, self.stage, self.bar, self.counted = QProgressBar(), QLabel(), QProgressBar(), QLabel()
        titles = [(capital(tr(name)), _UNITS.get(name, "")) for name in SET_COLUMNS[1:]]
        self.table.set_headers([(tr("Recording set"), ""), (tr("State"), ""), *titles, (tr("Reason"), "")])
        for bar, words, name in (
            (self.within, self.stage, tr("The set that is being measured")),
            (self.bar, self.counted, tr("Sets measured")),
        ):
            bar.setAccessibleName(name)
            bar.setTextVisible(False)
            bar.setRange(0, PARTS)
            policy = bar.sizePolicy()
            policy.setRetainSizeWhenHidden(True)
            bar.setSizePolicy(policy)
            words.setObjectName("muted")
        self.measure = QPushButton(icon("mdi6.play"), tr("Measure"))
        self.stop = QPushButton(icon("mdi6.stop"), tr("Stop"))
        self.report = QPushButton(icon("mdi6.file-document-outline"), tr("Open report"))
        self.folder = QPushButton(icon("mdi6.folder-open-outline"), tr("Open folder"))
        self._arrange()
        self._connect()
        self._dress()
        self._say("")
        self._show()

    def add_folder(self, folder: Path) -> None:
        """Add the recording set in `folder`, or all recording sets that the folder contains."""
        self._bench.quick.run(
            self,
            jobs.SETS_IN,
            folder,
            label=tr("Looking for recording sets"),
            on_done=self._add,
            on_failed=self._not_done,
            offers={},
        )

    def run(self) -> None:
        """Measure all sets not measured yet, in the background; one that fails does not stop the others."""
        self._say("")
        self._measured = [one for one in self._sets if one.state != "done"]
        for one in self._measured:
            one.result = None
        self._remaining, self._done_share = Remaining({}), 0.0
        self._task = self._bench.measuring.run(
            self,
            jobs.MEASURE_SETS,
            [one.folder for one in self._measured],
            self._out(),
            self._options,
            label=tr("Measuring sets"),
            on_done=self._finished,
            on_failed=self._refused,
            on_cancelled=self._ended,
            offers={"progress": "progress", "watch": "watch"},
        )
        self._task.progressed.connect(self._progressed)
        self._task.reported.connect(lambda told: self._told(*told))
        self._show()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()

    def _dress(self) -> None:
        dress(self.problem, f"color: {shades().bad};")

    def _say(self, problem: str) -> None:
        """Say in this window what could not be done, or nothing."""
        set_text(self.problem, problem)

    def _arrange(self) -> None:
        margins = (8, 8, 8, 8)
        choosing = in_row(self.add, self.remove, (self.out, 1), self.browse, self.settings)
        middle = in_row((self.table, 1), self._beside)
        within, whole = in_row((self.within, 1), (self.stage, 1)), in_row((self.bar, 1), (self.counted, 1))
        doing = in_row(self.measure, self.stop, STRETCH, self.report, self.folder)
        in_column(choosing, (middle, 1), self.reason, self.problem, within, whole, doing, on=self, margins=margins)
        self._beside.hide()

    def _connect(self) -> None:
        self.add.clicked.connect(self._choose_sets)
        self.remove.clicked.connect(self._remove)
        self.browse.clicked.connect(self._choose_out)
        self.out.textChanged.connect(self._measure_all_again)
        self.table.current_row_changed.connect(lambda _: self._show_chosen())
        self.table.row_activated.connect(lambda _: self.report.click())
        self.settings.toggled.connect(self._beside.setVisible)
        self.form.edited.connect(self._set, Qt.ConnectionType.QueuedConnection)
        self.measure.clicked.connect(self.run)
        self.stop.clicked.connect(self._stop)
        self.report.clicked.connect(self._open_report)
        self.folder.clicked.connect(self._open_folder)

    def _out(self) -> Path:
        return Path(self.out.text().strip()).expanduser()

    def _choose_sets(self) -> None:
        folder = ask.choose_folder(self, tr("Recording set, or folder of recording sets"), self._start())
        if folder is not None:
            self.add_folder(folder)

    def _choose_out(self) -> None:
        folder = ask.choose_folder(self, tr("Folder for the results"), self._start())
        if folder is not None:
            self.out.setText(str(folder))

    def _start(self) -> Path:
        return self._sets[-1].folder.parent if self._sets else self._bench.settings.projects_folder

    def _add(self, folders: Sequence[Path]) -> None:
        self._say("")
        there = {one.folder for one in self._sets}
        self._sets += [ChosenSet(folder) for folder in folders if folder not in there]
        self._show()

    def _remove(self) -> None:
        del self._sets[self.table.current_row()]
        self._show()

    def _set(self, field: str, value: Any) -> None:
        """Measure otherwise from now on."""
        try:
            if field == "channel":
                changed = replace(self._options, channel=value or None)
            else:
                changed = changed_options("scan", self._options, None, field, value)
                changed = replace(changed, plane_stripe=changed.stripe)
        except (InputError, ValueError) as error:
            self._say(text_of(error))
        else:
            self._say("")
            if changed != self._options:
                self._options = changed
                self._measure_all_again()
        self._show()

    def _measure_all_again(self) -> None:
        """With other settings, or in another folder, there are no results yet."""
        for one in self._sets:
            one.result = None
        self._show()

    def _stop(self) -> None:
        if self._task is not None:
            self._task.cancel()
            self._show()

    def _told(self, number: int, told: SetProgress | SetResult | None) -> None:
        one = self._measured[number]
        if isinstance(told, SetResult):
            one.running, one.result = None, told
        else:
            one.running = told or SetProgress("", 0.0)
        self._show()

    def _progressed(self, stage: str, done: int, total: int) -> None:
        self._remaining.report(stage, done, total)
        self._done_share = done / total if total else 0.0
        self._show_progress()

    def _finished(self, results: Sequence[SetResult]) -> None:
        for one, result in zip(self._measured, results, strict=True):
            one.result = result
        self._done_share = 1.0
        self._ended()

    def _refused(self, problem: Exception | Failure) -> None:
        self._not_done(problem)
        self._ended()

    def _not_done(self, problem: Exception | Failure) -> None:
        self._say(text_of(problem))
        if isinstance(problem, Failure):  # a fault of the program: its details are for the log
            self._bench.notices.failed(problem)

    def _ended(self) -> None:
        for one in self._measured:
            one.running = None
        self._task = None
        self._show()

    def _show_progress(self) -> None:
        """The bars: within the chosen set if that is being measured, else within the first that is, and over all."""
        chosen = self._chosen()
        under_way = [one for one in (chosen, *self._measured) if one is not None and one.running is not None]
        now = under_way[0].running if under_way else None
        self.within.setValue(round(PARTS * now.share) if now is not None else 0)
        self.stage.setText(named(under_way[0].folder.name, tr(now.stage)) if now is not None and now.stage else "")
        self.bar.setValue(round(PARTS * self._done_share))
        for bar in (self.within, self.bar):
            bar.setVisible(bool(self._measured))
        done, total = sum(one.result is not None for one in self._measured), len(self._measured)
        said = [tr("{done} of {total} sets", done=done, total=total)] if total else []
        if self._task is not None and not self._task.cancelling and (left := self._remaining.left) is not None:
            said.append(tr("about {time} left", time=in_words(left)))
        self.counted.setText(joined(said, ";"))
        for widget in (self.within, self.stage):
            widget.setEnabled(self._task is not None)

    def _show(self) -> None:
        self.table.set_rows([_row(one) for one in self._sets], [one.reason or str(one.folder) for one in self._sets])
        running = tr("The sets are being measured.") if self._task is not None else ""
        enable(self.add, running, tr("Choose a recording set, or a folder with recording sets in it"))
        enable(self.browse, running, tr("Choose the folder for the results"))
        self.out.setReadOnly(bool(running))
        self.form.set_values({**values_of("scan", self._options), "channel": self._options.channel or ""})
        self.form.setEnabled(not running)
        set_stripe_editable(self.form, self._options.stripe is None)
        enable(self.settings, "", tr("How the sets are measured: method, largest σ, stripes, colour"))
        enable(self.measure, running or self._not_measurable(), tr("Measure the sets that are not done"))
        enable(self.stop, self._not_stoppable(), tr("Stop; what is done stays"))
        self._show_chosen()

    def _not_measurable(self) -> str:
        if not self._sets:
            return tr("Add recording sets first.")
        if not self.out.text().strip():
            return tr("Choose the folder for the results first.")
        return "" if any(one.state != "done" for one in self._sets) else tr("All sets are measured.")

    def _not_stoppable(self) -> str:
        if self._task is None:
            return tr("Nothing is being measured.")
        return tr("Stopping …") if self._task.cancelling else ""

    def _show_chosen(self) -> None:
        self._show_progress()
        chosen = self._chosen()
        self.reason.setText(chosen.reason if chosen is not None else "" if self._task else self._not_measurable())
        none = "" if chosen is not None else tr("Choose a set in the table first.")
        running = tr("The sets are being measured.") if self._task is not None else ""
        enable(self.remove, running or none, tr("Take the chosen set out of the table; its files stay"))
        result = chosen.result if chosen is not None else None
        missing = none or ("" if result is not None else tr("It is not measured yet."))
        refused = tr("It could not be measured.") if result is not None and result.error else ""
        enable(self.report, missing or refused, tr("Open the report of the chosen set"))
        no_folder = refused if result is not None and not result.out.is_dir() else ""
        enable(self.folder, missing or no_folder, tr("Open the folder with the results of the chosen set"))

    def _chosen(self) -> ChosenSet | None:
        row = self.table.current_row()
        return self._sets[row] if 0 <= row < len(self._sets) else None

    def _open_report(self) -> None:
        chosen = self._chosen()
        if chosen is not None and chosen.result is not None:
            path = chosen.result.out / EXPORTS["pdf"].file
            if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(path))):
                self._say(tr("Nothing here opens the report: {path}", path=path))

    def _open_folder(self) -> None:
        chosen = self._chosen()
        if chosen is not None and chosen.result is not None:
            folder = chosen.result.out
            if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder))):
                self._say(tr("Nothing here opens folders: {folder}", folder=folder))


def _row(one: ChosenSet) -> tuple[str, ...]:
    cells = ("",) * (len(SET_COLUMNS) - 1) if one.result is None else set_cells(one.result, wording())
    state = tr(SET_STATES[one.state])
    if one.running is not None:
        state = tr("{state}, {share:.0f} %", state=state, share=100 * one.running.share)
    return one.folder.name, state, *cells, one.reason
