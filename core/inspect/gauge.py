"""The thickness of a gauge block: distance of its two parallel faces.

Baseline rule: **thickness is the distance of two parallel planes fitted jointly and robustly to the points of both
faces**, one common normal and two distances. `core.inspect.fit.plane_fit` finds which points belong to them as if
points were independent, and then fits the same planes with the points' true covariance. No point of the table is
extrapolated by itself, and no mean height is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from core.errors import InputError
from core.findings.proof import Doubt, Doubts, notes_of
from core.findings.table import note_of
from core.inspect.faces import FacePair, faces_in_polygons, find_faces, region_field
from core.inspect.fit.judged_form import LOWER_FACE, UPPER_FACE, notes_on_form
from core.inspect.fit.plane_fit import (
    FittedFaces,
    ParallelPlaneFit,
    fit_faces,
    fit_parallel_planes,
)
from core.inspect.fit.spanned import faces_not_spanned
from core.inspect.free_faces import angle_of, free_faces
from core.inspect.results import Contribution, Face, GaugeResult, PairCandidate
from core.inspect.uncertainty.budget import budget, combined
from core.inspect.uncertainty.coverage import student_factor
from core.inspect.uncertainty.point_errors import PointErrors
from core.inspect.uncertainty.skewed_light import doubts_of_light
from core.messages import Field, Message
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.stage_times import stage

Polygons = tuple[ArrayLike, ArrayLike]

RULE = Message(
    "gauge.rule_planes", "distance of two parallel planes fitted jointly and robustly to the points of both faces"
)
RULE_LINE = Message(
    "gauge.rule_lines",
    "distance of two parallel lines fitted jointly and robustly to one light profile, at right angles to them and "
    "along the reference normal",
)


@dataclass(frozen=True, eq=False, slots=True)
class GaugeFit:
    """Fit of two parallel planes to the two faces of a part.

    `faces` is the joint fit, over `pair.upper` and `pair.lower` (indices into the cloud); `robust` the same planes
    fitted as if points were independent; `upper` and `lower` are each fitted freely, `parallelism` (rad) is the angle
    between them, None where one of them is not spanned by its points. `budget` says what the uncertainty of the
    thickness is made of, `notes` what is wrong with the form of the faces.
    """

    faces: FittedFaces
    robust: ParallelPlaneFit
    pair: FacePair
    upper: Face
    lower: Face
    parallelism: float | None
    budget: tuple[Contribution, ...]
    notes: tuple[Message, ...]

    @property
    def planes(self) -> ParallelPlaneFit:
        """Two parallel planes of the joint fit to both faces."""
        return self.faces.planes

    @property
    def thickness_mm(self) -> float:
        """Distance between the two parallel planes, in mm."""
        return self.planes.thickness


def fit_gauge(
    cloud: Cloud,
    *,
    errors: PointErrors | None = None,
    regions: Polygons | FacePair | None = None,
    nominal_mm: float | None = None,
    progress: Progress = silent,
) -> GaugeFit:
    """Find the two parallel faces of a part in a cloud, and fit two parallel planes to them.

    Parameters
    ----------
    cloud
        The measured points.
    errors
        How their errors hang together; None: each stretch of a stripe by itself.
    regions
        (upper, lower) polygons, each (n, 2) in pixels, or the points of the faces themselves; None: the two largest
        parallel faces are found.
    nominal_mm
        Thickness of the faces that are meant, should several pairs be found.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        If there are no two parallel faces, or the one given as the upper is not nearer to the camera.
    """
    if regions is None:
        pair = find_faces(cloud, nominal_mm=nominal_mm, progress=progress)
    elif isinstance(regions, FacePair):
        pair = regions
    else:
        pair = faces_in_polygons(cloud, *regions)
    errors = errors or PointErrors()
    upper, lower = cloud.select(pair.upper), cloud.select(pair.lower)
    robust = fit_parallel_planes(upper.points, lower.points, upper.sigma, lower.sigma)
    if robust.thickness <= 0:
        raise InputError(
            Message("gauge.upper_face_behind", "the upper face lies behind the lower one as the camera sees them"),
            where=region_field("upper"),
            todo=Message("gauge.advice_exchange_faces", "exchange upper_polygon_px and lower_polygon_px"),
        )

    def joint_fit() -> tuple[FittedFaces, tuple[Message, ...]]:
        with stage(progress, "faces"):
            faces = fit_faces(upper, lower, robust, errors)
            return faces, _notes_on_form(cloud, pair, faces.planes, errors)

    with ThreadPoolExecutor(1) as pool:  # beside the free fits, which hardly ever wait for it
        joint = pool.submit(joint_fit)
        free = free_faces(
            cloud,
            pair,
            lambda: joint.result()[0].planes,
            errors,
            progress,
            tilt_determined=robust.tilt_determined,
        )
        faces, notes = joint.result()
    return GaugeFit(faces, robust, pair, *free, angle_of(*free), _budget(faces, errors), notes)


def measure_gauge(
    cloud: Cloud,
    *,
    errors: PointErrors | None = None,
    regions: Polygons | FacePair | None = None,
    nominal_mm: float | None = None,
    tolerance_mm: float | None = None,
    k: float = 2.0,
    progress: Progress = silent,
) -> GaugeResult:
    """Measure the thickness of a part in a cloud in mm, with its uncertainty and, if limits are given, its verdict.

    Parameters
    ----------
    cloud
        The measured points.
    errors
        How their errors hang together; what it does not know is not in the uncertainty, which then proves nothing.
    regions
        As for `fit_gauge`.
    nominal_mm, tolerance_mm
        What the part should be, ±; without both of them there is no verdict.
    k
        Coverage factor where u is known; Student's t makes it larger where form makes up much of u.
    progress
        Called with how far it is.

    Raises
    ------
    InputError
        As `fit_gauge`.
    """
    errors = errors or PointErrors()
    fit = fit_gauge(cloud, errors=errors, regions=regions, nominal_mm=nominal_mm, progress=progress)
    u, factor = combined(fit.budget), student_factor(k, fit.budget)
    gauge = GaugeResult(
        thickness_mm=fit.thickness_mm,
        u_mm=u,
        k=factor,
        upper=fit.upper,
        lower=fit.lower,
        parallelism=fit.parallelism,
        budget=fit.budget,
        nominal_mm=nominal_mm,
        tolerance_mm=tolerance_mm,
        normal=fit.planes.normal,
        rule=RULE if fit.planes.tilt_determined else RULE_LINE,
        notes=fit.notes,
        doubts=(),
        candidates=fit.pair.candidates,
    )
    if errors.part is not None:
        gauge = adjusted(gauge, errors.part.thicker_mm, errors.part.surface_rows, errors.part.surface_notes, k=k)
    return doubted(gauge, (*errors.doubts, *_doubts(fit), *doubts_of_light(fit.budget)))


def _doubts(fit: GaugeFit) -> Doubts:
    """Why the thickness proves nothing, by its faces themselves."""
    names = [name for name, face in ((UPPER_FACE, fit.upper), (LOWER_FACE, fit.lower)) if not face.spanned]
    return (
        *([Doubt.of(_several(fit.pair.candidates))] if fit.pair.candidates else []),
        *([Doubt.of(faces_not_spanned(names))] if names else []),
    )


def _several(candidates: Sequence[PairCandidate]) -> Message:
    """That it is not known which of several pairs of faces is meant: the one measured, and the next best."""
    chosen, second = candidates[:2]
    return note_of(
        "gauge.several_faces",
        n=len(candidates),
        mm=chosen.thickness_mm,
        u=chosen.upper_px[0],
        v=chosen.upper_px[1],
        other_mm=second.thickness_mm,
        other_u=second.upper_px[0],
        other_v=second.upper_px[1],
        lower=Field("gauge.lower_polygon_px"),
    )


def _notes_on_form(cloud: Cloud, pair: FacePair, planes: ParallelPlaneFit, errors: PointErrors) -> tuple[Message, ...]:
    """What is wrong with the form of the two faces; nothing is said of single lines on them."""
    if not planes.tilt_determined:
        return ()
    indices = np.concatenate([pair.upper, pair.lower])
    part = np.repeat([0, 1], [len(pair.upper), len(pair.lower)])
    shape = planes.shape(cloud.points[indices], part)
    return notes_on_form(cloud, indices, shape, errors, (UPPER_FACE, LOWER_FACE), part, lies=True)


def doubted(gauge: GaugeResult, doubts: Doubts) -> GaugeResult:
    """Set the doubts of a thickness, reasons why it proves nothing, and put the notes on them before the others."""
    return replace(gauge, notes=(*notes_of(doubts), *gauge.notes), doubts=doubts)


def adjusted(
    gauge: GaugeResult,
    change_mm: float,
    rows: tuple[Contribution, ...],
    notes: tuple[Message, ...] = (),
    *,
    k: float = 2.0,
) -> GaugeResult:
    """Add a correction in mm to a measured thickness, and the rows of that correction to its uncertainty budget.

    `k` is the coverage factor where u is known.
    """
    if not change_mm and not rows:
        return replace(gauge, notes=(*gauge.notes, *notes))
    budget, thickness = (*gauge.budget, *rows), gauge.thickness_mm + change_mm
    return replace(
        gauge,
        thickness_mm=thickness,
        u_mm=combined(budget),
        k=student_factor(k, budget),
        budget=budget,
        notes=(*gauge.notes, *notes),
    )


def _budget(faces: FittedFaces, errors: PointErrors) -> tuple[Contribution, ...]:
    return budget(
        faces.gains,
        faces.sources,
        own=faces.fit.own,
        form_mm=faces.fit.form_mm,
        calibrations=errors.calibrations,
    )
