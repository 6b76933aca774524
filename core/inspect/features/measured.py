"""What measuring a feature gives, and what it may look at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.findings.proof import Doubts, notes_of
from core.inspect.characteristic import Characteristic
from core.inspect.fit.elements import Element
from core.inspect.fit.plane_search import FoundPlane, find_planes
from core.inspect.fit.shapes import Shape
from core.inspect.plan.conditions import Temperature
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import PartFrame
from core.inspect.plan.kinds import kind_of
from core.inspect.profile import Profile
from core.inspect.results import Contribution
from core.inspect.shown.deviation_map import DeviationMap
from core.inspect.uncertainty.budget import combined
from core.inspect.uncertainty.coverage import student_factor
from core.inspect.uncertainty.point_errors import PointErrors
from core.inspect.uncertainty.skewed_light import doubts_of_light
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.normals import with_normals
from core.scan.surface.triangles import Triangles


@dataclass(frozen=True, eq=False, slots=True)
class FeatureResult:
    """Result of a feature: its characteristics, the points used, and the surface fitted to them.

    Parameters
    ----------
    spec
        What was asked for.
    key
        Hash of all it rests on: the same key, the same result.
    characteristics
        Its rows for tables, exports and verdicts.
    indices
        (M,) into the cloud, ascending: the points used.
    residuals
        (M,) in mm of these from the fitted surface, outwards positive; empty where nothing was fitted.
    part
        (M,) which face of several (levels, lowest first; of a thickness the upper one first) each point is on.
    element
        Of what others can be derived from; else None.
    shape
        The fitted surface in the camera frame, if there is one.
    profile, deviations
        Of a section, a deviation map.
    notes
        What is told of it where it has no row of its own: with what is derived from it.
    chosen_by_nominal
        Whether its nominal value has chosen between several faces, so that other limits may choose others.
    problem
        Why it could not be measured; then there are no characteristics. None if it was.
    """

    spec: FeatureSpec
    key: str = ""
    characteristics: tuple[Characteristic, ...] = ()
    indices: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    residuals: Array = field(default_factory=lambda: np.zeros(0))
    part: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    element: Element | None = None
    shape: Shape | None = None
    profile: Profile | None = None
    deviations: DeviationMap | None = None
    notes: tuple[Message, ...] = ()
    chosen_by_nominal: bool = False
    problem: Message | None = None


@dataclass(eq=False, slots=True)
class Scene:
    """Scene that features are measured in: one scan, what was found in it so far, and the part's frame.

    Parameters
    ----------
    cloud
        The points.
    mesh
        The surface over them, for comparisons; None: the points themselves.
    errors
        How the points' errors hang together.
    k
        Coverage factor.
    nominals
        Nominal surfaces by their names.
    pose_camera_part
        Part coordinates into the camera frame.
    frame
        The features these rest on; None: they are the camera's.
    temperature
        Of the part, stated or assumed; None: it is at 20 °C for sure.
    found
        Features measured already, by name.
    progress
        Told how far a search is.
    found_planes
        Plane faces found already, by their margin.
    """

    cloud: Cloud
    mesh: Mesh | None
    errors: PointErrors
    k: float
    nominals: Mapping[str, Triangles]
    pose_camera_part: Pose | None = None
    frame: PartFrame | None = None
    temperature: Temperature | None = None
    found: dict[str, FeatureResult] = field(default_factory=dict)
    progress: Progress = silent
    found_planes: dict[float, tuple[FoundPlane, ...]] = field(default_factory=dict)

    def planes(self, margin_mm: float) -> tuple[FoundPlane, ...]:
        """Find the plane faces of the cloud, less `margin_mm` at their edges; computed once for each margin."""
        if margin_mm not in self.found_planes:
            self.ensure_normals()
            found = find_planes(self.cloud, margin_mm=margin_mm, progress=self.progress)
            self.found_planes[margin_mm] = tuple(found)
        return self.found_planes[margin_mm]

    def ensure_normals(self) -> None:
        """Estimate the normals of the cloud if all are zero, as in a file without normals."""
        if len(self.cloud) >= 3 and not self.cloud.normals.any():
            self.cloud = with_normals(self.cloud, progress=self.progress)

    def characteristic(
        self,
        spec: FeatureSpec,
        kind: str,
        value: float,
        budget: tuple[Contribution, ...],
        *,
        result: str = "",
        rule: Message | None,
        notes: tuple[Message, ...] = (),
        doubts: Doubts = (),
    ) -> Characteristic:
        """Make a characteristic of a feature, named after `result`, as "ball diameter", or, if "", its `kind`.

        It proves nothing by the doubts of the scan, nor by the `doubts` of its points; one of their light is seen in
        its budget. Its notes tell of all but those of the scan.
        """
        result, own = result or kind, (*doubts, *doubts_of_light(budget))
        return Characteristic(
            name=f"{spec.name} {result}",
            kind=kind,
            value=value,
            u=combined(budget),
            quantity=kind_of(spec).result(kind).quantity,
            k=student_factor(self.k, budget),
            limits=spec.limits_of(result),
            budget=budget,
            rule=rule,
            notes=(*notes_of(own), *notes),
            doubts=(*self.errors.doubts, *own),
        )


Measure = Callable[[FeatureSpec, Scene], FeatureResult]
