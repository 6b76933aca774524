"""The choice between the part's frame and the camera's: a button over a page's 3D view, remembered for all of them."""

from __future__ import annotations

from PySide6.QtCore import QObject

from core.inspect.shown.view_frame import ViewFrame, shown_frame
from workbench.language import tr
from workbench.settings import AppSettings
from workbench.views.layouts import enable
from workbench.views.scene.view import SceneView


class FrameTool(QObject):
    """Tool that shows a 3D view in the chosen frame, if the part's own is known."""

    def __init__(self, scene: SceneView, settings: AppSettings) -> None:
        super().__init__(scene)
        self._scene, self._settings = scene, settings
        self._part: ViewFrame | None = None
        self.action = scene.add_tool(tr("The part's frame with z up; released, the camera's"), "Z", "mdi6.axis-arrow")
        self._tip = self.action.toolTip()
        self.action.triggered.connect(self._choose)
        settings.part_frame_changed.connect(self._refresh)
        self._refresh()

    def show(self, part: ViewFrame | None) -> None:
        """Set the part's own frame, which the button offers; None if it is not known."""
        self._part = part
        self._refresh()

    def _choose(self, wanted: bool) -> None:
        self._settings.part_frame = wanted

    def _refresh(self) -> None:
        known, wanted = self._part is not None, self._settings.part_frame
        unknown = tr("The part's frame is not known: measure the thickness, or part coordinates, on the Inspect page.")
        enable(self.action, "" if known else unknown, self._tip)
        self.action.setChecked(known and wanted)
        self._scene.set_frame(shown_frame(self._part, wanted=wanted))
