"""What stands at the side of the laser planes page: how far it is, the laser, the live source, the result."""

from __future__ import annotations

import math
from typing import Any

from PySide6.QtWidgets import QCheckBox, QVBoxLayout, QWidget

from core.report.facts.of_planes import planes_facts
from core.report.facts.pictures import left_out
from workbench.language import sentences, text_of, tr
from workbench.pages.calibration.card import CalibrationCard
from workbench.pages.calibration.page import Result
from workbench.pages.calibration.stage import Stage
from workbench.pages.channels import add_channel
from workbench.pages.planes import words
from workbench.pages.planes.presenter import PlanesPresenter
from workbench.pages.setting_fields import add_rig_settings, add_settings, set_stripe_editable
from workbench.pages.words import show_facts
from workbench.views.forms.form import SettingsForm
from workbench.views.forms.live_panel import LivePanel
from workbench.views.layouts import enable, heading, in_column, muted, set_text
from workbench.views.lists.value_rows import ValueRows

PLATES = ("black_square", "checkerboard", "charuco", "circle_grid")
"""Kinds of targets the laser planes can be calibrated with."""


class PlanesCard(CalibrationCard):
    """Card with the stage; the next action is the primary button."""

    def _titles(self) -> dict[Stage, str]:
        return {
            Stage.NO_CAMERA: tr("The camera comes first"),
            Stage.FOUND: tr("{count} poses, not measured yet", count=len(self._presenter.work.pictures or ())),
            Stage.LIVE: tr("Taking poses"),
            Stage.SEARCHING: tr("Measuring the pictures …"),
            Stage.OTHER: tr("Others are in use"),
        }

    def _sentences(self) -> dict[Stage, str]:
        p = self._presenter
        return {
            Stage.NO_CAMERA: tr("The planes are seen through the camera: accept its calibration, then come back."),
            Stage.NONE: tr("Choose a folder of pictures of the plate under the fan, or take them with a live source."),
            Stage.FOUND: tr("Check plate and laser below, then press Calibrate."),
            Stage.LIVE: tr(
                "Hold the plate into the fan at different distances and tilts. Stop when nothing is missing; "
                "then the planes are calibrated."
            ),
            Stage.SEARCHING: tr("Target and stripes are found in each pose."),
            Stage.SOLVING: tr("Planes and poses are adjusted together."),
            Stage.SOLVED: tr("Look at the poses and the angles; leave out what is bad, then accept."),
            Stage.REJECTED: tr("Leave out bad poses, or take other pictures; or accept it after all."),
            Stage.OTHER: tr("Laser planes kept earlier are in use. Accept these to measure with them."),
            Stage.OUTDATED: sentences(p.state.sentence, p.work.problem),
        }

    def _tips(self) -> dict[str, str]:
        return {
            "run": tr("Measure all pictures and solve the planes (Ctrl+R)"),
            "accept": tr("Measure with these laser planes from now on (Ctrl+Return)"),
            "reject": tr("Do not measure with these laser planes"),
        }

    def _next(self, stage: Stage) -> str:
        if stage is Stage.OUTDATED:
            return "accept" if self._presenter.candidate and not self._presenter.cannot_accept else "run"
        return {Stage.SOLVED: "accept", Stage.FOUND: "run", Stage.FAILED: "run"}.get(stage, "")


class PlanesLive(QWidget):
    """Panel of the live source, and whether the laser can be switched off for a second picture of each pose."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self.panel = LivePanel(presenter.live)
        self.pairs = QCheckBox(tr("Take each pose with the laser off, too"))
        self.pairs.clicked.connect(presenter.set_pairs)
        inside = self.panel.layout()
        assert isinstance(inside, QVBoxLayout)
        inside.insertWidget(inside.indexOf(self.panel.state), self.pairs)
        in_column(self.panel, on=self)

    def refresh(self) -> None:
        """Show the live source, and whether each pose is also taken with the laser off."""
        self.pairs.setChecked(self._presenter.live.pairs)
        enable(
            self.pairs,
            tr("Stop the live source first.") if self._presenter.live.running else "",
            tr(
                "Target and stripes are then found each in a picture of its own. The source switches the laser off for "
                "a moment, or you are asked to; leave it out where the laser cannot be switched"
            ),
        )


class LaserForm(SettingsForm):
    """Form of the fixed laser."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        add_rig_settings(self, "laser_fan")
        add_settings(self, "planes")
        add_channel(self)
        self.edited.connect(self._tell)

    def refresh(self) -> None:
        """Show the fixed laser's lines, angle, channel and options."""
        rig, options = self._presenter.project.rig, self._presenter.project.options
        angle = math.degrees(rig.angle) if rig.angle else None
        self.set_values(
            {
                "lines": rig.lines,
                "angle_deg": angle,
                "channel": rig.channel_of("planes") or "",
                **self._presenter.option_values(),
            }
        )
        set_stripe_editable(self, options.plane_stripe is None)
        one = tr("One line has no neighbour.") if rig.lines == 1 else ""
        for key in ("angle_deg", "constrain_fan"):
            self.set_editable(key, not one, one)

    def _tell(self, key: str, value: Any) -> None:
        if key == "angle_deg":
            key, value = "angle", None if value is None else math.radians(value)
        self._presenter.set_laser(key, value)


class PlanesResult(Result):
    """Panel with the quality of the calibration shown, and whether the laser agrees with its description."""

    def __init__(self, presenter: PlanesPresenter, parent: QWidget | None = None) -> None:
        super().__init__(presenter, parent)
        self.rows, self.left_out, self.verdict, self.notes = ValueRows(), muted(), muted(), muted()
        self._left_out_heading = heading(tr("Left out"))
        self._add(self.rows, self._left_out_heading, self.left_out, self.verdict, self.notes)

    def refresh(self) -> bool:
        work = self._presenter.work
        calibration = work.calibration
        show_facts(self.rows, planes_facts(calibration) if calibration is not None else ())
        set_text(self.verdict, words.verdict_sentence(calibration))
        set_text(self.notes, words.notes(calibration))
        why = left_out(calibration.poses if calibration is not None else work.poses or ())
        set_text(self.left_out, "\n".join(text_of(one.line()) for one in why))
        self._left_out_heading.setVisible(bool(why))
        return calibration is not None or bool(why)
