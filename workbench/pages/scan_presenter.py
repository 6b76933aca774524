"""Decisions of the scan page."""

from __future__ import annotations

from workbench.pages.presenter import StepPresenter


class ScanPresenter(StepPresenter):
    """Decisions of the scan page."""

    step = "scan"
