"""Form free of the points' noise: 0 is within U of what is perfect, and a true form is found within its U."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.fit import surface_fit
from core.inspect.fit.generalised import Generalised, generalised_fit
from core.inspect.fit.round import sphere_through
from core.inspect.fit.shapes import Cylinder, ParallelPlanes, Shape
from core.inspect.fit.surface_fit import fit_surface
from core.inspect.gauge import measure_gauge
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.point_errors import PointErrors
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import HALF, NORMAL, TABLE_MM, BlockScan, axes
from tests.inspect.shape_scan import BALL, PIN, PIN_AXIS, PIN_RADIUS, ShapeScan

BLOCK, SHAPES = BlockScan(height=40.0, sweeps=30), ShapeScan()
ERRORS = PointErrors(BLOCK.covariance)
ON_TOP = (BLOCK.points - (TABLE_MM - BLOCK.height) * NORMAL) @ axes().T
INNER = BLOCK.upper & (np.abs(ON_TOP).max(axis=1) < HALF - 1.5)
HUNDRED = pytest.param(100, marks=pytest.mark.accuracy)


def surface(kind: str, seed: int) -> tuple[Cloud, Array, Shape, PointErrors]:
    """Points on one surface, how far along it each is from its middle, about where it lies, and the points' errors."""
    rng = np.random.default_rng(seed)
    if kind == "plane":
        cloud = BLOCK.measure(rng).select(INNER)
        start = ParallelPlanes.through(-NORMAL, cloud.points.mean(axis=0)[None])
        return cloud, ON_TOP[INNER, 0] / HALF, start, ERRORS
    cloud = SHAPES.measure(rng).select(SHAPES.on == (0 if kind == "sphere" else 1))
    if kind == "sphere":
        return cloud, (cloud.points - BALL)[:, 0] / 20.0, sphere_through(cloud.points), SHAPES.errors
    return cloud, (cloud.points - PIN) @ PIN_AXIS / 25.0, Cylinder.along(PIN, PIN_AXIS, PIN_RADIUS), SHAPES.errors


def off_by(kind: str, seed: int, form_mm: float) -> tuple[float, float, float]:
    """The zone found, its U, and the true one, of a surface that is wavy by so many mm along one direction."""
    cloud, along, start, errors = surface(kind, seed)
    part = np.zeros(len(cloud), dtype=np.int64)
    outward, design = start.outward(cloud.points, part), start.design(cloud.points, part)
    height = np.cos(4.0 * along)
    height -= design @ np.linalg.lstsq(design, height, rcond=None)[0]  # what another surface of its kind is as well
    height *= form_mm / np.ptp(height)
    depth = cloud.points[:, 2]
    moved = height / (outward * cloud.points / depth[:, None]).sum(axis=1)
    wavy = replace(cloud, points=cloud.points * (1 + moved / depth)[:, None])
    form = fit_surface(wavy, np.arange(len(cloud)), start, errors, form_mm=0.0).form
    assert form is not None
    return form.value, 2 * form.u, form_mm


@pytest.mark.parametrize("kind", ["plane", "sphere"])
def test_a_fit_that_ends_with_the_step_at_rest_is_that_of_all_steps(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, _, start, errors = surface(kind, 0)
    steps = [0]

    def counted(design: Array, misfit: Array, sources: Sources) -> Generalised:
        steps[-1] += 1
        return generalised_fit(design, misfit, sources)

    monkeypatch.setattr(surface_fit, "generalised_fit", counted)
    ended = fit_surface(cloud, np.arange(len(cloud)), start, errors)
    monkeypatch.setattr(surface_fit, "AT_REST", 0.0)
    steps.append(0)
    whole = fit_surface(cloud, np.arange(len(cloud)), start, errors)
    assert steps[0] < steps[1] == surface_fit.STEPS
    np.testing.assert_allclose(ended.residuals, whole.residuals, atol=1e-8)
    for one, other in zip(ended.effects, whole.effects, strict=True):
        np.testing.assert_allclose(np.linalg.norm(one.factor), np.linalg.norm(other.factor), rtol=1e-4)


@pytest.mark.parametrize("count", [8, HUNDRED])
@pytest.mark.parametrize("kind", ["plane", "sphere", "cylinder"])
def test_of_perfect_surfaces_0_is_within_u(kind: str, count: int) -> None:
    found = np.array([off_by(kind, seed, 0.0) for seed in range(count)])
    assert np.count_nonzero(found[:, 0] > found[:, 1]) <= 1 + 0.06 * count
    assert found[:, 1].mean() < 0.04
    assert found[:, 0].mean() < 0.015


@pytest.mark.parametrize("count", [8, HUNDRED])
@pytest.mark.parametrize("kind", ["plane", "sphere", "cylinder"])
def test_a_form_of_50_micrometres_is_found_within_u(kind: str, count: int) -> None:
    found = np.array([off_by(kind, seed, 0.05) for seed in range(count)])
    assert np.count_nonzero(np.abs(found[:, 0] - 0.05) > found[:, 1]) <= 1 + 0.08 * count
    assert found[:, 1].mean() < 0.03


def test_what_is_printed_of_the_faces_of_a_block_is_free_of_noise_too() -> None:
    gauge = measure_gauge(BLOCK.measure(np.random.default_rng(0)), errors=ERRORS)
    for face in (gauge.upper, gauge.lower):
        assert face.flatness_mm is not None
        assert face.flatness_u_mm is not None
        assert face.flatness_mm <= 2 * face.flatness_u_mm < 0.05
