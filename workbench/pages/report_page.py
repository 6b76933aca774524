"""The report page."""

from __future__ import annotations

from workbench.pages.step_page import StepPage


class ReportPage(StepPage):
    """The report page."""
