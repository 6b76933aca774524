"""How a surface bends, from noisy points of a ball, a pin and a table."""

import numpy as np
import pytest

from core.scan.surface.bends import bends_of
from tests.inspect.shape_scan import BALL, BALL_RADIUS, PIN_AXIS, PIN_RADIUS, ShapeScan

SIZE = (1920, 1374)


@pytest.fixture(scope="module")
def shapes():
    scan = ShapeScan(spacing_px=6.0)
    bends = bends_of(scan.measure(np.random.default_rng(1), noise=0.02), SIZE)
    return scan, bends.at(scan.points)


def test_a_ball_bends_by_its_radius_whichever_way_and_up_to_its_rim(shapes):
    scan, (normals, curvature) = shapes
    on = (scan.on == 0) & normals.any(axis=1)
    assert np.mean(on[scan.on == 0]) > 0.9
    turned = np.degrees(np.arccos(np.clip((normals * scan.normals).sum(axis=1)[on], -1, 1)))
    assert np.median(turned) < 0.5
    bend = np.trace(curvature[on], axis1=1, axis2=2) / 2
    assert np.median(bend) * BALL_RADIUS == pytest.approx(1.0, abs=0.05)
    slanting = np.abs(normals[on] @ (BALL / np.linalg.norm(BALL))) < 0.7
    assert np.median(bend[slanting]) * BALL_RADIUS == pytest.approx(1.0, abs=0.1)


def test_a_cylinder_bends_about_its_axis_only(shapes):
    scan, (normals, curvature) = shapes
    on = (scan.on == 1) & normals.any(axis=1)
    around = np.cross(scan.normals[on], PIN_AXIS)
    bend = np.einsum("ni,nij,nj->n", around, curvature[on], around)
    along = np.einsum("i,nij,j->n", PIN_AXIS, curvature[on], PIN_AXIS)
    assert np.median(bend) * PIN_RADIUS == pytest.approx(1.0, abs=0.1)
    assert np.median(np.abs(along)) * PIN_RADIUS < 0.1


def test_noise_does_not_bend_a_flat_face(shapes):
    scan, (_, curvature) = shapes
    table = scan.on == 2
    away = np.linalg.norm(scan.points - scan.points[~table].mean(axis=0), axis=1) > 60
    size = np.sqrt((curvature[table & away] ** 2).sum(axis=(1, 2)))
    assert np.mean(size == 0) > 0.95
    assert size.max(initial=0.0) < 0.01
