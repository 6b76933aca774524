"""A plan measured on one scan: each feature by itself, and only what an edit changed."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.door import Origin
from core.errors import InputError
from core.findings.brought import OURS, failure, note_on_unusable, unusable
from core.findings.proof import SIZE_UNCONFIRMED, Doubt, notes_of
from core.findings.table import fact_of, note_of
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Verdict
from core.inspect.features.measured import FeatureResult, Measure, Scene
from core.inspect.fit.elements import Element
from core.inspect.fit.plane_search import FoundPlane
from core.inspect.plan.alignment import three_two_one
from core.inspect.plan.conditions import Master
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.plan.kinds import brought_kinds, kind_of, unusable_kinds
from core.inspect.plan.plugins import NAME_TAKEN, plugins
from core.inspect.plan.temperature import at_reference, compared, temperature_of, with_scale
from core.inspect.result_list import ResultList
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.inspect.uncertainty.skewed_light import doubts_of_light
from core.messages import Message, plain
from core.model import Pose
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from core.scan.surface.triangles import Triangles


@dataclass(frozen=True, eq=False, slots=True)
class Inspection:
    """Results of a plan on one scan.

    Parameters
    ----------
    plan
        As it was asked.
    results
        One for each feature, in the plan's order.
    pose_camera_part
        Part coordinates into the camera frame; None: they are the camera's, or their features were not measured.
    notes
        What is to be known of the whole.
    scan_key
        Hash of the scan's content.
    planes
        Plane faces found in it, by their margin: for the next inspection of the same scan.
    """

    plan: InspectionPlan
    results: tuple[FeatureResult, ...]
    pose_camera_part: Pose | None = None
    notes: tuple[Message, ...] = ()
    scan_key: str = ""
    planes: Mapping[float, tuple[FoundPlane, ...]] = field(default_factory=dict)

    @property
    def characteristics(self) -> tuple[Characteristic, ...]:
        """Characteristics of all features of the plan, in the plan's order."""
        return tuple(row for result in self.results for row in result.characteristics)

    @property
    def problems(self) -> tuple[Message, ...]:
        """Messages that say why a feature could not be measured, one for each such feature."""
        return tuple(result.problem for result in self.results if result.problem)

    def result(self, name: str) -> FeatureResult:
        """Find the result of the feature called `name`; KeyError if there is none."""
        return {result.spec.name: result for result in self.results}[name]

    @property
    def unmeasured(self) -> bool:
        """Whether any feature that has limits could not be measured."""
        return any(result.problem and result.spec.limits for result in self.results)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the features of the plan alone, without a thickness that was measured beside the plan."""
        return ResultList(None, self.characteristics, self.unmeasured).verdict


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
    """Measure all features of a plan on a cloud; results of `previous` that the plan has not changed are reused.

    Parameters
    ----------
    plan
        What is to be measured.
    cloud, mesh
        The scan, and the surface over it for comparisons with nominal ones; without it the points are compared.
    errors
        How the points' errors hang together; what it does not know is not in the uncertainties, which then prove
        nothing.
    progress
        Called with how far it is; may raise Cancelled.
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
    scene = Scene(cloud, mesh, errors or PointErrors(), plan.k, nominals or {}, frame=plan.frame, progress=progress)
    part = scene.errors.part
    if part is None:
        scene.temperature = plan.temperature
    else:
        scene.temperature = with_scale(plan.temperature, part.target) if plan.temperature else temperature_of(part)
    known = {} if previous is None else {result.key: result for result in previous.results if result.key}
    scan_key = _digest(cloud, mesh, errors)
    nominal_keys = {name: _sum_of([surface.corners]) for name, surface in (nominals or {}).items()}
    if previous is not None and previous.scan_key == scan_key:
        scene.found_planes.update(previous.planes)
    frame_problem: Message | None = None
    for number, spec in enumerate(ordered):
        progress("features", number, len(ordered))
        framed = spec.in_part_coordinates and plan.frame is not None
        if framed and plan.frame is not None and scene.pose_camera_part is None and not frame_problem:
            scene.pose_camera_part, frame_problem = _frame(plan.frame, scene)
        nominal = "" if spec.deviation is None else nominal_keys.get(spec.deviation.nominal, "")
        key = _key(plan, spec, scene, scan_key + nominal, framed=framed)
        if key in known and not (known[key].chosen_by_nominal and known[key].spec.limits != spec.limits):
            result = _with_limits_of(known[key], spec)
        else:
            result = _measured(plan, spec, scene, frame_is_known=not (framed and frame_problem))
        scene.found[spec.name] = replace(result, key=key)
    if plan.frame is not None and scene.pose_camera_part is None and not frame_problem:
        scene.pose_camera_part, frame_problem = _frame(plan.frame, scene)
    progress("features", len(ordered), len(ordered))
    results = tuple(scene.found[spec.name] for spec in plan.features)
    notes = (*notes_of(scene.errors.doubts), *([frame_problem] if frame_problem else []))
    notes += _of_part(plan, scene.errors.part)
    inspection = Inspection(plan, results, scene.pose_camera_part, notes, scan_key, scene.found_planes)
    return replace(inspection, notes=(*notes, *_of_plugins(inspection)))


