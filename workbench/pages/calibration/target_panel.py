"""The form of a calibration target, and how to print it. Shared by the pages that have one."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

from PySide6.QtCore import Qt, SignalInstance
from PySide6.QtWidgets import QPushButton, QVBoxLayout, QWidget

from core.calibrate.board_shape import MADE
from core.files.recording.rig import SMALLEST_PRINTED_MM
from core.image.targets.kinds import DICTIONARIES
from workbench.language import tr
from workbench.pages.calibration.target import PAPERS, USUAL_U
from workbench.theme import icon
from workbench.views import ask
from workbench.views.common import Choice
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import in_column, in_row


class HasTarget(Protocol):
    """Interface of a presenter with a target."""

    target_refused: SignalInstance
    """Field of the target and why it cannot be so; an empty sentence if it can."""

    def target_values(self) -> dict[str, Any]: ...
    def set_target(self, field: str, value: Any) -> None: ...
    def print_target(self, path: Path, paper: str) -> None: ...


class TargetPanel(QWidget):
    """Panel with kind, size and tolerance of the target. `kinds` are those offered, in the order of the list."""

    def __init__(self, presenter: HasTarget, kinds: tuple[str, ...], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter, self._kinds = presenter, kinds
        self._kind = ""
        self._holder = QVBoxLayout()
        self._holder.setContentsMargins(0, 0, 0, 0)
        self.form = SettingsForm()
        self._holder.addWidget(self.form)
        self.paper, self.print = Choice(), QPushButton(icon("mdi6.printer-outline"), tr("Printable PDF …"))
        for paper in PAPERS:
            self.paper.addItem(paper, paper)
        self.paper.setCurrentText("A4")
        self.paper.setToolTip(tr("Paper the target is printed on"))
        self.paper.setAccessibleName(tr("Paper"))
        self.print.setToolTip(tr("Write this target to scale as a PDF, with rulers to check the print"))
        self.print.clicked.connect(lambda: self._print())
        row = in_row(self.paper, (self.print, 1))
        in_column(self._holder, row, on=self)
        presenter.target_refused.connect(self._complain)

    def _complain(self, field: str, why: str) -> None:
        self.form.set_complaint(field, why)

    def refresh(self) -> None:
        """Show the fields of the target and its tolerance."""
        values = self._presenter.target_values()
        if values["kind"] != self._kind:
            self._build(values["kind"])
        self.form.set_values(values)
        asked = tr("How was it made? Until you say, a print of an office printer is assumed, in every uncertainty.")
        self.form.ask("made", "" if values["made"] else asked)

    def _build(self, kind: str) -> None:
        """The fields of another kind of target."""
        self._kind = kind
        old, self.form = self.form, SettingsForm()
        self._holder.replaceWidget(old, self.form)
        old.hide()
        old.deleteLater()
        form = self.form
        kinds = [(name, kind_in_words(name)) for name in self._kinds]
        form.add_choice("kind", tr("Kind"), kinds, tr("What is printed on the target."))
        if kind != "black_square":
            self._add_counts(form, kind)
        length = {"circle_grid": tr("Pitch"), "black_square": tr("Side")}.get(kind, tr("Square"))
        form.add_number(
            "size_mm",
            length,
            NumberRange(SMALLEST_PRINTED_MM, 5000, decimals=3, step=0.1, unit="mm"),
            tr("Measure it on the print: all lengths rest on it."),
        )
        if kind == "charuco":
            form.add_number("marker_mm", tr("Marker"), NumberRange(0.1, 5000, decimals=3, step=0.1, unit="mm"))
            names = [(name, name.removeprefix("DICT_").replace("_", ", ")) for name in DICTIONARIES]
            form.add_choice("dictionary", tr("Markers"), names, tr("Size of a marker, and how many there are."))
        if kind == "circle_grid":
            form.add_check("asymmetric", tr("Every second row moved"))
        self._add_truth(form)
        form.edited.connect(self._presenter.set_target, Qt.ConnectionType.QueuedConnection)
        self._put_before_the_paper(old)

    def _add_truth(self, form: SettingsForm) -> None:
        """Fields for how true the target is; what is left empty is assumed, and the report says so."""
        made = [
            ("", tr("Not stated")),
            ("laser printer", tr("Printed here")),
            ("print shop", tr("By a print shop")),
            ("chrome on glass", tr("Chrome on glass")),
            ("stated", tr("By its certificate")),
        ]
        form.add_choice(
            "made", tr("How it was made"), made,
            tr("How true it is goes into every uncertainty; take the values of its certificate where it has one."),
        )  # fmt: skip
        unknown = MADE["laser printer"]
        form.add_number(
            "size_per_mille",
            tr("u of its size"),
            NumberRange(
                0.0, 100.0, decimals=3, step=0.05, unit="‰", none_text=tr("assumed"), first=unknown.size_sd * 1e3
            ),
            tr("Standard uncertainty of all its lengths."),
        )
        form.add_number(
            "flatness_mm",
            tr("Flatness"),
            NumberRange(
                0.0, 100.0, decimals=3, step=0.05, unit="mm", none_text=tr("assumed"), first=unknown.flatness_sd_mm
            ),
            tr("Standard deviation of its edges from its plane."),
        )
        if "margin_mm" in self._presenter.target_values():
            form.add_number(
                "margin_mm",
                tr("Margin"),
                NumberRange(0.0, 5000.0, decimals=1, step=1.0, unit="mm", none_text=tr("not known"), first=10.0),
                tr("How far the plate goes on beyond what is printed on it: stripes are looked for on it only."),
            )
            form.add_number(
                "celsius",
                tr("Temperature"),
                NumberRange(-50.0, 200.0, decimals=1, step=0.5, unit="°C", none_text=tr("assumed"), first=20.0),
                tr("The target's, while its pictures were taken. Empty: 20 °C with u = 3 °C, 2 µm in 50 mm."),
            )
            form.add_number(
                "u_celsius",
                tr("{name}, u", name=tr("Temperature")),
                NumberRange(0.0, 20.0, decimals=2, step=0.5, unit="°C", none_text=tr("assumed"), first=USUAL_U),
                tr("Standard uncertainty of that."),
            )

    def _put_before_the_paper(self, old: QWidget) -> None:
        """New fields come last when one goes on by Tab: let them come where they are seen."""
        before: QWidget | None = self.paper.previousInFocusChain()
        while before is not None and before is not self.paper and self._is_passed(before, old):
            before = before.previousInFocusChain()
        if before is None or before is self.paper:
            return
        for editor in self.form.editors():
            QWidget.setTabOrder(before, editor)
            before = editor

    def _is_passed(self, widget: QWidget, old: QWidget) -> bool:
        """Whether Tab passes a widget over, or it is part of this panel."""
        takes_focus = bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)
        return not takes_focus or widget is old or self.isAncestorOf(widget)

    def _add_counts(self, form: SettingsForm, kind: str) -> None:
        counted = {
            "checkerboard": tr("Inner corners, where four squares meet."),
            "charuco": tr("Squares, black and white ones."),
            "circle_grid": tr("Circles."),
        }[kind]
        form.add_number("columns", tr("Columns"), NumberRange(3, 500), counted)
        form.add_number("rows", tr("Rows"), NumberRange(3, 500))

    def _print(self) -> None:
        start = Path.home() / f"{self._kind}-target.pdf"
        path = ask.choose_file_to_save(self, tr("Write the target as a PDF"), start, tr("PDF (*.pdf)"))
        if path is not None:
            path = path if path.suffix.lower() == ".pdf" else path.with_name(f"{path.name}.pdf")
            self._presenter.print_target(path, str(self.paper.currentData()))


def kind_in_words(kind: str) -> str:
    """Return the name of a kind of target, as "charuco", in the window's language."""
    return {
        "checkerboard": tr("Checkerboard"),
        "charuco": tr("ChArUco board"),
        "circle_grid": tr("Circle grid"),
        "black_square": tr("Black square"),
    }[kind]
