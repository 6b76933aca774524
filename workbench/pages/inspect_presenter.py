"""Decisions of the inspect page."""

from __future__ import annotations

from workbench.pages.presenter import StepPresenter


class InspectPresenter(StepPresenter):
    """Decisions of the inspect page."""

    step = "inspect"
