"""A plan measured on one scan: each feature by itself, and only what an edit changed."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.inspect.alignment import three_two_one
from core.inspect.characteristic import Characteristic
from core.inspect.elements import Element
from core.inspect.feature_spec import FeatureSpec, Kind
from core.inspect.features.cylinder import measure_cylinder
from core.inspect.features.derived import measure_angle, measure_distance
from core.inspect.features.deviation import measure_deviation
from core.inspect.features.measured import FeatureResult, Measure, Scene
from core.inspect.features.plane import measure_plane, measure_point
from core.inspect.features.section import measure_section
from core.inspect.features.sphere import measure_sphere
from core.inspect.features.steps import measure_steps
from core.inspect.features.thickness import measure_thickness, with_limits
from core.inspect.inspection_plan import InspectionPlan, PartFrame
from core.inspect.plane_search import FoundPlane
from core.inspect.point_errors import PointErrors
from core.inspect.temperature import at_reference, compared
from core.inspect.uncertainty import CAMERA, FAN_CALIBRATION
from core.model import Pose
from core.progress import Progress, silent
from core.scan.cloud import Cloud
from core.scan.surface import Mesh
from core.scan.triangles import Triangles

MEASURES: Mapping[Kind, Measure] = {
    "plane": measure_plane,
    "sphere": measure_sphere,
    "cylinder": measure_cylinder,
    "point": measure_point,
    "thickness": measure_thickness,
    "steps": measure_steps,
    "distance": measure_distance,
    "angle": measure_angle,
    "section": measure_section,
    "deviation": measure_deviation,
}


@dataclass(frozen=True, eq=False, slots=True)
class Inspection:
    """What a plan gave on one scan.

    Parameters
    ----------
    plan
        As it was asked.
    results
        One for each feature, in the plan's order.
    pose_camera_part
        Part coordinates into the camera frame; None: they are the camera's, or their features were not measured.
    notes
        Whole sentences.
    scan_key
        Names the scan.
    planes
        Plane faces found in it, by their margin: for the next inspection of the same scan.
    """

    plan: InspectionPlan
    results: tuple[FeatureResult, ...]
    pose_camera_part: Pose | None = None
    notes: tuple[str, ...] = ()
    scan_key: str = ""
    planes: Mapping[float, tuple[FoundPlane, ...]] = field(default_factory=dict)

    @property
    def characteristics(self) -> tuple[Characteristic, ...]:
        """Of all features, in their order."""
        return tuple(row for result in self.results for row in result.characteristics)

    @property
    def problems(self) -> tuple[str, ...]:
        """One sentence for each feature that could not be measured."""
        return tuple(result.problem for result in self.results if result.problem)

    def result(self, name: str) -> FeatureResult:
        """Of the feature called so; KeyError if there is none."""
        return {result.spec.name: result for result in self.results}[name]

    @property
    def verdict(self) -> str:
        """The worst of all: "not conforming", "not proven", "conforming", or "" where nothing is asked.

        A feature with limits that could not be measured proves nothing.
        """
        verdicts = {row.verdict for row in self.characteristics}
        if any(result.problem and result.spec.limits for result in self.results):
            verdicts.add("not proven")
        return next((one for one in ("not conforming", "not proven", "conforming") if one in verdicts), "")


def evaluate(
    plan: InspectionPlan,
    cloud: Cloud,
    mesh: Mesh | None = None,
    errors: PointErrors | None = None,
    progress: Progress = silent,
    previous: Inspection | None = None,
    *,
    nominals: Mapping[str, Triangles] | None = None,
) -> Inspection:
    """Measure all features of a plan.

    Parameters
    ----------
    plan
        What is to be measured.
    cloud, mesh
        The scan, and the surface over it for comparisons with nominal ones; without it the points are compared.
    errors
        How the points' errors hang together; what it does not know is not in the uncertainties, and a note says so.
    progress
        Told how far it is; may cancel.
    previous
        An inspection of before: features of the same inputs are taken from it as they are.
    nominals
        Nominal surfaces by the names the plan gives them.

    Raises
    ------
    InputError
        If the plan itself is wrong. A feature that cannot be measured has a `problem`; the others are measured.
    """
    ordered = plan.ordered()
    scene = Scene(cloud, mesh, errors or PointErrors(), plan.k, nominals or {}, progress=progress)
    known = {} if previous is None else {result.key: result for result in previous.results if result.key}
    scan_key = _digest(cloud, mesh, errors)
    nominal_keys = {name: _sum_of([surface.corners]) for name, surface in (nominals or {}).items()}
    if previous is not None and previous.scan_key == scan_key:
        scene.found_planes.update(previous.planes)
    frame_problem = ""
    for number, spec in enumerate(ordered):
        progress("features", number, len(ordered))
        framed = spec.in_part_coordinates and plan.frame is not None
        if framed and plan.frame is not None and scene.pose_camera_part is None and not frame_problem:
            scene.pose_camera_part, frame_problem = _frame(plan.frame, scene)
        nominal = "" if spec.deviation is None else nominal_keys.get(spec.deviation.nominal, "")
        key = _key(plan, spec, scene, scan_key + nominal, framed=framed)
        if key in known:
            result = _asked_anew(known[key], spec)
        else:
            result = _measured(plan, spec, scene, frame_problem if framed else "")
        scene.found[spec.name] = replace(result, key=key)
    if plan.frame is not None and scene.pose_camera_part is None and not frame_problem:
        scene.pose_camera_part, frame_problem = _frame(plan.frame, scene)
    progress("features", len(ordered), len(ordered))
    results = tuple(scene.found[spec.name] for spec in plan.features)
    notes = (*([frame_problem] if frame_problem else []), *_missing(scene.errors))
    return Inspection(plan, results, scene.pose_camera_part, notes, scan_key, scene.found_planes)


def _measured(plan: InspectionPlan, spec: FeatureSpec, scene: Scene, frame_problem: str) -> FeatureResult:
    """One feature, its lengths at 20 °C and compared with the master; a problem instead of a complaint."""
    broken = [name for name in spec.needs if scene.found[name].problem]
    if broken or frame_problem:
        why = f"{broken[0]} was not measured" if broken else "there are no part coordinates"
        return FeatureResult(spec, problem=f"feature {spec.name}: {why}.")
    try:
        result = MEASURES[spec.kind](spec, scene)
    except InputError as error:
        where = f"feature {spec.name}"
        return FeatureResult(spec, problem=str(InputError(error.what, where=where, todo=error.todo)))
    rows = result.characteristics
    if plan.temperature is not None:
        rows = tuple(at_reference(row, plan.temperature) for row in rows)
    if plan.master is not None and spec.name in plan.master.features:
        rows = tuple(compared(row, plan.master) for row in rows)
    return replace(result, characteristics=rows)


def _asked_anew(result: FeatureResult, spec: FeatureSpec) -> FeatureResult:
    """The same measurement with the limits of `spec`, which differs from its own in nothing else."""
    start = len(spec.name) + 1
    rows = tuple(replace(row, limits=spec.limits_of(row.name[start:])) for row in result.characteristics)
    same = all(a.limits == b.limits for a, b in zip(rows, result.characteristics, strict=True))
    gauge = None if result.gauge is None else with_limits(result.gauge, spec)
    return replace(result, spec=spec, characteristics=result.characteristics if same else rows, gauge=gauge)


def _frame(frame: PartFrame, scene: Scene) -> tuple[Pose | None, str]:
    """The part's frame, or why there is none."""
    elements: list[Element] = []
    for name in frame.names:
        result = scene.found.get(name)
        if result is None or result.element is None:
            return None, f"There are no part coordinates: {name} was not measured as a plane, axis or point."
        elements.append(result.element)
    try:
        return three_two_one(elements[0], elements[1], elements[2] if len(elements) > 2 else None), ""
    except InputError as error:
        return None, f"There are no part coordinates: {error}"


