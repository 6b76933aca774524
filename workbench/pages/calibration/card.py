"""How far a calibration is and what to do next, with the buttons for it."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

from PySide6.QtWidgets import QWidget

from core.messages import capital
from core.states import STEP_STATES
from workbench.language import tr
from workbench.pages.calibration.stage import Stage
from workbench.views.stage_card import CardButton, StageCard

STEADY = (Stage.SEARCHING, Stage.SOLVING, Stage.SOLVED, Stage.REJECTED, Stage.ACCEPTED, Stage.OTHER, Stage.OUTDATED)
"""From one to another of these a calibration comes, or is solved anew, while views or settings may be in hand."""


class CalibrationCard(StageCard):
    """Card with the stage; the next action is the primary button."""

    def __init__(self, presenter: Any, parent: QWidget | None = None) -> None:
        self._presenter = presenter
        super().__init__(
            [
                CardButton("run", tr("Calibrate"), "mdi6.play", presenter.do_run),
                CardButton("accept", tr("Accept"), "mdi6.check-bold", presenter.accept),
                CardButton("reject", tr("Reject"), "mdi6.close-thick", presenter.reject),
            ],
            parent,
        )

    def refresh(self) -> None:
        """Show how far the calibration is, and the buttons of what can be done next."""
        p = self._presenter
        stage: Stage = p.stage
        same = {
            Stage.NOT_NEEDED: capital(tr(STEP_STATES["not needed"])),
            Stage.NONE: tr("No pictures yet"),
            Stage.EMPTY: tr("No pictures there"),
            Stage.SOLVING: tr("Solving …"),
            Stage.FAILED: tr("No calibration"),
            Stage.SOLVED: tr("Calibrated, not accepted yet"),
            Stage.REJECTED: tr("Rejected"),
            Stage.ACCEPTED: tr("Accepted"),
            Stage.OUTDATED: capital(tr(STEP_STATES["outdated"])),
        }
        sentences = {
            Stage.NOT_NEEDED: p.state.sentence,
            Stage.EMPTY: tr("The folder holds no pictures; choose another one."),
            Stage.FAILED: p.work.problem,
            Stage.ACCEPTED: p.state.sentence,
            **self._sentences(),
        }
        why = {"run": p.cannot_search, "accept": p.cannot_accept, "reject": p.cannot_reject}
        self.show_stage(
            {**same, **self._titles()}[stage],
            sentences[stage],
            {key: (why[key], tip) for key, tip in self._tips().items()},
            self._next(stage),
            steady=stage in STEADY,
        )

    @abstractmethod
    def _titles(self) -> dict[Stage, str]:
        """What the stages are called that are the page's own."""

    @abstractmethod
    def _sentences(self) -> dict[Stage, str]:
        """What to do at each stage."""

    @abstractmethod
    def _tips(self) -> dict[str, str]:
        """What the buttons do: run, accept, reject."""

    @abstractmethod
    def _next(self, stage: Stage) -> str:
        """The button that is the next thing to do, or ""."""
