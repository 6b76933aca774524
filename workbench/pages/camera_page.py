"""The camera page."""

from __future__ import annotations

from workbench.pages.step_page import StepPage


class CameraPage(StepPage):
    """The camera page."""