def _key(plan: InspectionPlan, spec: FeatureSpec, scene: Scene, of: str, *, framed: bool) -> str:
    """Names all that a feature's measurement follows from, its own name among it; what is asked of it is not.

    `of` names the scan, and the nominal surface where it is compared with one.
    """
    rests_on = [scene.found[name].key for name in spec.needs]
    frame = (plan.frame, [scene.found[name].key for name in plan.frame.names]) if framed and plan.frame else None
    master = plan.master if plan.master is not None and spec.name in plan.master.features else None
    measured = replace(spec, limits=(), nominal_heights=())
    said = repr((of, measured, plan.k, plan.temperature, master, rests_on, frame))
    return hashlib.sha256(said.encode()).hexdigest()[:32]


def _digest(cloud: Cloud, mesh: Mesh | None, errors: PointErrors | None) -> str:
    """Names a scan by its content."""
    arrays = [cloud.points, cloud.sigma, cloud.uv, cloud.sweep, cloud.normals]
    if mesh is not None:
        arrays += [mesh.vertices, mesh.triangles]
    if errors is not None:
        lengths = [getattr(errors, one.name) for one in fields(errors)]
        arrays += [np.array([length for length in lengths if isinstance(length, float)])]
        arrays += [] if errors.speckle is None else [errors.speckle.covariance, errors.speckle.shares]
        arrays += [] if errors.sweep_covariance is None else [errors.sweep_covariance]
        arrays += [] if errors.common is None else [errors.common.sweeps, errors.common.cameras, errors.common.fans]
    return _sum_of(arrays)


def _sum_of(arrays: Iterable[NDArray[Any]]) -> str:
    """Names arrays by their content."""
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(np.ascontiguousarray(array).view(np.uint8).data if array.size else b"")
    return digest.hexdigest()


def _missing(errors: PointErrors) -> tuple[str, ...]:
    """A sentence on what the stated uncertainties do not hold."""
    missing = [] if errors.sweep_covariance is not None else ["the sweeps' light planes"]
    known = () if errors.common is None else errors.common.sources
    missing += [name for name, source in (("the camera", CAMERA), ("the fan", FAN_CALIBRATION)) if source not in known]
    if not missing:
        return ()
    proof = "" if errors.sweep_covariance is not None else ", and prove nothing"
    return (f"The stated uncertainties do not hold that of {', '.join(missing)}: they are less than is known{proof}.",)