def _measured(plan: InspectionPlan, spec: FeatureSpec, scene: Scene, *, frame_is_known: bool) -> FeatureResult:
    """One feature, its lengths at 20 °C and compared with the master; a problem instead of a complaint."""
    where = Message("feature.where", "feature {name}", name=spec.name)
    broken = [name for name in spec.needs if scene.found[name].problem]
    try:
        if broken:
            raise InputError(Message("feature.was_not_measured", "{name} was not measured", name=broken[0]))
        if not frame_is_known:
            raise InputError(Message("feature.no_part_coordinates", "there are no part coordinates"))
        measure: Measure = kind_of(spec).measure
        result = measure(spec, scene)
    except InputError as error:
        return FeatureResult(spec, problem=InputError(error.what, where=where, todo=error.todo).message)
    except Exception as error:
        if spec.kind not in brought_kinds():
            raise
        said = failure(brought_kinds()[spec.kind][1] or OURS, spec.kind, error)
        return FeatureResult(spec, problem=InputError(said, where=where).message)
    rows = result.characteristics
    if (origin := _origin_of(spec.kind)) is not None:
        brought = note_of("plugin.measured_by", package=origin.package, version=origin.version)
        rows = tuple(replace(row, notes=(*row.notes, brought)) for row in rows)
    if scene.temperature is not None:
        rows = tuple(at_reference(row, scene.temperature, plan.k) for row in rows)
    if plan.master is not None and spec.name in plan.master.features:
        rows = tuple(_by_master(row, plan.master, plan.k) for row in rows)
    return replace(result, characteristics=rows)


def _origin_of(kind: str) -> Origin | None:
    """The package from which a kind comes; None: the program itself."""
    return brought_kinds()[kind][1] if kind in brought_kinds() else None


def _of_plugins(inspection: Inspection) -> tuple[Message, ...]:
    """What checks of other packages say of an inspection, and what of such packages does not work."""
    found = plugins()
    said = list(found.problems)
    taken = [name for name, (_, origin) in found.kinds.items() if _origin_of(name) != origin]
    said += [unusable(name, found.kinds[name][1], NAME_TAKEN) for name in taken]
    said += [note_on_unusable(one) for one in unusable_kinds()]
    for check in found.checks:
        try:
            said += [plain(f"{check.name} ({check.origin.package} {check.origin.version}): {text}")
                     for text in check.of(inspection)]  # fmt: skip
        except Exception as error:  # noqa: BLE001  (whatever a stranger's check raises: the measurement stands)
            said.append(failure(check.origin, check.name, error))
    return tuple(said)


def _by_master(length: Characteristic, master: Master, k: float) -> Characteristic:
    """A length by comparison with a master: with one calibration a doubt of the plane target's size cancels in it.

    Doubts of the master's own results count, and skewed light may make up much of the uncertainty that is left.
    """
    found = compared(length, master, k)
    if not found.by_master:
        return found
    added = doubts_of_light(found.budget)
    if master.remaining_doubts:
        why = notes_of(master.remaining_doubts)
        added += (Doubt.of(note_of("feature.master_doubted", master=master.name, why=why)),)
    added = tuple(doubt for doubt in added if doubt not in found.doubts)
    gone = SIZE_UNCONFIRMED.fact if master.same_calibration else None
    return replace(
        found,
        notes=(*notes_of(added), *(note for note in found.notes if fact_of(note) != gone)),
        doubts=(*(doubt for doubt in found.doubts if doubt.fact != gone), *added),
    )


