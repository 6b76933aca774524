"""The audit trail of the open project in a window: looked through, checked, remarked on, handed over as a table."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtWidgets import QDialog, QInputDialog, QPlainTextEdit, QPushButton, QWidget

from core.errors import InputError
from core.files.atomic import write_text
from core.messages import visible
from core.wings.audit.people import ROLE_NAMES, sign
from core.wings.audit.trail import WHAT_NAMES, Entry, Trail, append, read_trail, trail_table
from workbench.bench import Bench
from workbench.language import text_of, time_of, tr
from workbench.views import ask
from workbench.views.layouts import STRETCH, enable, in_column, in_row, muted, resize_on_screen, set_text
from workbench.wings.audit import jobs, pin
from workbench.wings.audit.people import names_of_people

if TYPE_CHECKING:
    from core.wings.audit.verify import Verified
    from workbench.main_window import MainWindow


def trail_of(bench: Bench, window: MainWindow) -> Callable[[], object]:
    """Make the function that saves the project and shows its audit trail, to be called by the menu entry."""

    def show() -> None:
        if bench.model.folder is not None:
            if not bench.model.is_read_only:
                window.projects.save()
            AuditWindow(bench, bench.model.folder, window).exec()

    return show


class AuditWindow(QDialog):
    """Window with every entry, the newest first, and whether the chain, and if asked for every file, is unchanged."""

    def __init__(self, bench: Bench, folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._bench, self._folder = bench, folder
        self._trail = Trail()
        self.setWindowTitle(tr("Audit trail"))
        resize_on_screen(self, 820, 560)
        self.state, self.found, self.entries = muted(), muted(), QPlainTextEdit()
        set_text(self.found, "")
        self.entries.setReadOnly(True)
        self.entries.setAccessibleName(tr("Entries of the audit trail"))
        self.remark = QPushButton(tr("Add a remark …"))
        self.remark.clicked.connect(self._ask_for_remark)
        self.sign = QPushButton(tr("Sign …"))
        self.sign.clicked.connect(self._ask_for_signature)
        fixed = tr("This project is read-only.") if bench.model.is_read_only else ""
        unnamed = "" if names_of_people(bench) else tr("Nobody is named in this project, so nobody can sign.")
        enable(self.remark, fixed, tr("Say why something was done; it stays for good."))
        enable(self.sign, fixed or unnamed, tr("Sign the project as it is, by name and PIN."))
        self.verify = QPushButton(tr("Check all files"))
        self.verify.setToolTip(tr("Compare results and pictures with what they were when the results were made"))
        self.verify.clicked.connect(self._verify)
        self.export = QPushButton(tr("Export …"))
        self.export.clicked.connect(self._export)
        close = QPushButton(tr("Close"))
        close.setDefault(True)  # else Return, while one reads, would mean the first button
        close.clicked.connect(self.accept)
        in_column(
            self.state,
            self.found,
            (self.entries, 1),
            in_row(self.verify, self.remark, self.sign, self.export, STRETCH, close),
            on=self,
            margins=(14, 10, 14, 12),
        )
        self._show()

    def add_remark(self, text: str) -> None:
        """Add an entry with the text of a remark to the audit trail."""
        if text.strip():
            try:
                append(self._folder, "remark", why=text.strip())
            except InputError as error:
                self._bench.notices.failed(error)
            self._show()

    def _verify(self) -> None:
        """Compare every file that has a hash, as `trisect verify` does."""
        reading = tr("The files are being compared.")
        enable(self.verify, reading, "")
        set_text(self.found, reading)
        task = self._bench.quick.run(
            self,
            jobs.VERIFY,
            self._folder,
            label=tr("Comparing the files"),
            on_done=self._verified,
            on_failed=lambda problem: self.found.setText(text_of(problem)),
            on_cancelled=lambda: set_text(self.found, ""),
        )
        task.ended.connect(lambda: enable(self.verify, "", tr("Compare them again")))

    def _verified(self, found: Verified) -> None:
        said: list[Any] = [*found.problems, *found.notes]
        if not found.problems:
            all_well = tr(
                "All files are what they were: {results} results, and {inputs} files they were made of.",
                results=found.results,
                inputs=found.inputs,
            )
            said.insert(0, all_well)
        self.found.setText("\n".join(map(text_of, said)))

    def _ask_for_signature(self) -> None:
        given = pin.ask_name_and_pin(self, tr("Sign"), names_of_people(self._bench))
        meaning = "" if given is None else ask.ask_line(self, tr("Sign"), tr("What the signature means:"))
        if given is not None and meaning:
            try:
                sign(self._folder, *given, meaning)
            except InputError as error:
                self._bench.notices.failed(error)
            self._show()

    def _show(self) -> None:
        try:
            self._trail = trail = read_trail(self._folder)
        except InputError as error:
            self.state.setText(text_of(error))
            return
        whole = tr("{n} entries, each chained to the one before. Head: {head}", n=len(trail.entries), head=trail.head)
        self.state.setText(" ".join(map(text_of, trail.problems)) or whole)
        self.entries.setPlainText("\n\n".join(_in_words(entry) for entry in reversed(trail.entries)))

    def _ask_for_remark(self) -> None:
        text, given = QInputDialog.getMultiLineText(self, tr("Add a remark"), tr("It stays for good:"))
        if given:
            self.add_remark(text)

    def _export(self) -> None:
        start = self._folder.parent / f"{self._folder.name}-audit.csv"
        path = ask.choose_file_to_save(self, tr("Export the audit trail"), start, "CSV (*.csv)")
        if path is None:
            return
        try:
            write_text(path, trail_table(self._trail))
        except InputError as error:
            self._bench.notices.failed(error)


def _in_words(entry: Entry) -> str:
    lines = [f"{entry.n}  {time_of(entry.at, seconds=True)}  {entry.who}@{entry.host}  {tr(WHAT_NAMES[entry.what])}"]
    lines += [f"    {entry.by} ({tr(ROLE_NAMES[entry.role])})"] if entry.role in ROLE_NAMES else []
    lines += [f"    {one.field}: {one.old or '–'} → {one.new or '–'}" for one in entry.changes]
    lines += [f"    {name}  {digest}" for name, digest in entry.files.items()]
    lines += [f"    {entry.why}"] if entry.why else []
    return visible("\n".join(lines), keep="\n")
