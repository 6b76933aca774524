"""Each contribution against a case that can be worked out by hand."""

import numpy as np
import pytest

from core.inspect.conformity import decide
from core.inspect.remeasure import calibration_changes, principal_deviations
from core.inspect.uncertainty import FAN_SPECKLE, POINT_NOISE, SWEEP_PLANES, combined, point_contributions
from core.model import Camera, Fan, LightPlane
from core.scan.cloud import FAN, Cloud


def stripe_cloud(sweep, count=100, sigma=0.02, v=0.0):
    """`count` points one pixel apart on a horizontal stripe in front of a pinhole camera, z = 500 mm."""
    u = np.arange(count, dtype=float)
    uv = np.column_stack([u, np.full(count, v)])
    points = np.column_stack([(uv - 50) / 2500 * 500, np.full(count, 500.0)])
    index = np.full(count, sweep)
    return Cloud(points, uv, np.full(count, sigma), np.ones(count), index, index, np.zeros((count, 3)))


def mean_depth(count):
    """Gradient of the mean depth of `count` points."""
    return np.tile([0.0, 0.0, 1.0 / count], (count, 1))


def test_noise_correlated_over_a_stretch_averages_over_stretches():
    (row,) = point_contributions(stripe_cloud(0), mean_depth(100), correlation_px=10.0)
    assert row.source == POINT_NOISE
    assert row.u_mm == pytest.approx(0.02 / np.sqrt(10), rel=0.06)
    (row,) = point_contributions(stripe_cloud(0), mean_depth(100), correlation_px=0.5)
    assert row.u_mm == pytest.approx(0.02 / np.sqrt(100), rel=1e-6)


def test_fan_points_have_their_own_length():
    (row,) = point_contributions(stripe_cloud(FAN - 1), mean_depth(100), correlation_px=1.0, speckle_px=25.0)
    assert row.source == FAN_SPECKLE
    assert row.u_mm == pytest.approx(0.02 / np.sqrt(4), rel=0.12)


def test_sweep_planes_are_carried_with_their_covariance():
    covariance = np.zeros((6, 6))
    covariance[5, 5] = 1e-14  # π_z of sweep 1: δz = −z² δπ_z, common to all of its points
    rows = {
        row.source: row.u_mm
        for row in point_contributions(stripe_cloud(1), mean_depth(100), sweep_covariance=covariance)
    }
    assert rows[SWEEP_PLANES] == pytest.approx(500**2 * 1e-7, rel=1e-9)
    rows = {
        row.source: row.u_mm
        for row in point_contributions(stripe_cloud(0), mean_depth(100), sweep_covariance=covariance)
    }
    assert rows[SWEEP_PLANES] == 0


def test_correlated_sweeps_do_not_average_out():
    first, second = stripe_cloud(0), stripe_cloud(1, v=20.0)
    both = Cloud(
        *(np.concatenate([getattr(c, n) for c in (first, second)]) for n in ("points", "uv", "sigma", "intensity")),
        np.repeat([0, 1], 100),
        np.repeat([0, 1], 100),
        np.zeros((200, 3)),
    )

    def u_of(correlation):
        covariance = np.zeros((6, 6))
        covariance[2, 2] = covariance[5, 5] = 1e-14
        covariance[2, 5] = covariance[5, 2] = correlation * 1e-14
        return point_contributions(both, mean_depth(200), sweep_covariance=covariance)[1].u_mm

    assert u_of(0.0) == pytest.approx(0.025 / np.sqrt(2), rel=1e-9)
    assert u_of(1.0) == pytest.approx(0.025, rel=1e-9)


def test_the_planes_share_of_sigma_is_not_counted_twice():
    covariance = np.zeros((3, 3))
    covariance[2, 2] = (0.015 / 500**2) ** 2
    rows = point_contributions(
        stripe_cloud(0, sigma=0.025), mean_depth(100), sweep_covariance=covariance, correlation_px=0.5
    )
    assert rows[0].u_mm == pytest.approx(0.02 / 10, rel=1e-6)  # √(0.025² − 0.015²) = 0.020
    assert combined(rows) == pytest.approx(np.hypot(0.002, 0.015), rel=1e-6)


def test_a_sweep_without_covariance_is_a_mistake():
    with pytest.raises(ValueError, match="holds 1 sweeps"):
        point_contributions(stripe_cloud(1), mean_depth(100), sweep_covariance=np.zeros((3, 3)))


def test_principal_deviations_add_up_to_the_covariance():
    rng = np.random.default_rng(0)
    scale = np.array([3.0, 3.0, 0.0, 1.0, 1e-3, 1e-4])
    factor = scale[:, None] * rng.normal(size=(6, 6))
    covariance = factor @ factor.T
    deviations = principal_deviations(covariance)
    assert deviations.T @ deviations == pytest.approx(covariance, rel=1e-6, abs=1e-12)
    assert len(deviations) == 5
    assert principal_deviations(np.zeros((4, 4))).shape == (0, 4)


def test_measuring_again_gives_the_first_order_variance():
    camera = Camera((1920, 1374), np.array([[2495.0, 0, 960], [0, 2495, 687], [0, 0, 1]]))
    factor = np.diag([2.0, 3.0, 0.0, 1.0, 1.0, 0, 0, 0, 0, 0])
    factor[1, 0] = 2.0
    fan_factor = 1e-7 * np.arange(9.0).reshape(3, 3)
    fan = Fan((LightPlane(np.array([1e-3, 0, 2e-3])),), fan_factor @ fan_factor.T)

    def measure(camera, fan):
        return 0.01 * camera.matrix[0, 0] - 0.02 * camera.matrix[1, 1] + 1e4 * fan.pis[0, 2]

    of_camera, of_fan = calibration_changes(measure, camera, factor @ factor.T, fan)
    slope = np.array([0.01, -0.02])
    assert of_camera @ of_camera == pytest.approx(slope @ (factor @ factor.T)[:2, :2] @ slope, rel=1e-6)
    assert of_fan @ of_fan == pytest.approx(1e8 * (fan_factor @ fan_factor.T)[2, 2], rel=1e-6)


@pytest.mark.parametrize(
    ("deviation", "U", "verdict"),
    [
        (0.0, 0.1, "conforming"),
        (-0.1, 0.1, "conforming"),
        (0.11, 0.1, "not proven"),
        (-0.29, 0.1, "not proven"),
        (0.31, 0.1, "not conforming"),
        (-0.21, 0.0, "not conforming"),
        (0.0, 0.3, "not proven"),
    ],
)
def test_decision_rule(deviation, U, verdict):
    assert decide(deviation, 0.2, U) == verdict


@pytest.mark.parametrize(("deviation", "tolerance", "U"), [(0.0, 0.0, 0.1), (0.0, -1.0, 0.1), (float("nan"), 0.2, 0.1)])
def test_no_decision_without_numbers(deviation, tolerance, U):
    with pytest.raises(ValueError, match="no decision"):
        decide(deviation, tolerance, U)
