"""Import pictures and films: what lies where, a preview of what was understood, and only then a recording set."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QProgressBar,
    QPushButton,
    QSplitter,
    QWidget,
)

from core.files.film import FILMS, PERHAPS_MOVING, FilmFrame
from core.files.recording.import_pictures import Imported
from core.files.recording.import_plan import ImportedPicture, ImportPlan, ImportRequest, Order, Where
from workbench.bench import Bench
from workbench.language import joined, named, sentence, text_of, tr
from workbench.views import ask
from workbench.views.common import Choice
from workbench.views.image.side_by_side import SideBySide
from workbench.views.image.view import ImageView
from workbench.views.layouts import NO_MARGINS, Folding, holding, in_column, in_row, resize_on_screen
from workbench.views.lists.data_table import DataTable
from workbench.work import jobs
from workbench.work.tasks import Task

_QUIET_MS = 300
"""What is typed is looked at when nothing more was typed for so long."""
_KINDS = "AVI, MP4, MOV, MKV, GIF, PNG, WebP ({})".format(
    " ".join(f"*{ending}" for ending in sorted((*FILMS, *PERHAPS_MOVING)))
)
"""What a film may be."""
_MARGINS = (9, 9, 9, 9)
"""Around the dialog, px, as Qt has them by itself."""
_PREVIEW_PX = 900
"""Pictures are shown so wide at most."""


class ImportDialog(QDialog):
    """Dialog that asks where pictures lie; nothing is written before the preview was shown and Import pressed.

    Stays open for as long as `imported` has not come; to be shown with `open`. Cancel ends an import that runs, and
    closes the dialog if none does. A `film` is taken for that of a scan.
    """

    imported = Signal(object, object)
    """The `Imported` set, and the `ImportPlan` it was made by."""

    def __init__(self, bench: Bench, set_folder: Path, parent: QWidget | None = None, film: Path | None = None) -> None:
        super().__init__(parent)
        self._bench = bench
        self._plan: ImportPlan | None = None
        self._task: Task | None = None
        self.setWindowTitle(tr("Import pictures"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        resize_on_screen(self, 1100, 720)
        self.camera, self.planes, self.planes_off = (QLineEdit() for _ in range(3))
        self.scan, self.check, self.check_off, self.known_planes = (QLineEdit() for _ in range(4))
        self.target, self.order = QLineEdit(str(set_folder)), Choice()
        self.order.addItem(tr("By name (2 before 10)"), Order.NAME)
        self.order.addItem(tr("By the time they were taken"), Order.TIME)
        self.table, self.on, self.off, self.words = DataTable(), ImageView(), ImageView(), QLabel()
        self.table.set_headers([(tr("Name in the set"), ""), (tr("Picture"), ""), (tr("Fan off"), "")])
        self.words.setWordWrap(True)
        self.words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.bar = QProgressBar()
        self.bar.hide()
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.do_import = self.buttons.addButton(tr("Import"), QDialogButtonBox.ButtonRole.AcceptRole)
        self._look = QTimer(self)
        self._look.setSingleShot(True)
        self._look.setInterval(_QUIET_MS)
        self._look.timeout.connect(self._ask_for_plan)
        self._arrange()
        self.order.currentIndexChanged.connect(self._changed)
        self.target.textChanged.connect(self._show_whether)
        self.table.current_row_changed.connect(self._show_pictures)
        self.buttons.rejected.connect(self.reject)
        self.do_import.clicked.connect(self._import)
        self._show_plan(None)
        if film is not None:
            self.scan.setText(str(film))

    def request(self) -> ImportRequest:
        """Make the import request from the fields of the dialog."""
        fields = {
            **{"camera": self.camera, "planes": self.planes, "planes_off": self.planes_off},
            **{"scan": self.scan, "check": self.check, "check_off": self.check_off},
            "known_planes": self.known_planes,
        }
        asked: dict[str, Any] = {
            name: Where.typed(text) for name, one in fields.items() if (text := one.text().strip())
        }
        return ImportRequest(**asked, order=Order(self.order.currentData()))

    def _arrange(self) -> None:
        tip = tr("A folder, or a folder and a pattern of names: shots/laser_*.jpg")
        or_film = tr("A folder, a film, or a folder and a pattern of names: shots/laser_*.jpg")
        calibration, measurement = QFormLayout(), QFormLayout()
        for form in (calibration, measurement):
            form.setContentsMargins(*NO_MARGINS)
        for form, label, field, film in (
            (calibration, tr("Views of the camera's target"), self.camera, True),
            (calibration, tr("Poses of the plate, fan on"), self.planes, True),
            (calibration, tr("The same poses, fan off"), self.planes_off, False),
            (measurement, tr("Frames of a scan"), self.scan, True),
            (measurement, tr("Poses of the check, fan on"), self.check, True),
            (measurement, tr("The same poses, fan off"), self.check_off, False),
            (measurement, tr("Boards beside the part"), self.known_planes, False),
        ):
            field.setPlaceholderText(or_film if film else tip)
            field.textChanged.connect(self._changed)
            field.installEventFilter(self)
            form.addRow(label, self._with_browse(field, label, film=film))
        whole = QFormLayout()
        whole.addRow(tr("Order"), self.order)
        whole.addRow(tr("Recording set to make"), self._with_browse(self.target, tr("Recording set to make")))
        pictures = SideBySide()
        pictures.add_view(tr("Picture"), self.on)
        pictures.add_view(tr("Fan off"), self.off)
        preview = QSplitter(Qt.Orientation.Horizontal)
        preview.addWidget(self.table)
        preview.addWidget(pictures)
        preview.setSizes([420, 640])
        column = in_column(Folding(calibration, measurement, spacing=14), whole, (preview, 1), margins=NO_MARGINS)
        self._asked = holding(column)
        in_column((self._asked, 1), self.words, self.bar, self.buttons, on=self, margins=_MARGINS)

    def _with_browse(self, field: QLineEdit, label: str, *, film: bool = False) -> QHBoxLayout:
        field.setAccessibleName(label)
        browse = QPushButton(tr("Browse …"))
        browse.setAccessibleName(f"{label}: {browse.text()}")
        browse.setAutoDefault(False)

        def put(chosen: Path | None) -> None:
            if chosen is not None:
                field.setText(str(chosen))

        def start() -> Path:
            text = field.text().strip()
            folder = Where.typed(text).folder if text else Path.home()
            return folder.parent if folder.is_file() else folder

        def choose_folder() -> None:
            put(ask.choose_folder(self, label, start()))

        def choose_film() -> None:
            put(ask.choose_file_to_open(self, label, start(), _KINDS))

        if film:
            menu = QMenu(browse)
            menu.addAction(tr("Folder …"), choose_folder)
            menu.addAction(tr("Film …"), choose_film)
            browse.setMenu(menu)
        else:
            browse.clicked.connect(choose_folder)
        return in_row((field, 1), browse)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take a folder or film that is dropped on a field as its path."""
        if isinstance(watched, QLineEdit) and isinstance(event, QDropEvent):  # the base of drags, too
            paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
            if paths:
                event.acceptProposedAction()
                if event.type() == QEvent.Type.Drop:
                    watched.setText(str(paths[0]))
                return True
        return super().eventFilter(watched, event)

    def reject(self) -> None:
        """Cancel the import that runs; close the dialog if none does."""
        task, importing = self._task, not self._asked.isEnabled()
        if task is not None:
            task.cancel()
        if not importing:
            super().reject()

    def _watch(self, task: Task | None) -> None:
        """Show how far a task is, and let Cancel be for it; None shows nothing."""
        self._task = task
        self.bar.hide()
        if task is None:
            return

        def progressed(stage: str, done: int, total: int) -> None:
            if task is self._task:
                self.bar.setRange(0, total)
                self.bar.setValue(done)
                self.bar.setFormat(tr("{stage}, {done} of {total}", stage=tr(stage), done=done, total=total))
                self.bar.show()

        def ended() -> None:
            if task is self._task:
                self._watch(None)

        task.progressed.connect(progressed)
        task.ended.connect(ended)

    def _changed(self, *_: Any) -> None:
        """Something else is asked for: what was understood no longer counts."""
        self._plan = None
        self._show_whether()
        if self._task is not None:
            self._task.cancel()
        self._look.start()

    def _ask_for_plan(self) -> None:
        request = self.request()
        if request == ImportRequest(order=request.order):
            self._show_plan(None)
            return

        def answer(show: Any) -> Any:
            return lambda result: show(result) if request == self.request() else None

        task = self._bench.quick.run(
            self,
            jobs.PLAN_IMPORT,
            request,
            label=tr("Looking at the folders"),
            on_done=answer(self._show_plan),
            on_failed=answer(self._show_problem),
            replace_waiting=True,
        )
        self._watch(task)

    def _show_plan(self, plan: ImportPlan | None) -> None:
        self._plan = plan
        pictures = () if plan is None else plan.pictures
        self.table.set_rows([_row(one) for one in pictures], [str(one.source) for one in pictures])
        if plan is None:
            told = [tr("Nothing is written before you press Import; the pictures themselves stay as they are.")]
        else:
            told = [
                named(part, sentence(joined((str(len(found)), text_of(plan.rules[part])), ";")))
                for part, found in plan.parts.items()
            ]
            told += [f"⚠ {text_of(note)}" for note in plan.notes]
            told += [text_of(one) for one in plan.proposals]
        self.words.setText("\n".join(told))
        self._show_whether()
        first = next((place for place, one in enumerate(pictures) if one.off is not None), 0 if pictures else -1)
        self.table.set_current_row(first)
        self._show_pictures(first)

    def _show_problem(self, problem: Exception) -> None:
        self._show_plan(None)
        self.words.setText(text_of(problem))

    def _show_whether(self, *_: Any) -> None:
        self.do_import.setEnabled(self._plan is not None and bool(self.target.text().strip()))

    def _show_pictures(self, row: int) -> None:
        pictures = () if self._plan is None else self._plan.pictures
        shown = pictures[row] if 0 <= row < len(pictures) else None
        self._show_picture(self.on, None if shown is None else shown.source, None if shown is None else shown.frame)
        self._show_picture(self.off, None if shown is None else shown.off)

    def _show_picture(self, view: ImageView, path: Path | None, frame: FilmFrame | None = None) -> None:
        if path is None:
            view.clear()
            return
        job, *which = (jobs.DISPLAY_PICTURE, None) if frame is None else (jobs.DISPLAY_FRAME, frame.number)

        def show(made: tuple[NDArray[np.uint8], int]) -> None:
            view.set_picture(made[0], scale=made[1], keep_view=False)

        def tell(problem: Exception) -> None:
            view.clear(text_of(problem))

        self._bench.quick.run(
            view,
            job,
            path,
            *which,
            _PREVIEW_PX,
            label=tr("Reading the picture"),
            on_done=show,
            on_failed=tell,
            replace_waiting=True,
        )

    def _import(self) -> None:
        plan = self._plan
        if plan is None:
            return
        self._ask(False)

        def done(imported: Imported) -> None:
            for note in imported.notes:  # without one on rig.toml: the pages have fields for targets and laser
                tell = self._bench.notices.info if note in plan.proposals else self._bench.notices.warning
                tell(text_of(note))
            self.accept()
            self.imported.emit(imported, plan)

        task = self._bench.measuring.run(
            self,
            jobs.IMPORT_PICTURES,
            plan,
            Path(self.target.text().strip()),
            label=tr("Importing pictures"),
            on_done=done,
            on_failed=self._failed,
            on_cancelled=lambda: self._ask(True),
        )
        self._watch(task)

    def _ask(self, again: bool) -> None:
        """Let the fields be changed, or not while an import runs; Cancel stays."""
        self._asked.setEnabled(again)
        if again:
            self._show_whether()
        else:
            self.do_import.setEnabled(False)

    def _failed(self, problem: Exception) -> None:
        self._ask(True)
        self.words.setText(text_of(problem))


def _row(one: ImportedPicture) -> tuple[str, str, str]:
    return one.files()[0][0], one.shown_name, "" if one.off is None else one.off.name
