"""What stands at the side of the camera page: how far it is, the camera model, the result."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from workbench.language import text_of, tr
from workbench.pages.calibration.card import CalibrationCard
from workbench.pages.calibration.page import Result
from workbench.pages.calibration.stage import Stage
from workbench.pages.camera import words
from workbench.pages.camera.presenter import CameraPresenter
from workbench.pages.setting_fields import add_settings
from workbench.pages.words import show_facts
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import muted, set_text
from workbench.views.lists.value_rows import ValueRows

TARGETS = ("checkerboard", "charuco", "circle_grid")
"""Kinds of targets a camera can be calibrated with."""


class CameraCard(CalibrationCard):
    """Card with the stage; the next action is the primary button."""

    def _titles(self) -> dict[Stage, str]:
        return {
            Stage.FOUND: tr("{count} pictures, not searched yet", count=len(self._presenter.work.pictures or ())),
            Stage.LIVE: tr("Taking views"),
            Stage.SEARCHING: tr("Searching the pictures …"),
            Stage.OTHER: tr("Another calibration is in use"),
        }

    def _sentences(self) -> dict[Stage, str]:
        return {
            Stage.NONE: tr("Choose a folder of pictures of the target, or take them with a live source."),
            Stage.FOUND: tr("Check the target below, then press Calibrate."),
            Stage.LIVE: tr("Show the target from many sides. It stops by itself when nothing is missing."),
            Stage.SEARCHING: tr("The target is looked for in each picture."),
            Stage.SOLVING: tr("The camera is being solved anew."),
            Stage.SOLVED: tr("Look at the views and the residuals; leave out what is bad, then accept."),
            Stage.REJECTED: tr("Leave out bad views, or take other pictures; or accept it after all."),
            Stage.OTHER: tr("Another one, listed under History, is in use. Accept this one to use it."),
            Stage.OUTDATED: self._presenter.state.sentence,
        }

    def _tips(self) -> dict[str, str]:
        return {
            "run": tr("Find the target in all pictures and solve the camera (Ctrl+R)"),
            "accept": tr("Measure with this calibration from now on (Ctrl+Return)"),
            "reject": tr("Do not measure with this calibration"),
        }

    def _next(self, stage: Stage) -> str:
        if self._presenter.counted is not None:  # what is offered over the picture
            return ""
        if stage is Stage.FAILED:  # searching again would help nothing where it is known what the pictures show
            return "run" if self._presenter.work.seen is None else ""
        return {Stage.SOLVED: "accept", Stage.FOUND: "run", Stage.OUTDATED: "run"}.get(stage, "")


class CameraResult(Result):
    """Panel with the quality of the calibration, and its notes."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.rows, self.notes = ValueRows(), muted()
        self._add(self.rows, self.notes)

    def refresh(self) -> bool:
        work = self._presenter.work
        calibration = work.calibration
        show_facts(self.rows, words.facts(calibration, work.judgement))
        set_text(self.notes, "\n".join(map(text_of, calibration.notes)) if calibration is not None else "")
        return calibration is not None


class CameraModelForm(SettingsForm):
    """Form of the parameters to be solved for."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        add_settings(self, "camera")
        self.edited.connect(presenter.set_model)

    def refresh(self) -> None:
        """Show which camera parameters are free, and how outliers are treated."""
        self.set_values(self._presenter.model_values())
