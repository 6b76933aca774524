"""Each row of a budget against a case that can be worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from core.inspect.causes import Cause
from core.inspect.fit.generalised import generalised_fit
from core.inspect.uncertainty.budget import budget, combined
from core.inspect.uncertainty.error_sources import Sources
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.common_errors import CommonErrors
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.triangulate import join


def stripe_cloud(sweep, count=100, sigma=0.02, v=0.0):
    """`count` points one pixel apart on a horizontal stripe in front of a pinhole camera, z = 500 mm."""
    u = np.arange(count, dtype=float)
    uv = np.column_stack([u, np.full(count, v)])
    points = np.column_stack([(uv - 50) / 2500 * 500, np.full(count, 500.0)])
    index = np.full(count, sweep)
    return Cloud(points, uv, np.full(count, sigma), np.ones(count), index, index, np.zeros((count, 3)))


def mean_depth(cloud, errors):
    """Budget of the mean depth of all points of a cloud, by its rows."""
    face = np.zeros(len(cloud), dtype=np.int64)
    sources = Sources.of(cloud, np.array([0.0, 0.0, 1.0]), np.ones(len(cloud)), face, face, errors)
    gains = np.bincount(sources.stretch) / len(cloud)
    return budget(gains, sources, form_mm=0.0, calibrations=errors.calibrations)


def u_of(rows):
    return {row.source: row.u_mm for row in rows}


def test_noise_correlated_over_a_stretch_averages_over_stretches():
    rows = u_of(mean_depth(stripe_cloud(0), PointErrors(correlation_px=10.0)))
    assert Cause.FAN_SPECKLE not in rows
    assert rows[Cause.POINT_NOISE] == pytest.approx(0.02 / np.sqrt(10), rel=0.06)
    rows = u_of(mean_depth(stripe_cloud(0), PointErrors(correlation_px=0.5)))
    assert rows[Cause.POINT_NOISE] == pytest.approx(0.02 / np.sqrt(100), rel=1e-3)


def test_fan_points_have_their_own_length():
    rows = u_of(mean_depth(stripe_cloud(FAN - 1), PointErrors(correlation_px=1.0, speckle_px=25.0)))
    assert rows[Cause.FAN_SPECKLE] == pytest.approx(0.02 / np.sqrt(4), rel=0.12)
    assert Cause.POINT_NOISE not in rows


def test_sweep_planes_are_carried_with_their_covariance():
    covariance = np.zeros((6, 6))
    covariance[5, 5] = 1e-14  # π_z of sweep 1: δz = −z² δπ_z, common to all of its points
    rows = u_of(mean_depth(stripe_cloud(1, sigma=0.03), PointErrors(covariance)))
    assert rows[Cause.SWEEP_PLANES] == pytest.approx(500**2 * 1e-7, rel=1e-6)
    rows = u_of(mean_depth(stripe_cloud(0), PointErrors(covariance)))
    assert rows[Cause.SWEEP_PLANES] == 0


def test_correlated_sweeps_do_not_average_out():
    both = join([stripe_cloud(0, sigma=0.03), stripe_cloud(1, sigma=0.03, v=20.0)])

    def of_planes(correlation):
        covariance = np.zeros((6, 6))
        covariance[2, 2] = covariance[5, 5] = 1e-14
        covariance[2, 5] = covariance[5, 2] = correlation * 1e-14
        return u_of(mean_depth(both, PointErrors(covariance)))[Cause.SWEEP_PLANES]

    assert of_planes(0.0) == pytest.approx(0.025 / np.sqrt(2), rel=1e-6)
    assert of_planes(1.0) == pytest.approx(0.025, rel=1e-6)


def test_the_planes_share_of_sigma_is_not_counted_twice():
    covariance = np.zeros((3, 3))
    covariance[2, 2] = (0.015 / 500**2) ** 2
    rows = mean_depth(stripe_cloud(0, sigma=0.025), PointErrors(covariance, correlation_px=0.5))
    assert u_of(rows)[Cause.POINT_NOISE] == pytest.approx(0.02 / 10, rel=1e-3)  # √(0.025² − 0.015²) = 0.020
    assert combined(rows) == pytest.approx(np.hypot(0.002, 0.015), rel=1e-3)


def test_a_sweep_without_covariance_is_a_mistake():
    with pytest.raises(ValueError, match="holds 1 sweeps"):
        mean_depth(stripe_cloud(1), PointErrors(np.zeros((3, 3))))


CAMERA_PARAMETERS = np.array([2500.0, 2500.0, 0.0, 50.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
FLAT = np.array([0.0, 0.0, 1 / 500])


def common(*depths):
    """Calibrations with which every point of `stripe_cloud` lies deeper by so many mm, all of them called "camera"."""
    pis = np.array([[[0.0, 0.0, 1 / (500 + deeper)]] for deeper in (0.0, *depths)])
    return CommonErrors((100, 100), ("camera",) * len(depths), [CAMERA_PARAMETERS] * len(pis), pis, pis)


def test_a_calibrations_displacements_add_in_squares_and_never_average_out():
    rows = u_of(mean_depth(stripe_cloud(0), PointErrors(common=common(0.03, -0.04))))
    assert rows[Cause.CAMERA] == pytest.approx(0.05, rel=1e-6)
    assert common(0.03, -0.04).sigma(stripe_cloud(0)) == pytest.approx(np.full(100, 0.05), rel=1e-6)


def test_points_of_the_fan_and_of_the_sweeps_are_displaced_with_their_own_planes():
    fans = np.array([[FLAT, FLAT], [[0.0, 0.0, 1 / 501], [0.0, 0.0, 1 / 502]]])
    sweeps = np.array([[FLAT, FLAT], [[0.0, 0.0, 1 / 503], [0.0, 0.0, 1 / 504]]])
    errors = CommonErrors((100, 100), ("camera",), [CAMERA_PARAMETERS] * 2, fans, sweeps)
    (change,) = errors.changes(np.zeros((4, 2)), np.array([FAN, FAN - 1, 0, 1]))
    assert change[:, 2] == pytest.approx([1.0, 2.0, 3.0, 4.0])


def test_what_is_not_flat_is_found_from_the_residuals():
    rng = np.random.default_rng(0)
    cloud = join([stripe_cloud(i, v=20.0 * i) for i in range(200)])
    patch = np.minimum(cloud.sweep // 4, 49)
    bumps = rng.normal(0, 0.05, 50)
    noise = np.repeat(rng.normal(0, 0.02, (200, 10)), 10, axis=1).ravel()
    face = np.zeros(len(cloud), dtype=np.int64)
    errors = PointErrors(correlation_px=10.0)
    sources = Sources.of(cloud, np.array([0.0, 0.0, 1.0]), np.ones(len(cloud)), face, patch, errors)
    design = np.ones((len(sources.own), 1))
    bumpy = generalised_fit(design, sources.mean(noise + bumps[patch]), sources)
    assert bumpy.form_mm == pytest.approx(bumps.std(), rel=0.15)
    row = u_of(budget(bumpy.gains[0], sources, own=bumpy.own, form_mm=bumpy.form_mm))[Cause.FORM]
    assert row == pytest.approx(0.05 / np.sqrt(50), rel=0.25)
    flat = generalised_fit(design, sources.mean(noise), sources)
    assert flat.form_mm < 0.003


def test_own_noise_larger_than_stated_is_counted_as_large_as_it_is():
    rng = np.random.default_rng(1)
    cloud = join([stripe_cloud(i, v=20.0 * i) for i in range(100)])
    noise = np.repeat(rng.normal(0, 0.05, (100, 10)), 10, axis=1).ravel()  # stated: 0.02
    face = np.zeros(len(cloud), dtype=np.int64)
    errors = PointErrors(correlation_px=10.0)
    sources = Sources.of(cloud, np.array([0.0, 0.0, 1.0]), np.ones(len(cloud)), face, face, errors)
    fit = generalised_fit(np.ones((len(sources.own), 1)), sources.mean(noise), sources)
    assert np.median(fit.own) == pytest.approx(0.05, rel=0.1)


def leaning_faces(change_mm):
    """A face seen by fan stripes of small noise; an assumed change lifts it and tilts it, and a measured one alike."""
    rng = np.random.default_rng(3)
    cloud = join([stripe_cloud(i, v=20.0 * i) for i in range(60)])
    face = np.zeros(len(cloud), dtype=np.int64)
    direction = np.array([0.0, 0.0, 1.0])
    sources = Sources.of(cloud, direction, np.ones(len(cloud)), face, face, PointErrors(correlation_px=10.0))
    along = np.linspace(-1, 1, len(sources.own))
    acting = change_mm * (1 + along)[:, None]
    return sources, acting, rng.normal(0, sources.own)


def with_common(sources, acting, *, assumed):
    none, one = np.zeros(1, dtype=bool), np.full(1, assumed)
    return replace(sources, common=acting, unexplained=none, assumed=one)


def test_what_is_only_assumed_raises_the_noise_of_a_result_by_a_fifth_at_most():
    """Its tilt would show an assumed change, and the fit would follow the tilt's noise to take it out."""
    sources, acting, misfit = leaning_faces(0.5)
    design = np.ones((len(sources.own), 1))
    alone = generalised_fit(design, misfit, with_common(sources, 0 * acting, assumed=False))
    measured = generalised_fit(design, misfit, with_common(sources, acting, assumed=False))
    assumed = generalised_fit(design, misfit, with_common(sources, acting, assumed=True))

    def noise(fit):
        return float(np.linalg.norm(fit.gains[0] * fit.own))

    assert noise(measured) > 1.5 * noise(alone)
    assert noise(alone) < noise(assumed) <= 1.2001 * noise(alone)


def test_what_is_assumed_to_be_small_takes_part_whole():
    sources, acting, misfit = leaning_faces(1e-4)
    design = np.ones((len(sources.own), 1))
    measured, assumed = (
        generalised_fit(design, misfit, with_common(sources, acting, assumed=one)) for one in (False, True)
    )
    assert assumed.gains == pytest.approx(measured.gains, rel=0.02)
