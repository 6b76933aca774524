"""Decisions of the planes page."""

from __future__ import annotations

from workbench.pages.presenter import StepPresenter


class PlanesPresenter(StepPresenter):
    """Decisions of the planes page."""

    step = "planes"
