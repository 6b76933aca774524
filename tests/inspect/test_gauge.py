"""Thickness, its uncertainty and its verdict on synthetic scans with known truth."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.inspect.causes import Cause
from core.inspect.faces import FacePair
from core.inspect.free_faces import free_faces
from core.inspect.gauge import RULE, fit_gauge, measure_gauge
from core.inspect.uncertainty.coverage import coverage_factor, effective_dof
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.common_errors import CommonErrors
from core.scan.network.fan_speckle import FanSpeckle
from tests.inspect.block_scan import CENTRE, FOCAL, NORMAL, TABLE_MM, BlockScan, pixels, square

STRETCH_PX = 13.0  # six points of the synthetic stripes share their noise


@pytest.fixture(scope="module")
def scan():
    return BlockScan(height=50.0, sweeps=18)


def faces(scan):
    return FacePair(np.flatnonzero(scan.upper), np.flatnonzero(~scan.upper))


def rows(result):
    return {row.source: row.u_mm for row in result.budget}


@pytest.mark.parametrize("height", [20.0, pytest.param(50.0, marks=pytest.mark.accuracy)])
def test_thickness_found_without_being_told_where(height):
    scan = BlockScan(height=height, sweeps=40)
    cloud = scan.measure(np.random.default_rng(0), outliers=0.05)
    result = measure_gauge(cloud, errors=scan.errors())
    assert result.thickness_mm == pytest.approx(height, abs=0.03)
    assert abs(result.thickness_mm - height) < 3 * result.u_mm
    assert result.rule == RULE
    assert result.parallelism < 0.005
    assert result.points_used[0] > 1000


def test_thickness_in_polygons():
    scan = BlockScan(height=50.0, sweeps=40)
    cloud = scan.measure(np.random.default_rng(1), outliers=0.1)
    result = measure_gauge(cloud, regions=scan.polygons, errors=scan.errors())
    assert abs(result.thickness_mm - 50) < 3 * result.u_mm


def test_faces_exchanged_are_said(scan):
    cloud = scan.measure(np.random.default_rng(2))
    upper, _ = scan.polygons
    beside = square(TABLE_MM, 14.0) + [0.0, 240.0]
    with pytest.raises(InputError, match=r"behind the lower one.*exchange"):
        fit_gauge(cloud, regions=(beside, upper))


@pytest.mark.accuracy
@pytest.mark.parametrize("plane_errors", [False, True], ids=["point noise", "sweep planes too"])
def test_stated_uncertainty_is_the_scatter_over_scans(scan, plane_errors):
    rng = np.random.default_rng(3)
    results = [
        measure_gauge(
            scan.measure(rng, plane_errors=plane_errors, noise=0.02),
            regions=faces(scan),
            errors=scan.errors(plane_errors=plane_errors),
        )
        for _ in range(40)
    ]
    thickness = np.array([result.thickness_mm for result in results])
    stated = np.sqrt(np.mean([result.u_mm**2 for result in results]))
    assert stated == pytest.approx(thickness.std(), rel=0.2)
    assert thickness.mean() == pytest.approx(50.0, abs=4 * thickness.std() / np.sqrt(40))
    if plane_errors:
        assert rows(results[0])[Cause.SWEEP_PLANES] > 0.3 * rows(results[0])[Cause.POINT_NOISE]
    else:
        assert rows(results[0])[Cause.SWEEP_PLANES] == 0


def test_points_that_share_errors_weigh_less_than_points_that_do_not(scan):
    rng = np.random.default_rng(3)
    fits = [fit_gauge(scan.measure(rng, noise=0.02), regions=faces(scan), errors=scan.errors()) for _ in range(12)]
    independent = np.array([fit.robust.thickness for fit in fits])
    generalised = np.array([fit.thickness_mm for fit in fits])
    assert generalised.std() < 0.6 * independent.std()


def test_faces_fitted_beside_each_other_are_those_fitted_alone(scan):
    cloud, errors = scan.measure(np.random.default_rng(4), noise=0.02), scan.errors()
    fit = fit_gauge(cloud, regions=faces(scan), errors=errors)
    alone = free_faces(cloud, fit.pair, lambda: fit.planes, errors, tilt_determined=True)
    for beside, face in zip((fit.upper, fit.lower), alone, strict=True):
        assert np.array_equal(beside.plane.pi, face.plane.pi)
        assert beside.flatness_mm == face.flatness_mm


def test_a_joint_fit_that_fails_is_told(scan):
    cloud, errors = scan.measure(np.random.default_rng(4), noise=0.02), scan.errors(plane_errors=True)
    short = replace(errors, sweep_covariance=errors.sweep_covariance[:-3, :-3])
    with pytest.raises(ValueError, match="the covariance holds 17 sweeps"):
        fit_gauge(cloud, regions=faces(scan), errors=short)


class SharedSpeckle:
    """Cells of the fan's lines that move its own points and, by their mean on each face, all sweeps of a scan."""

    def __init__(self, scan, size=30, noise=0.04):
        self.scan = scan
        of_fan = np.flatnonzero(scan.sweep < 0)
        stripe = np.unique(np.column_stack([scan.sweep, scan.upper])[of_fan], axis=0, return_inverse=True)[1]
        cell = np.unique(stripe * 10_000 + np.arange(len(of_fan)) // size, return_inverse=True)[1].reshape(-1)
        upper = np.array([scan.upper[of_fan[cell == c][0]] for c in range(cell.max() + 1)])
        moved = np.zeros((*scan.pis.shape, len(upper)))
        for face, level, other in (
            (upper, TABLE_MM - scan.height, TABLE_MM),
            (~upper, TABLE_MM, TABLE_MM - scan.height),
        ):
            # π_i − π of the other face moves nothing there, and here by −z²·r·(π_i − π) = −z·(1 − level/other).
            depth = np.median(scan.points[scan.upper == (level < TABLE_MM), 2])
            per_cell = -noise / face.sum() / (depth * (1 - level / other))
            moved += (scan.pis - NORMAL / other)[:, :, None] * np.where(face, per_cell, 0.0)
        self.noise, self.cell, self.of_fan = noise, cell, of_fan
        self.covariance = moved.reshape(-1, len(upper))
        self.known = FanSpeckle(
            pixels(scan.points[of_fan]), cell, np.bincount(cell), cell, np.full((len(cell), 1), noise), self.covariance
        )

    def measure(self, rng):
        scan, z = self.scan, rng.normal(size=self.covariance.shape[1])
        shift = np.zeros(len(scan.points))
        shift[self.of_fan] = self.noise * z[self.cell]
        swept = scan.sweep >= 0
        of_planes = (self.covariance @ z).reshape(-1, 3)[scan.sweep[swept]]
        shift[swept] = -scan.points[swept, 2] * (scan.points[swept] * of_planes).sum(axis=1)
        cloud = scan.measure(rng, noise=0.004, shift=shift)
        return replace(cloud, sigma=np.where(swept, cloud.sigma, self.noise))

    def errors(self, speckle):
        covariance = self.scan.covariance + self.covariance @ self.covariance.T
        return PointErrors(covariance, None, STRETCH_PX, 60.0, speckle)


@pytest.mark.accuracy
def test_sweeps_that_hang_on_the_fans_speckle_do_not_make_the_thickness_surer_than_it_is(scan):
    shared, rng = SharedSpeckle(scan), np.random.default_rng(5)
    clouds = [shared.measure(rng) for _ in range(40)]

    def errors_over_u(speckle):
        each = [measure_gauge(cloud, regions=faces(scan), errors=shared.errors(speckle)) for cloud in clouds]
        assert all(Cause.SWEEP_PLANES in rows(one) and Cause.FAN_SPECKLE in rows(one) for one in each)
        return np.sqrt(np.mean([((one.thickness_mm - scan.height) / one.u_mm) ** 2 for one in each]))

    assert errors_over_u(shared.known) == pytest.approx(1.0, abs=0.22)
    assert errors_over_u(None) > 1.3


def test_form_error_appears_in_the_budget(scan):
    flat = np.abs(scan.points @ np.array([0.05, 0.25, 1.0]))  # any smooth coordinate will do
    wave = 0.05 * np.sin(2 * np.pi * scan.points[:, 0] / 35.0 + 0.1 * flat)
    plain = scan.measure(np.random.default_rng(4), plane_errors=False)
    wavy = scan.measure(np.random.default_rng(4), plane_errors=False, shift=np.where(scan.upper, wave, 0.0))
    settings = {"regions": faces(scan), "errors": scan.errors(plane_errors=False)}
    assert rows(measure_gauge(plain, **settings))[Cause.FORM] < 0.0015
    waved = measure_gauge(wavy, **settings)
    assert rows(waved)[Cause.FORM] > 0.002
    form = next(row for row in waved.budget if row.source == Cause.FORM)
    assert 3 < form.dof < 500  # patches, not points, say how rough the faces are
    assert waved.k == pytest.approx(coverage_factor(effective_dof(waved.budget)), abs=0.005)
    assert waved.k > 2
    assert waved.upper.flatness_mm > 1.3 * waved.lower.flatness_mm


def test_parallelism_is_the_angle_of_the_free_fits(scan):
    flat = scan.points[:, 0]
    tilted = scan.measure(
        np.random.default_rng(6), plane_errors=False, noise=1e-4, shift=np.where(scan.upper, 0.002 * flat, 0.0)
    )
    assert measure_gauge(tilted, regions=faces(scan)).parallelism == pytest.approx(0.002, rel=0.15)


def test_calibration_terms_and_verdicts(scan):
    cloud = scan.measure(np.random.default_rng(7))
    base = measure_gauge(cloud, regions=faces(scan), errors=scan.errors())
    common = scan.common_errors(camera=1.0004, fan=1.0002)
    full = measure_gauge(
        cloud, regions=faces(scan), errors=scan.errors(common=common), nominal_mm=50.0, tolerance_mm=0.2
    )
    # No flatness of a face can tell a scale: it arrives in full.
    assert rows(full)[Cause.CAMERA] == pytest.approx(0.0004 * 50, rel=0.02)
    assert rows(full)[Cause.FAN_CALIBRATION] == pytest.approx(0.0002 * 50, rel=0.02)
    assert full.u_mm == pytest.approx(np.sqrt(sum(u**2 for u in rows(full).values())))
    assert full.U_mm == pytest.approx(2 * full.u_mm)
    assert full.u_mm > base.u_mm
    assert full.verdict == "conforming"
    assert full.notes == ()
    assert base.verdict == ""
    off = measure_gauge(cloud, regions=faces(scan), errors=scan.errors(), nominal_mm=49.0, tolerance_mm=0.2)
    assert off.verdict == "not conforming"
    assert off.deviation_mm == pytest.approx(1.0, abs=0.03)
    unsure = measure_gauge(
        cloud, regions=faces(scan), errors=scan.errors(common=common), nominal_mm=50.0, tolerance_mm=0.01
    )
    assert unsure.verdict == "not proven"


def test_what_the_uncertainty_does_not_hold_proves_nothing(scan):
    cloud, known = scan.measure(np.random.default_rng(7)), scan.errors()
    lacking = {
        "without_sweeps": replace(known, sweep_covariance=None, speckle=None),
        "without_speckle": replace(known, speckle=None),
        "without_camera": replace(known, common=scan.common_errors(fan=1.0)),
        "without_fan": replace(known, common=scan.common_errors(camera=1.0)),
    }
    for missing, errors in lacking.items():
        for nominal_mm in (50.0, 49.0):
            found = measure_gauge(cloud, regions=faces(scan), errors=errors, nominal_mm=nominal_mm, tolerance_mm=0.2)
            (note,) = [one for one in found.notes if one.code == "inspection.missing_in_u"]
            assert [one.code for one in note.values["missing"]] == [f"gauge.{missing}"]
            assert found.verdict == "not proven"


def test_an_error_that_would_bend_the_faces_is_told_by_their_flatness(scan):
    """A displaced sweep cannot hide where the other stripes lie: little of it arrives in the thickness."""
    camera = [FOCAL, FOCAL, 0.0, *CENTRE, 0.0, 0.0, 0.0, 0.0, 0.0]
    shifted = scan.fan_pis + np.array([[0.0, 0.0, 2e-7], [0.0, 0.0, -2e-7], [0.0, 0.0, 2e-7]])
    pis = [scan.pis, scan.pis]
    common = CommonErrors((1920, 1374), ("fan",), [camera] * 2, [scan.fan_pis, shifted], pis)
    cloud = scan.measure(np.random.default_rng(9))
    row = next(
        row
        for row in measure_gauge(cloud, regions=faces(scan), errors=scan.errors(common=common)).budget
        if row.source == Cause.FAN_CALIBRATION
    )
    assert row.u_mm < 0.1 * common.sigma(cloud)[cloud.sweep < 0].max()


def test_every_row_says_how_much_of_a_typical_points_error_arrives(scan):
    result = measure_gauge(scan.measure(np.random.default_rng(8)), regions=faces(scan), errors=scan.errors())
    for row in result.budget:
        assert row.point_mm is not None
        assert row.sensitivity is None or row.sensitivity == pytest.approx(row.u_mm / row.point_mm)
    noise = next(row for row in result.budget if row.source == Cause.POINT_NOISE)
    assert noise.point_mm == pytest.approx(0.015, rel=0.15)
    assert noise.sensitivity < 0.2  # hundreds of stretches are averaged
