"""The scan page."""

from __future__ import annotations

from workbench.pages.step_page import StepPage


class ScanPage(StepPage):
    """The scan page."""
