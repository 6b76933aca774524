"""Measure a part on the points of a scan: a thickness, or features, each with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from core.inspect.evaluate import Inspection, evaluate
from core.inspect.gauge import measure_gauge
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.results import GaugeResult
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.pipeline.steps.gauge_step import of_part
from core.progress import Progress, silent
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh
from trisect.scan import SolvedScan


def measure_thickness(
    scan: SolvedScan | Cloud,
    *,
    nominal_mm: float | None = None,
    tolerance_mm: float | None = None,
    regions_px: tuple[ArrayLike, ArrayLike] | None = None,
    part: Part | None = None,
    progress: Progress = silent,
) -> GaugeResult:
    """Measure the thickness between two parallel faces, with its uncertainty and, if asked for, a verdict.

    Parameters
    ----------
    scan
        A solved scan, or points alone: u then holds neither calibrations nor correlations, and nothing is proven.
    nominal_mm, tolerance_mm
        What it should be, ±; without both of them there is no verdict.
    regions_px
        Outlines of the upper and of the lower face, each (n, 2) in px; None: the two largest parallel faces.
    part
        What is known of the part's material and temperature; None: nothing.
    progress
        Called with how far it is.

    Returns
    -------
    Gauge
        `thickness_mm`, `u_mm`, `k`, `U_mm`, the budget, both faces, `verdict` by ISO 14253-1, and `notes`.

    Raises
    ------
    InputError
        If there are no two parallel faces, or the upper one is not nearer to the camera.

    References
    ----------
    The paper, section 3.3; JCGM 100:2008 for u, ISO 14253-1:2017 for the verdict.

    Examples
    --------
    >>> gauge = measure_thickness(step)
    >>> round(gauge.thickness_mm, 1), gauge.u_mm > 0, str(gauge.verdict)
    (30.0, True, '')
    """
    cloud, errors = _points_of(scan)
    known = part or Part()
    gauge = measure_gauge(
        cloud,
        errors=replace(errors, part=known),
        regions=regions_px,
        nominal_mm=nominal_mm,
        tolerance_mm=tolerance_mm,
        progress=progress,
    )
    return of_part(gauge, known)


def measure_features(
    scan: SolvedScan | Cloud,
    features: Sequence[FeatureSpec],
    *,
    mesh: Mesh | None = None,
    part: Part | None = None,
    progress: Progress = silent,
) -> Inspection:
    """Measure features of a part on the points of a scan: planes, steps, spheres, cylinders, distances and more.

    Parameters
    ----------
    scan
        As for `measure_thickness`.
    features
        What to measure, in order; later ones may be derived from earlier ones.
    mesh
        The surface, for comparisons with nominal ones.
    part
        What is known of the part's material and temperature; None: nothing.
    progress
        Called with how far it is.

    Returns
    -------
    Inspection
        `characteristics`, each a Length with `value` (mm, or rad of an angle), `u`, `U`, `k` and verdict; `problems`
        say why a feature could not be measured.

    Raises
    ------
    InputError
        If the features contradict each other: two of one name, or one derived from another that is not there.

    References
    ----------
    ISO 1101 and ISO 5459 for what is measured, JCGM 100:2008 for u.

    Examples
    --------
    >>> inspection = measure_features(step, [Feature("block", "thickness")])
    >>> [(one.name, round(one.value, 1), one.u > 0) for one in inspection.characteristics]
    [('block thickness', 30.0, True)]
    """
    cloud, errors = _points_of(scan)
    plan = InspectionPlan(features=tuple(features))
    return evaluate(plan, cloud, mesh, replace(errors, part=part or Part()), progress)


def _points_of(scan: SolvedScan | Cloud) -> tuple[Cloud, PointErrors]:
    return (scan, PointErrors()) if isinstance(scan, Cloud) else (scan.cloud, scan.errors)
