"""The planes page."""

from __future__ import annotations

from workbench.pages.step_page import StepPage


class PlanesPage(StepPage):
    """The planes page."""
