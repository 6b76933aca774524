"""What the thickness should be, and which faces are measured: both undoable, both kept in the project's rig."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from PySide6.QtCore import QObject, Signal

from core.files.recording.rig import GaugeSpec
from core.inspect.results import PairCandidate
from core.inspect.shown.shown_scan import NextPair
from core.model.arrays import Array
from workbench.language import number, tr
from workbench.pages.inspect.scan import InspectScan
from workbench.pages.inspect.stage import FacesButtons, FacesFacts, faces_buttons
from workbench.project_model import ProjectModel

FACES = ("upper", "lower")
NUMBERS = ("nominal_mm", "tolerance_mm")


class InspectFaces(QObject):
    """Faces of the thickness: nominal value and tolerance are set together, and so are the two regions.

    What has been entered of a pair whose other half is missing is kept here, and put into the project with it.
    """

    changed = Signal()

    def __init__(self, model: ProjectModel, scan: InspectScan) -> None:
        super().__init__()
        self._model, self._scan = model, scan
        self._numbers: dict[str, float | None] = {}
        self._regions: dict[str, Array] = {}

    @property
    def spec(self) -> GaugeSpec:
        """Nominal value, tolerance and regions of the thickness in the project."""
        return self._model.project.rig.gauge or GaugeSpec()

    # ---- nominal value and tolerance

    def values(self) -> dict[str, float | None]:
        """Return the fields of the form: nominal value and tolerance in mm, None if empty."""
        return {key: getattr(self.spec, key) for key in NUMBERS} | self._numbers

    def complaint(self, key: str) -> str:
        """Return a sentence on what is missing beside the number in field `key`; "" if nothing is."""
        values = self.values()
        other = values["tolerance_mm" if key == "nominal_mm" else "nominal_mm"]
        if values[key] is not None or other is None:
            return ""
        if key == "tolerance_mm":
            return tr("Enter the tolerance too, or clear the nominal value: they go together.")
        return tr("Enter the nominal value too, or clear the tolerance: they go together.")

    def set_number(self, key: str, value: Any) -> None:
        """Change the nominal value or the tolerance in mm; undoable once both are set, or neither."""
        values = self.values() | {key: None if value is None else float(value)}
        if (values["nominal_mm"] is None) != (values["tolerance_mm"] is None):
            self._numbers = values
            self.changed.emit()
            return
        self._numbers = {}
        if values["nominal_mm"] is None:
            label = tr("measure without a nominal value")
        else:
            label = tr("change the nominal thickness") if key == "nominal_mm" else tr("change the tolerance")
        spec = replace(self.spec, nominal_mm=values["nominal_mm"], tolerance_mm=values["tolerance_mm"])
        self._put(spec, label, f"gauge {key}")
        self.changed.emit()

    # ---- faces

    @property
    def own(self) -> bool:
        """Whether the faces are measured in regions that the user has drawn."""
        return self.spec.upper_polygon_px is not None

    def region(self, face: str) -> Array | None:
        """Return the polygon (n, 2) in px that the face "upper" or "lower" is measured in; None: automatic."""
        drawn: Array | None = getattr(self.spec, f"{face}_polygon_px")
        return self._regions.get(face, drawn)

    def set_region(self, face: str, corners: ArrayLike) -> None:
        """Measure the face "upper" or "lower" within a polygon (n, 2) in px; undoable.

        The other face keeps its region. Without one it gets the outline of the points that were used on it; where
        nothing was measured yet, the region waits for the other one.
        """
        polygon: Array = np.round(np.asarray(corners, dtype=np.float64), 1).astype(np.float64)
        if polygon.ndim != 2 or len(polygon) < 3:
            return
        other = FACES[1 - FACES.index(face)]
        beside = self.region(other)
        beside = self._found(other) if beside is None else beside
        if beside is None:
            self._regions = {face: polygon}
            self.changed.emit()
            return
        had = self.own
        self._regions = {}
        words = {
            "upper": tr("change the upper face") if had else tr("draw the upper face"),
            "lower": tr("change the lower face") if had else tr("draw the lower face"),
        }
        self._put_regions({face: polygon, other: beside}, words[face])

    def exchange(self) -> None:
        """Exchange the polygons of the upper and the lower face; undoable."""
        upper, lower = self.spec.upper_polygon_px, self.spec.lower_polygon_px
        if upper is not None and lower is not None:
            self._put_regions({"upper": lower, "lower": upper}, tr("exchange the faces"))

    def take_found(self) -> None:
        """Turn the outlines of the faces that were found into polygons, which can be edited; undoable."""
        found = {face: self._found(face) for face in FACES}
        if all(outline is not None for outline in found.values()):
            self._put_regions(found, tr("take the faces found as regions"))

    @property
    def candidates(self) -> tuple[PairCandidate, ...]:
        """Pairs of faces that may be meant, the measured one first; () if there is only one."""
        gauge = self._scan.gauge
        if gauge is None or self.own:
            return ()
        return tuple(one for one in gauge.candidates if all(one.outlines_px))

    @property
    def next_pair(self) -> NextPair | None:
        """Second most likely pair of faces, to be drawn; None if there is only one pair."""
        view = self._scan.view
        return None if view is None or self.own else view.next_pair

    def confirm(self, candidate: PairCandidate) -> None:
        """Measure this pair of faces: the outlines of its faces become the polygons; undoable."""
        self._regions = {}
        outlines: dict[str, Array | None] = {
            face: np.array(corners) for face, corners in zip(FACES, candidate.outlines_px, strict=True)
        }
        self._put_regions(outlines, tr("confirm the faces {mm} mm apart", mm=number(candidate.thickness_mm, ".1f")))

    def find_automatically(self) -> None:
        """Drop the polygons, so that the faces are found automatically; undoable."""
        self._regions = {}
        self._put_regions(dict.fromkeys(FACES), tr("find the faces automatically"))
        self.changed.emit()

    @property
    def buttons(self) -> FacesButtons:
        """Reason why each button of the regions is disabled; "" if it is enabled."""
        found = self._found("upper") is not None
        return faces_buttons(FacesFacts(self._scan.buttons.use, found, self.own, self.missing()))

    def missing(self) -> str:
        """Return a sentence on what keeps the thickness from being measured; "" if nothing does."""
        if "upper" in self._regions:
            return tr("Draw the lower face too, or let the faces be found automatically.")
        if "lower" in self._regions:
            return tr("Draw the upper face too, or let the faces be found automatically.")
        return ""

    # ---- what happens elsewhere

    def follow(self, before: GaugeSpec | None, after: GaugeSpec | None) -> None:
        """Drop numbers and regions that were only half entered, if the project has others now."""
        was, now = before or GaugeSpec(), after or GaugeSpec()
        if any(getattr(was, key) != getattr(now, key) for key in NUMBERS):
            self._numbers = {}
        if replace(was, nominal_mm=None, tolerance_mm=None) != replace(now, nominal_mm=None, tolerance_mm=None):
            self._regions = {}

    def forget_regions(self) -> None:
        """Drop regions that were only half drawn, as another scan is shown."""
        self._regions = {}

    def forget(self) -> None:
        """Drop everything half entered, as another project is open."""
        self._numbers, self._regions = {}, {}

    def _found(self, face: str) -> Array | None:
        view = self._scan.view
        return None if view is None or view.outlines is None else view.outlines[FACES.index(face)]

    def _put_regions(self, regions: dict[str, Array | None], label: str) -> None:
        spec = replace(self.spec, upper_polygon_px=regions["upper"], lower_polygon_px=regions["lower"])
        self._put(spec, label, "")

    def _put(self, spec: GaugeSpec, label: str, merge_key: str) -> None:
        project = self._model.project
        gauge = None if spec == GaugeSpec() else spec
        self._model.edit(label, replace(project, rig=replace(project.rig, gauge=gauge)), merge_key)
