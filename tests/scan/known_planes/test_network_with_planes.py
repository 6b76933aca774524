from dataclasses import replace

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.model import LightPlane
from core.scan.known_planes.known_plane import Control
from core.scan.known_planes.points_on_planes import PlaneAgreement, lying_on, points_on_planes
from core.scan.network.adjustment import solve_network
from core.scan.network.datum import free_directions
from tests.scan.known_planes.planes_on_paper import CORNER, PLACES, board, scan_on_paper
from tests.scan.network.test_adjustment import all_depth_errors
from tests.scan.synthetic import CAMERA


def solved(scan, control=None):
    return solve_network(scan.table, scan.geometry, scan.line, control or scan.control, len(scan.truth))


def test_two_planes_alone_locate_every_sweep():
    scan = scan_on_paper(1, count=50)
    errors, _ = all_depth_errors(solved(scan), scan.truth)
    assert np.sqrt(np.mean(errors**2)) < 0.005
    assert np.median(np.abs(errors)) < 0.004


@pytest.mark.accuracy
@pytest.mark.parametrize("with_fan", [False, True])
def test_depth_errors_agree_with_their_stated_sigma(with_fan):
    squares = []
    for seed in range(20):
        scan = scan_on_paper(seed, count=20, with_fan=with_fan)
        errors, sigma = all_depth_errors(solved(scan), scan.truth)
        squares.append(np.mean((errors / sigma) ** 2))
    assert 0.9 < np.sqrt(np.mean(squares)) < 1.1


@pytest.mark.accuracy
def test_planes_displaced_by_what_they_are_uncertain_complete_the_sigma():
    squares, without = [], []
    for seed in range(20):
        scan = scan_on_paper(seed, count=12, sd_mm=0.02)
        here = solved(scan)
        errors, sigma = all_depth_errors(here, scan.truth)
        variance = sigma**2
        for k, plane in enumerate(scan.control.planes):
            for step in plane.factor.T:
                planes = list(scan.control.planes)
                planes[k] = plane.displaced(step)
                there = solved(scan, Control(scan.control.fan, tuple(planes)))
                variance = variance + (all_depth_errors(there, scan.truth)[0] - errors) ** 2
        squares.append(np.mean(errors**2 / variance))
        without.append(np.mean((errors / sigma) ** 2))
    assert 0.85 < np.sqrt(np.mean(squares)) < 1.15
    assert np.sqrt(np.mean(without)) > 2


def test_one_plane_leaves_one_direction_of_three_and_two_none():
    for planes, missing in ((CORNER[:1], 1), (CORNER, 0)):
        scan = scan_on_paper(2, planes, count=10)
        on_plane = scan.table.on_plane
        rays = scan.geometry.rays[on_plane]
        pis = scan.control.pis_at(scan.line[on_plane], rays)
        assert free_directions(rays, np.einsum("mi,mi->m", rays, pis)) == missing
    assert free_directions(np.zeros((0, 3)), np.zeros(0)) == 3


def test_a_plane_beside_the_fan_makes_sweeps_no_worse():
    with_plane, alone = [], []
    for seed in range(6):
        scan = scan_on_paper(seed, CORNER[:1], with_fan=True, sd_mm=0.02)
        with_plane.append(np.sqrt(np.mean(all_depth_errors(solved(scan), scan.truth)[0] ** 2)))
        keep = ~scan.table.on_plane
        fan = replace(scan, table=scan.table.select(keep), line=scan.line[keep])
        alone.append(np.sqrt(np.mean(all_depth_errors(solved(fan, scan.control.fan), scan.truth)[0] ** 2)))
    assert np.median(with_plane) < np.median(alone)


def test_a_part_before_the_board_and_its_print_are_left_out():
    planes = [LightPlane.from_normal([0.05, 0.64, 0.77], 400.0)]  # as a part 20 mm before it, over a third of it
    scan = scan_on_paper(3, CORNER[:1], count=10)
    part = scan_on_paper(3, planes, count=10, boards=[board(planes[0], 0, place=((10.0, 10.0), (1900.0, 150.0)))])
    frames = tuple(
        replace(one, centrelines=(*(_below(line, 160.0) for line in one.centrelines), *other.centrelines))
        for one, other in zip(scan.features.frames, part.features.frames, strict=True)
    )
    features = replace(scan.features, frames=frames)
    marks = np.zeros(CAMERA.image_size[::-1], dtype=bool)
    marks[200:260] = True
    plane = replace(scan.control.planes[0], marks=marks)
    rows, number = points_on_planes(features, [plane], CAMERA)
    assert len(rows) > 20
    assert set(number.tolist()) == {0}
    off = np.einsum("mi,mi->m", CAMERA.rays(rows.uv), scan.truth[rows.a] - CORNER[0].pi) * 500**2
    assert np.abs(off).max() < 0.05  # mm
    assert not np.any(marks[np.rint(rows.uv[:, 1]).astype(int), np.rint(rows.uv[:, 0]).astype(int)])
    assert rows.uv[:, 1].max() < PLACES[0][1][1]


def _below(line: Centreline, v: float) -> Centreline:
    return line.select(line.uv[:, 1] > v)


def test_points_on_a_board_are_those_within_its_outline_and_near_its_plane():
    known = scan_on_paper(1, CORNER[:1], count=4).control.planes[0]
    fit = PlaneAgreement(known.name, 1, 1, 0, 0.0, known.pi, known.outline)
    uv = np.array([[500.0, 200.0], [500.0, 200.0], [500.0, 1300.0]])
    rays = CAMERA.rays(uv)
    points = rays / (rays @ known.pi)[:, None] * np.array([[1.0], [0.99], [1.0]])
    assert lying_on(points, uv, [fit]).tolist() == [True, False, False]
