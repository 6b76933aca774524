"""The chosen feature, edited: its fields, what is wrong with them, its regions. Every edit is undoable."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.files.project.folder import stored_source
from core.inspect.plan.feature_spec import FeatureSpec, Place, Polygon, Section
from core.inspect.plan.kinds import kind_of
from core.inspect.profile import usual_stretches
from core.inspect.shown.cut_plane import CutPlane
from core.inspect.shown.view_frame import FrameKind, ViewFrame
from core.model.arrays import Array
from workbench.language import text_of, tr
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.pages.inspect.scan import InspectScan

LINE = "section line"
REGION = "feature region"

NO_PICTURE = (1280, 960)
"""The picture's size in pixels where none is known yet."""


class InspectFeatureEdit:
    """Fields of the form of the chosen feature.

    Limits whose other half is missing, and values that cannot be, are kept here until they can be put into the plan.
    """

    def __init__(self, features: InspectFeatures, scan: InspectScan) -> None:
        self._features, self._model, self._scan = features, features.model, scan
        self._of = ""
        self._pending: dict[str, Any] = {}
        self._complaints: dict[str, str] = {}

    @property
    def spec(self) -> FeatureSpec | None:
        """Chosen feature of the plan; None if none is chosen."""
        plan, chosen = self._features.plan, self._features.chosen
        return plan.feature(chosen) if chosen in plan.names else None

    def values(self) -> dict[str, Any]:
        """Return the fields of the chosen feature's form, with impossible values as typed."""
        self._follow()
        return {} if self.spec is None else fields.values_of(self.spec) | self._pending

    def complaint(self, key: str) -> str:
        """Return a sentence on what is wrong with the field `key`; "" if nothing is."""
        self._follow()
        return self._complaints.get(key, "")

    def add(self, kind: str, nominal: Path | None = None) -> None:
        """Add a feature of a kind to the plan and choose it; undoable. A "deviation" needs a `nominal` file."""
        features, view = self._features, self._scan.view
        why_not, folder = fields.why_not(kind, features.plan), self._model.folder
        if why_not or folder is None:
            features.bench.notices.warning(why_not or tr("Open a project first."))
            return
        stored = "" if nominal is None else stored_source(folder, nominal)
        size = NO_PICTURE if view is None else view.image_size
        features.put(fields.new_feature(kind, features.free_name(kind), features.plan, size, stored, self._across()))
        features.measure_first()

    def set_value(self, key: str, value: Any) -> None:
        """Change one field of the chosen feature; an impossible value stays in the form only, with a sentence."""
        self._follow()
        spec = self.spec
        if spec is None:
            return
        self._pending[key] = value
        try:
            if key.startswith("limits "):
                result = key.split(" ", 2)[2]
                changed = fields.with_limits(spec, result, self.values())
                done = [one for one in self._pending if one.startswith("limits ") and one.split(" ", 2)[2] == result]
            elif key.split(" ")[0] in fields.CORNERS:
                place = int(key.split(" ")[1])
                changed = fields.with_box(spec, place, self.values())
                done = [f"{corner} {place}" for corner in fields.CORNERS]
            elif key.startswith("source ") and value in (fields.SPHERE, fields.BOX):
                changed, done = self._placed(spec, int(key.split(" ")[1]), value), [key]
            else:
                changed, done = fields.with_value(spec, key, value), [key]
        except ValueError as error:
            self._complain(key, text_of(error))
            return
        wrong = self._features.complaint(changed, spec.name)
        if wrong:
            self._complain(key, wrong)
            return
        for one in done:
            self._pending.pop(one, None)
            self._complaints.pop(one, None)
        self._of = changed.name
        self._put(spec, changed)

    def set_region(self, place: int, corners: ArrayLike) -> None:
        """Make the polygon `corners` (n, 2) in px the region number `place` of the chosen feature; undoable."""
        spec = self.spec
        if spec is None or place >= len(spec.regions):
            return
        region = Polygon(tuple((float(u), float(v)) for u, v in np.asarray(corners)))
        self._put(spec, fields.with_region(spec, place, region))

    def set_line(self, ends: ArrayLike) -> None:
        """Put the chosen section's plane through two pixels, `ends` (2, 2); undoable."""
        spec = self.spec
        if spec is not None and spec.section is not None:
            first, second = np.asarray(ends)
            line = (float(first[0]), float(first[1])), (float(second[0]), float(second[1]))
            self._put(spec, replace(spec, section=replace(spec.section, line_px=line)))

    @property
    def selected_face(self) -> str:
        """Key of what points drawn round in 3D mean: "upper", the plane face among them, or "", all of them."""
        return "upper" if self.spec is not None and kind_of(self.spec).automatic == "numbered" else ""

    def region_name(self, place: int) -> str:
        """Return the name by which region number `place` of the chosen feature is drawn in pictures."""
        return f"{REGION} {place}"

    def place_of(self, name: str) -> int:
        """Return the number of the chosen feature's region that is drawn under `name`."""
        return int(name.removeprefix(REGION))

    def set_nominal(self, path: Path) -> None:
        """Compare the chosen feature with another nominal surface, in the file `path`; undoable."""
        folder = self._model.folder
        if folder is not None:
            self.set_value("nominal", stored_source(folder, path))

    def add_cut(self) -> None:
        """Add a measurement to the chosen section, between two levels of its profile; undoable."""
        spec = self.spec
        if spec is None:
            return
        shown = self._features.result(spec.name)
        profile = None if shown is None else shown.profile
        if profile is None or len(profile.mean_position) < 2:
            self._put(spec, fields.with_new_cut(spec))  # nothing measured yet
        else:
            at = usual_stretches(profile.mean_position, profile.mean_height)
            self._put(spec, fields.with_new_cut(spec, at))

    def remove_cut(self, place: int) -> None:
        """Remove the measurement number `place` from the chosen section; undoable."""
        if self.spec is not None:
            self._put(self.spec, fields.without_cut(self.spec, place))

    # ---- inside

    def _across(self) -> Section | None:
        """A section through the middle of the part, square to its y; None where its coordinates are not known."""
        pose, view = self._features.pose_camera_part, self._scan.view
        if pose is None or view is None or not len(view):
            return None
        frame = ViewFrame(FrameKind.PART, pose)
        return CutPlane(frame, 1, float(np.median(frame.coordinates(view.points)[:, 1]))).section(pose)

    def _placed(self, spec: FeatureSpec, place: int, source: str) -> FeatureSpec:
        """The feature with a sphere or a box of part coordinates round the points it used; the usual if none are known.

        Where the plan has no frame, these are the camera's.
        """
        shown, pose = self._features.result(spec.name), self._features.pose_camera_part
        framed = self._features.plan.frame is not None
        if shown is None or not len(shown.places) or (framed and pose is None):
            return fields.with_value(spec, f"source {place}", source)
        points = shown.places if pose is None else pose.inverse().apply(shown.places)
        high = np.ceil(1e3 * points.max(axis=0)) / 1e3
        low = np.minimum(np.floor(1e3 * points.min(axis=0)) / 1e3, high - 1e-3)
        return fields.with_region(spec, place, fields.around(source, _three(low), _three(high)))

    def _put(self, before: FeatureSpec, after: FeatureSpec) -> None:
        if after != before:
            self._features.put(after, before.name)
        else:
            self._features.changed.emit()

    def _complain(self, key: str, sentence: str) -> None:
        self._complaints[key] = sentence
        self._features.changed.emit()

    def _follow(self) -> None:
        """Another feature is chosen: what was half entered of the last one is forgotten."""
        if self._of != self._features.chosen:
            self._of = self._features.chosen
            self._pending, self._complaints = {}, {}


def _three(values: Array) -> Place:
    x, y, z = (round(float(value), 3) + 0.0 for value in values)
    return x, y, z
