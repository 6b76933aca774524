"""Panels at the side of the camera page: how far it is and what to do next, and the target."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QFrame, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from workbench.pages.camera_presenter import CameraPresenter, Stage
from workbench.pages.target_values import DICTIONARIES, PAPERS
from workbench.theme import icon
from workbench.views import ask
from workbench.views.forms import SettingsForm


class StagePanel(QFrame):
    """How far the calibration is, what to do next, and the buttons for it; the next one is the primary."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.setObjectName("card")
        self.title, self.words = QLabel(), QLabel()
        self.title.setObjectName("heading")
        self.words.setObjectName("muted")
        for label in (self.title, self.words):
            label.setWordWrap(True)
        self.calibrate = QPushButton(self.tr("Calibrate"))
        self.accept = QPushButton(self.tr("Accept"))
        self.reject = QPushButton(self.tr("Reject"))
        self.calibrate.clicked.connect(lambda: presenter.do_run())
        self.accept.clicked.connect(lambda: presenter.accept())
        self.reject.clicked.connect(lambda: presenter.reject())
        buttons = QHBoxLayout()
        buttons.setSpacing(6)
        for button in (self.calibrate, self.accept, self.reject):
            button.setIconSize(button.iconSize() * 0.9)
            buttons.addWidget(button, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(10, 8, 10, 10)
        column.addWidget(self.title)
        column.addWidget(self.words)
        column.addLayout(buttons)

    def refresh(self) -> None:
        """Show the stage."""
        p = self._presenter
        title, words = self._words()[p.stage]
        self.title.setText(title)
        self.words.setText(words)
        for button, why_not, tip, symbol in (
            (self.calibrate, p.can_search, self.tr("Find the target in all pictures and solve the camera (Ctrl+R)"),
             "mdi6.play"),
            (self.accept, p.can_accept, self.tr("Measure with this calibration from now on (Ctrl+Return)"),
             "mdi6.check-bold"),
            (self.reject, p.can_reject, self.tr("Do not measure with this calibration"), "mdi6.close-thick"),
        ):  # fmt: skip
            button.setEnabled(not why_not)
            button.setToolTip(why_not or tip)
            main = button is self._main()
            button.setIcon(icon(symbol, colour="on_accent" if main and not why_not else ""))
            if button.property("primary") != main:
                button.setProperty("primary", main)
                button.style().unpolish(button)
                button.style().polish(button)

    def _main(self) -> QPushButton | None:
        stage = self._presenter.stage
        if stage is Stage.SOLVED:
            return self.accept
        return self.calibrate if stage in (Stage.FOUND, Stage.FAILED, Stage.OUTDATED) else None

    def _words(self) -> dict[Stage, tuple[str, str]]:
        p = self._presenter
        pictures = len(p.work.pictures or ())
        return {
            Stage.NONE: (
                self.tr("No pictures yet"),
                self.tr("Choose a folder of pictures of the target, or take them with a live source."),
            ),
            Stage.EMPTY: (self.tr("No pictures there"), self.tr("The folder holds no pictures; choose another one.")),
            Stage.FOUND: (
                self.tr("{0} pictures, not searched yet").format(pictures),
                self.tr("Check the target below, then press Calibrate."),
            ),
            Stage.LIVE: (
                p.live.state_text(),
                self.tr("Show the target from many sides; stop when nothing is missing."),
            ),
            Stage.SEARCHING: (
                self.tr("Searching the pictures …"),
                self.tr("The target is looked for in each picture."),
            ),
            Stage.SOLVING: (self.tr("Solving …"), self.tr("The camera is being solved anew.")),
            Stage.FAILED: (self.tr("No calibration"), p.work.problem),
            Stage.SOLVED: (
                self.tr("Calibrated, not accepted yet"),
                self.tr("Look at the views and the residuals; leave out what is bad, then accept."),
            ),
            Stage.REJECTED: (
                self.tr("Rejected"),
                self.tr("Leave out bad views, or take other pictures; or accept it after all."),
            ),
            Stage.ACCEPTED: (self.tr("Accepted"), p.state.sentence),
            Stage.OUTDATED: (self.tr("Accepted, but out of date"), p.state.sentence),
        }


class TargetPanel(QWidget):
    """What the camera is shown, and how to print it."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._kind = ""
        self._holder = QVBoxLayout()
        self._holder.setContentsMargins(0, 0, 0, 0)
        self.form = SettingsForm()
        self._holder.addWidget(self.form)
        self.paper, self.print = QComboBox(), QPushButton(self.tr("Printable PDF …"))
        for paper in PAPERS:
            self.paper.addItem(paper, paper)
        self.paper.setCurrentText("A4")
        self.paper.setToolTip(self.tr("Paper the target is printed on"))
        self.paper.setAccessibleName(self.tr("Paper"))
        self.print.setToolTip(self.tr("Write this target to scale as a PDF, with rulers to check the print"))
        self.print.clicked.connect(lambda: self._print())
        row = QHBoxLayout()
        row.addWidget(self.paper)
        row.addWidget(self.print, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addLayout(self._holder)
        column.addLayout(row)
        presenter.target_refused.connect(lambda field, why: self.form.set_complaint(field, why))

    def refresh(self) -> None:
        """Show the target."""
        self.print.setIcon(icon("mdi6.printer-outline"))
        values = self._presenter.target_values()
        if values["kind"] != self._kind:
            self._build(values["kind"])
        self.form.set_values(values)

    def _build(self, kind: str) -> None:
        """The fields of another kind of target."""
        self._kind = kind
        old, self.form = self.form, SettingsForm()
        self._holder.replaceWidget(old, self.form)
        old.hide()
        old.deleteLater()
        form = self.form
        kinds = [
            ("checkerboard", self.tr("Checkerboard")),
            ("charuco", self.tr("ChArUco board")),
            ("circle_grid", self.tr("Circle grid")),
        ]
        form.add_choice("kind", self.tr("Kind"), kinds, self.tr("What is printed on the target."))
        counted = {
            "checkerboard": self.tr("Inner corners, where four squares meet."),
            "charuco": self.tr("Squares, black and white ones."),
            "circle_grid": self.tr("Circles."),
        }[kind]
        form.add_number("columns", self.tr("Columns"), "", counted, minimum=3, maximum=500)
        form.add_number("rows", self.tr("Rows"), "", minimum=3, maximum=500)
        length = self.tr("Pitch") if kind == "circle_grid" else self.tr("Square")
        form.add_number(
            "size_mm", length, "mm", self.tr("Measure it on the print: all lengths rest on it."),
            minimum=0.1, maximum=5000, decimals=3, step=0.1,
        )  # fmt: skip
        if kind == "charuco":
            form.add_number("marker_mm", self.tr("Marker"), "mm", minimum=0.1, maximum=5000, decimals=3, step=0.1)
            names = [(name, name.removeprefix("DICT_").replace("_", ", ")) for name in DICTIONARIES]
            form.add_choice(
                "dictionary", self.tr("Markers"), names, self.tr("Size of a marker, and how many there are.")
            )
        if kind == "circle_grid":
            form.add_check("asymmetric", self.tr("Every second row moved"))
        form.edited.connect(self._presenter.set_target, Qt.ConnectionType.QueuedConnection)
        QWidget.setTabOrder(form, self.paper)

    def _print(self) -> None:
        start = Path.home() / f"{self._kind}-target.pdf"
        path = ask.choose_file_to_save(self, self.tr("Write the target as a PDF"), start, self.tr("PDF (*.pdf)"))
        if path is not None:
            path = path if path.suffix.lower() == ".pdf" else path.with_name(f"{path.name}.pdf")
            self._presenter.print_target(path, str(self.paper.currentData()))
