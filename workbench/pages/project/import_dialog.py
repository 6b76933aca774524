"""Import pictures: which folders hold what, a preview of what was understood, and only then a recording set."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from core.files.recording.import_pictures import Imported
from core.files.recording.import_plan import ImportedPicture, ImportPlan, ImportRequest, Order, Where
from workbench.bench import Bench
from workbench.language import joined, named, sentence, text_of, tr
from workbench.views import ask
from workbench.views.common import Choice
from workbench.views.image.side_by_side import SideBySide
from workbench.views.image.view import ImageView
from workbench.views.layouts import NO_MARGINS, Folding, in_row, resize_on_screen
from workbench.views.lists.data_table import DataTable
from workbench.work import jobs

_QUIET_MS = 300
"""What is typed is looked at when nothing more was typed for so long."""
_PREVIEW_PX = 900
"""Pictures are shown so wide at most."""


class ImportDialog(QDialog):
    """Dialog that asks where pictures lie; nothing is written before the preview was shown and Import pressed.

    Stays open for as long as `imported` has not come; to be shown with `open`.
    """

    imported = Signal(object, object)
    """The `Imported` set, and the `ImportPlan` it was made by."""

    def __init__(self, bench: Bench, set_folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._bench = bench
        self._plan: ImportPlan | None = None
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
        calibration, measurement = QFormLayout(), QFormLayout()
        for form in (calibration, measurement):
            form.setContentsMargins(*NO_MARGINS)
        for form, label, field in (
            (calibration, tr("Views of the camera's target"), self.camera),
            (calibration, tr("Poses of the plate, fan on"), self.planes),
            (calibration, tr("The same poses, fan off"), self.planes_off),
            (measurement, tr("Frames of a scan"), self.scan),
            (measurement, tr("Poses of the check, fan on"), self.check),
            (measurement, tr("The same poses, fan off"), self.check_off),
            (measurement, tr("Boards beside the part"), self.known_planes),
        ):
            field.setPlaceholderText(tip)
            field.textChanged.connect(self._changed)
            form.addRow(label, self._with_browse(field, label))
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
        column = QVBoxLayout(self)
        column.addWidget(Folding(calibration, measurement, spacing=14))
        column.addLayout(whole)
        column.addWidget(preview, 1)
        column.addWidget(self.words)
        column.addWidget(self.buttons)

    def _with_browse(self, field: QLineEdit, label: str) -> QHBoxLayout:
        field.setAccessibleName(label)
        browse = QPushButton(tr("Browse …"))
        browse.setAccessibleName(f"{label}: {browse.text()}")
        browse.setAutoDefault(False)

        def choose() -> None:
            text = field.text().strip()
            chosen = ask.choose_folder(self, label, Where.typed(text).folder if text else Path.home())
            if chosen is not None:
                field.setText(str(chosen))

        browse.clicked.connect(choose)
        return in_row((field, 1), browse)

    def _changed(self, *_: Any) -> None:
        """Something else is asked for: what was understood no longer counts."""
        self._plan = None
        self._show_whether()
        self._look.start()

    def _ask_for_plan(self) -> None:
        request = self.request()
        if request == ImportRequest(order=request.order):
            self._show_plan(None)
            return

        def answer(show: Any) -> Any:
            return lambda result: show(result) if request == self.request() else None

        self._bench.quick.run(
            self,
            jobs.PLAN_IMPORT,
            request,
            label=tr("Looking at the folders"),
            on_done=answer(self._show_plan),
            on_failed=answer(self._show_problem),
            offers={},
            replace_waiting=True,
        )

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
        self._show_picture(self.on, None if shown is None else shown.source)
        self._show_picture(self.off, None if shown is None else shown.off)

    def _show_picture(self, view: ImageView, path: Path | None) -> None:
        if path is None:
            view.clear()
            return

        def show(made: tuple[NDArray[np.uint8], int]) -> None:
            view.set_picture(made[0], scale=made[1], keep_view=False)

        def tell(problem: Exception) -> None:
            view.clear(text_of(problem))

        self._bench.quick.run(
            view,
            jobs.DISPLAY_PICTURE,
            path,
            None,
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
        self.setEnabled(False)

        def done(imported: Imported) -> None:
            for note in imported.notes:  # without one on rig.toml: the pages have fields for targets and laser
                self._bench.notices.warning(text_of(note))
            self.accept()
            self.imported.emit(imported, plan)

        self._bench.measuring.run(
            self,
            jobs.IMPORT_PICTURES,
            plan,
            Path(self.target.text().strip()),
            label=tr("Importing pictures"),
            on_done=done,
            on_failed=self._failed,
            on_cancelled=lambda: self.setEnabled(True),
        )

    def _failed(self, problem: Exception) -> None:
        self.setEnabled(True)
        self.words.setText(text_of(problem))


def _row(one: ImportedPicture) -> tuple[str, str, str]:
    return one.files()[0][0], one.source.name, "" if one.off is None else one.off.name
