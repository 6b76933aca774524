"""How far the camera is and what to do next, with the buttons for it."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from workbench.pages.calibration.stage import Stage
from workbench.pages.camera.presenter import CameraPresenter
from workbench.views.forms.form import SettingsForm
from workbench.views.stage_card import CalibrationCard

TARGETS = ("checkerboard", "charuco", "circle_grid")
"""Kinds of targets a camera can be calibrated with."""


class CameraCard(CalibrationCard):
    """The stage; the next thing to do is the primary button."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        self._presenter = p = presenter
        super().__init__(p.do_run, p.accept, p.reject, parent)

    def refresh(self) -> None:
        """Show the stage."""
        p, stage = self._presenter, self._presenter.stage
        next_one = {Stage.SOLVED: "accept", Stage.FOUND: "run", Stage.OUTDATED: "run"}
        if p.work.seen is None:  # else searching again would help nothing
            next_one[Stage.FAILED] = "run"
        self.show_stage(
            *self._words()[stage],
            {
                "run": (p.can_search, self.tr("Find the target in all pictures and solve the camera (Ctrl+R)")),
                "accept": (p.can_accept, self.tr("Measure with this calibration from now on (Ctrl+Return)")),
                "reject": (p.can_reject, self.tr("Do not measure with this calibration")),
            },
            next_one.get(stage, ""),
        )

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
                self.tr("Taking views"),
                self.tr("Show the target from many sides. Stop when nothing is missing; then it is calibrated."),
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
            Stage.OTHER: (
                self.tr("Another calibration is in use"),
                self.tr(
                    "The accepted one is listed under History. What is shown here is not in use; accept it to use it."
                ),
            ),
            Stage.OUTDATED: (self.tr("Accepted, but out of date"), p.state.sentence),
        }


class CameraModelForm(SettingsForm):
    """What is solved for."""

    def __init__(self, presenter: CameraPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        skews = [
            (None, self.tr("free where it helps")),
            (True, self.tr("free")),
            (False, self.tr("zero")),
        ]
        self.add_choice("skew", self.tr("Skew γ"), skews, self.tr("Whether the pixel's axes may be out of square."))
        self.add_check(
            "k3", self.tr("k₃ is free"), self.tr("For strongly distorting lenses; else it makes the rest less sure.")
        )
        choices = [
            ("gross", self.tr("leave out gross ones")),
            ("all", self.tr("leave out all that stand out")),
            ("keep", self.tr("keep all")),
        ]
        self.add_choice(
            "outliers", self.tr("Misfits"), choices, self.tr("Views and corners that do not fit the others.")
        )
        self.edited.connect(presenter.set_model)

    def refresh(self) -> None:
        """Show the settings."""
        self.set_values(self._presenter.model_values())
