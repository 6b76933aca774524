"""The inspect page."""

from __future__ import annotations

from workbench.pages.step_page import StepPage


class InspectPage(StepPage):
    """The inspect page."""
