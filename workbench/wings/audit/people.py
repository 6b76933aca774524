"""People of the open project: who has signed in by name and PIN, and what that person may change."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QWidget

from core.errors import InputError
from core.files.project.data import Project, ProjectFile
from core.files.project.witness import Signed
from core.wings.audit.people import Rules, needs_reason, read_rules, refused, with_pin
from workbench.bench import Bench
from workbench.language import tr
from workbench.project_model import EditGuard
from workbench.views import ask
from workbench.wings.audit import pin

if TYPE_CHECKING:
    from workbench.main_window import MainWindow


def guard_of(bench: Bench, window: QWidget) -> EditGuard:
    """Make the guard by people and roles; one that is there stays, with who has signed in, and asks in this window."""
    there = bench.model.guard
    guard = there if isinstance(there, PeopleGuard) else PeopleGuard(bench)
    guard.window = window
    return guard


def signing_in(bench: Bench, window: MainWindow) -> Callable[[], object]:
    """Make the function that signs a person in or out, to be called by the menu entry."""

    def sign_in() -> None:
        guard = bench.model.guard
        if isinstance(guard, PeopleGuard):
            guard.sign_in_or_out(window.projects.save)

    return sign_in


class PeopleGuard(EditGuard):
    """EditGuard by the people of the open project, their roles, and whether changed limits want a reason."""

    keeps_people = True

    def __init__(self, bench: Bench) -> None:
        self._bench, self._model = bench, bench.model
        self.window: QWidget | None = None
        self.rules = Rules()
        self.read(self._model.folder)()

    @property
    def names(self) -> list[str]:
        """Names of the people of the project."""
        return [one.name for one in self.rules.people]

    def read(self, folder: Path | None) -> Callable[[], None]:
        rules = Rules() if folder is None else read_rules(folder)

        def put_in_force() -> None:
            self.rules, self.signed_in = rules, None

        return put_in_force

    def reason(self, label: str, before: ProjectFile, after: Project) -> str | None:
        refusal = refused(self.rules, self.signed_in, before.project, after)
        if refusal is not None:
            self._model.failed.emit(refusal)
            return None
        if not needs_reason(self.rules, before.results, before.project, after):
            return ""
        text = tr(
            "Something was judged by these limits already. Why are they changed ({what})? It stays for good.",
            what=label,
        )
        return ask.ask_line(self.window, tr("Reason"), text) or None

    def sign_in(self, name: str, secret: str) -> None:
        """Sign a person in as the author of all further changes; InputError if name and PIN do not match.

        What was done before cannot be undone by somebody who may not.
        """
        self.signed_in = with_pin(self.rules, name, secret)
        self._model.undo_stack.clear()

    def sign_out(self) -> None:
        """Sign the person out; further changes are recorded without a name."""
        self.signed_in = None
        self._model.undo_stack.clear()

    def stay_signed_in(self, person: Signed | None) -> None:
        if person in self.rules.people:
            self.signed_in = person

    def sign_in_or_out(self, save: Callable[[], bool]) -> None:
        """Sign a person in by name and PIN, or sign out who is signed in; changes are saved before by `save`.

        Recovered changes that nobody may save without a name do not keep a person from signing in.
        """
        if not self.rules.people:
            text = tr(
                "Nobody is named in this project, so everybody may do everything. The manual says how to name people."
            )
            self._bench.notices.info(text)
            return
        saved = save()
        if self.signed_in is None:
            self._ask_who()
        elif saved:
            self.sign_out()
            self._bench.notices.info(tr("Signed out."))

    def may_leave_operator_mode(self) -> bool:
        if not self.rules.people:
            return True
        if not self._ask_who():
            return False
        if self.signed_in is None or self.signed_in.role == "operator":
            self._bench.notices.warning(tr("Only an inspector or administrator may leave operator mode."))
            return False
        return True

    def _ask_who(self) -> bool:
        """Ask for name and PIN; False if they are not given, or do not belong together."""
        given = pin.ask_name_and_pin(self.window, tr("Sign in"), self.names)
        if given is None:
            return False
        try:
            self.sign_in(*given)
        except InputError as error:
            self._bench.notices.failed(error)
            return False
        self._bench.notices.info(tr("{name} has signed in.", name=given[0]))
        return True


def names_of_people(bench: Bench) -> list[str]:
    """List the names of the open project's people."""
    guard = bench.model.guard
    return guard.names if isinstance(guard, PeopleGuard) else []
