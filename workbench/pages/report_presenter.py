"""Decisions of the report page."""

from __future__ import annotations

from workbench.pages.presenter import StepPresenter


class ReportPresenter(StepPresenter):
    """Decisions of the report page."""

    step = "report"
