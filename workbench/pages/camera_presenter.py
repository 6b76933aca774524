"""Decisions of the camera page."""

from __future__ import annotations

from workbench.pages.presenter import StepPresenter


class CameraPresenter(StepPresenter):
    """Decisions of the camera page."""

    step = "camera"