def _with_limits_of(result: FeatureResult, spec: FeatureSpec) -> FeatureResult:
    """The same measurement with the limits of `spec`, which differs from its own in nothing else."""
    start = len(spec.name) + 1
    rows = tuple(replace(row, limits=spec.limits_of(row.name[start:])) for row in result.characteristics)
    same = all(a.limits == b.limits for a, b in zip(rows, result.characteristics, strict=True))
    return replace(result, spec=spec, characteristics=result.characteristics if same else rows)


def _frame(frame: PartFrame, scene: Scene) -> tuple[Pose | None, Message | None]:
    """The part's frame, or why there is none."""
    elements: list[Element] = []
    for name in frame.names:
        result = scene.found.get(name)
        if result is None or result.element is None:
            why = note_of("feature.frame_not_measured", name=name)
            return None, _no_frame(why)
        elements.append(result.element)
    try:
        return three_two_one(elements[0], elements[1], elements[2] if len(elements) > 2 else None), None
    except InputError as error:
        return None, _no_frame(error.message)


def _no_frame(why: Message) -> Message:
    return note_of("inspection.no_frame", why=why)


def _key(plan: InspectionPlan, spec: FeatureSpec, scene: Scene, of: str, *, framed: bool) -> str:
    """Hash of all that a feature's measurement follows from: its own specification without limits, which change no
    number, the features and the frame it rests on, and `of`, the hash of the scan and of its nominal surface.
    """
    rests_on = [scene.found[name].key for name in spec.needs]
    frame = (plan.frame, [scene.found[name].key for name in plan.frame.names]) if framed and plan.frame else None
    master = plan.master if plan.master is not None and spec.name in plan.master.features else None
    measured = replace(spec, limits=(), nominal_heights=())
    origin = _origin_of(spec.kind)  # another version of a package measures anew
    said = repr(
        (*([] if origin is None else [origin]), of, measured, plan.k, plan.temperature, master, rests_on, frame)
    )
    return hashlib.sha256(said.encode()).hexdigest()[:32]


def _digest(cloud: Cloud, mesh: Mesh | None, errors: PointErrors | None) -> str:
    """Hash of a scan's content."""
    arrays = [cloud.points, cloud.sigma, cloud.uv, cloud.sweep, cloud.normals]
    arrays += [cloud.skewness, cloud.spread_mm]
    if mesh is not None:
        arrays += [mesh.vertices, mesh.triangles]
    if errors is not None:
        lengths = [getattr(errors, one.name) for one in fields(errors)]
        arrays += [np.array([length for length in lengths if isinstance(length, float)])]
        arrays += [np.frombuffer(repr(doubt).encode(), np.uint8) for doubt in errors.doubts]
        arrays += [] if errors.part is None else [np.frombuffer(repr(errors.part).encode(), np.uint8)]
        arrays += [] if errors.speckle is None else [errors.speckle.covariance, errors.speckle.shares]
        arrays += [] if errors.sweep_covariance is None else [errors.sweep_covariance]
        arrays += [] if errors.common is None else [errors.common.sweeps, errors.common.cameras, errors.common.fans]
        arrays += [] if errors.common is None or errors.common.bends is None else [errors.common.bends]
    return _sum_of(arrays)


def _sum_of(arrays: Iterable[NDArray[Any]]) -> str:
    """Hash of the content of arrays."""
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(np.ascontiguousarray(array).view(np.uint8).data if array.size else b"")
    return digest.hexdigest()


def _of_part(plan: InspectionPlan, part: Part | None) -> tuple[Message, ...]:
    """What is assumed of the part, and what is stated of it and used of thicknesses alone."""
    if part is None:
        return ()
    if plan.temperature is not None:
        part = replace(part, celsius=plan.temperature.part_celsius)
    assumed = part.assumed
    if not part.surface_rows and not part.thicker_mm:
        return assumed
    return (
        *assumed,
        note_of("part.thicknesses_alone"),
    )
