"""The sphere above the table: found, and its radius with an honest uncertainty."""

import numpy as np
import pytest

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.fit.round import find_sphere
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import CENTRE, FOCAL
from tests.inspect.sphere_fit import fit_sphere

RADIUS = 25.0
MIDDLE = np.array([8.0, -5.0, 545.0 - RADIUS])


def scan(rng, noise=0.02, outliers=0.0, sphere=True):
    """Vertical stripes over a ball on a table square to the camera's axis."""
    u, v = np.meshgrid(np.arange(700.0, 1250.0, 8), np.arange(420.0, 920.0, 2))
    uv = np.column_stack([u.T.ravel(), v.T.ravel()])
    sweep = np.repeat(np.arange(u.shape[1]), u.shape[0])
    rays = np.column_stack([(uv - CENTRE) / FOCAL, np.ones(len(uv))])
    half = rays @ MIDDLE
    square = (rays**2).sum(axis=1)
    under = half**2 - square * (MIDDLE @ MIDDLE - RADIUS**2)
    hit = (under > 0) & sphere
    depth = np.where(hit, (half - np.sqrt(np.maximum(under, 0))) / square, 545.0)
    points = rays * depth[:, None]
    slant = np.abs(((points - MIDDLE) / RADIUS * rays).sum(axis=1))
    seen = ~hit | (slant > 0.3)
    depth += noise * rng.normal(size=len(depth))
    wrong = rng.random(len(depth)) < outliers
    depth[wrong] += rng.uniform(-5, 5, wrong.sum())
    points = (rays * depth[:, None])[seen]
    count = len(points)
    cloud = Cloud(
        points, uv[seen], np.full(count, noise), np.ones(count), sweep[seen], sweep[seen], np.zeros((count, 3))
    )
    return cloud, hit[seen]


def test_radius_within_the_proof_among_wrong_points():
    cloud, hit = scan(np.random.default_rng(0), outliers=0.05)
    fit = fit_sphere(cloud, errors=PointErrors(correlation_px=2.0))
    assert fit.radius_mm == pytest.approx(RADIUS, abs=0.02)
    assert fit.centre == pytest.approx(MIDDLE, abs=0.02)
    assert hit[fit.indices].all()
    assert len(fit.indices) > 0.8 * hit.sum()


def test_stated_uncertainty_is_the_scatter_of_the_radius():
    rng = np.random.default_rng(1)
    _, hit = scan(rng)
    fits = [fit_sphere(scan(rng)[0], np.flatnonzero(hit), errors=PointErrors(correlation_px=2.0)) for _ in range(40)]
    radii = np.array([fit.radius_mm for fit in fits])
    stated = np.mean([fit.u_mm for fit in fits])
    assert stated == pytest.approx(radii.std(), rel=0.25)
    assert radii.mean() == pytest.approx(RADIUS, abs=5 * stated / np.sqrt(40) + 1e-4)


def test_exact_points_give_the_exact_sphere():
    cloud, hit = scan(np.random.default_rng(2), noise=1e-9)
    fit = fit_sphere(cloud, np.flatnonzero(hit))
    assert fit.radius_mm == pytest.approx(RADIUS, abs=1e-6)
    assert fit.form_mm < 1e-6


def test_form_of_a_ball_is_free_of_its_points_noise():
    cloud, hit = scan(np.random.default_rng(3), noise=0.03)
    fit = fit_sphere(cloud, np.flatnonzero(hit), errors=PointErrors(correlation_px=2.0))
    assert fit.form_mm <= 2 * fit.u_form_mm < 0.05


def test_same_seed_same_points():
    cloud, _ = scan(np.random.default_rng(4))
    assert find_sphere(cloud, seed=3).tobytes() == find_sphere(cloud, seed=3).tobytes()


def test_no_sphere_and_too_few_points_are_said():
    table, _ = scan(np.random.default_rng(5), sphere=False)
    with pytest.raises(InputError, match="on a sphere"):
        find_sphere(table)
    with pytest.raises(InputError, match="too few for a sphere"):
        fit_sphere(table, np.arange(5))


def test_wide_light_on_a_ball_makes_its_radius_less_sure_by_its_square():
    cloud, on = scan(np.random.default_rng(3))
    indices = np.flatnonzero(on)
    narrow, wide = (fit_sphere(cloud, indices, errors=PointErrors(stripe_px=width)) for width in (1.5, 3.0))
    share = [next(row.u_mm for row in fit.budget if row.source == Cause.UNEVEN_LIGHT) for fit in (narrow, wide)]
    assert share[1] == pytest.approx(4 * share[0])
    assert wide.u_mm > narrow.u_mm > fit_sphere(cloud, indices, errors=PointErrors()).u_mm
