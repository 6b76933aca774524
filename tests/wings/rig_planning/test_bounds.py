"""The bounds of a plan: piece by piece against other ways to the same figure, and against what is planned."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import DEFAULT_STABILITY, changes
from core.image.stripes.noise import NoiseModel
from core.image.stripes.speckle import NO_SPECKLE, Speckle
from core.image.targets import Checkerboard, CircleGrid
from core.model import Fan, LightPlane
from core.simulate.scene.scene import Sphere
from core.wings.rig_planning.prediction.bounds import bounds_of
from core.wings.rig_planning.prediction.information import (
    Sensing,
    change_covariance,
    covariance,
    eliminated,
    flat_stripe,
    round_stripe,
)
from core.wings.rig_planning.prediction.light_bounds import crossing_bound, edge_density, point_bound, stripe_density
from core.wings.rig_planning.prediction.light_lines import LitLine, lit_ball
from core.wings.rig_planning.prediction.scanning import Stage
from core.wings.rig_planning.prediction.seen_stripes import SeenStripes
from tests.image import bound
from tests.image import crossing_bound as other
from tests.wings.rig_planning.small import SMALL

NOISE = NoiseModel(0.9, 1 / 16)


@pytest.mark.parametrize(
    ("width", "height", "contrast"), [(1.3, 60, 0.0), (2.5, 150, 0.0), (1.6, 120, 0.18), (2.5, 30, 0.5)]
)
def test_the_bound_of_a_stripe_is_the_bound_calculators(width, height, contrast):
    speckle = Speckle(contrast, 1.8) if contrast else NO_SPECKLE
    seen = np.hypot(width, np.sqrt(1 / 12))  # there the pixel's area comes on top
    ours = stripe_density(seen, height * width / seen, 25.0, NOISE, speckle)

    assert ours == pytest.approx(bound.bound_per_root_px(bound.Stripe(width, height, 25.0), NOISE, speckle), rel=0.01)


@pytest.mark.parametrize("degrees", [90, 45, 20])
def test_the_bound_of_a_crossing_is_the_bound_calculators(degrees):
    angle = np.radians(degrees)
    ours = crossing_bound(0.05, 0.08, 120.0, angle)

    assert ours == pytest.approx(
        other.crossing_bound(other.Line(0.05, -60, 60), other.Line(0.08, -60, 60), angle), rel=1e-3, abs=1e-9
    )


def test_an_edge_is_found_as_well_as_its_bound_says():
    """By least squares with the true weights; place, height and background unknown."""
    rng, x, blur = np.random.default_rng(1), np.arange(-8, 9.0), 1.2
    places = rng.uniform(-0.5, 0.5, 4000)
    errors = []
    for place in places:
        levels = 20 + 150 * norm.cdf((x - place) / blur)
        sd = np.sqrt(NOISE.variance(levels))
        design = np.column_stack([-150 * norm.pdf((x - place) / blur) / blur, levels - 20, np.ones_like(x)])
        errors.append(np.linalg.lstsq(design / sd[:, None], rng.standard_normal(len(x)), rcond=None)[0][0])

    assert np.std(errors) == pytest.approx(edge_density(150.0, 20.0, blur, NOISE), rel=0.06)


def test_a_corner_is_the_crossing_of_its_edges():
    corner = crossing_bound(0.05, 0.05, 10.0 * 4.0, np.pi / 2)

    assert point_bound(Checkerboard(9, 7, 10.0), 0.05, 4.0) == pytest.approx(np.sqrt(corner[0, 0]))
    assert point_bound(CircleGrid(9, 7, 10.0), 0.05, 4.0) == pytest.approx(0.05 / np.sqrt(np.pi * 5.0 / 2 * 4.0))


def test_unknowns_are_eliminated_as_a_covariance_forgets_them():
    root = np.random.default_rng(2).normal(size=(20, 7))
    information = root.T @ root

    assert covariance(eliminated(information, 3)) == pytest.approx(np.linalg.inv(information)[:4, :4])


@pytest.fixture(scope="module")
def sensing():
    return Sensing.of(SMALL, speckle=True)


@pytest.fixture(scope="module")
def sheet():
    return SMALL.sweeps_over(SMALL.scene(50.0), seed=1)[7]


def offsets(line: LitLine, uv: np.ndarray) -> np.ndarray:
    """How far across a stripe the curve through `uv` lies at its points."""
    off = uv[None] - line.uv[:, None]
    along = np.einsum("nmi,ni->nm", off, np.column_stack([-line.normal[:, 1], line.normal[:, 0]]))
    across = np.einsum("nmi,ni->nm", off, line.normal)
    order = np.argsort(along, axis=1)
    return np.array([np.interp(0.0, a[o], n[o]) for a, n, o in zip(along, across, order, strict=True)])


INNER = slice(10, -10)
"""The ends of a stripe run out when it moves."""


def told(information: np.ndarray, step: np.ndarray, line: LitLine) -> float:
    """RMS offset in px that an information matrix for N0 = 1 says a step of the unknowns makes along a line."""
    return float(np.sqrt(step @ information @ step / len(line)))


def test_a_flat_stripe_moves_in_the_picture_as_its_information_says(sensing, sheet):
    stage = Stage(SMALL, 50.0)
    whole = max(stage.lines([sheet], SeenStripes.of_hand(SMALL)), key=len)
    line = whole.select(INNER)
    face = stage.faces[line.face]
    tau = face.normal / (face.normal @ face.corners[0])
    size = sensing.unknowns
    by = np.zeros((6, size + 6))
    by[:, size:] = np.eye(6)
    information = flat_stripe(sensing, line, 1.0, sheet.plane.pi, tau, by)
    for number, share in ((0, 2e-4), (2, 2e-4), (4, -2e-4)):
        step = np.zeros(size + 6)
        step[size + number] = share * np.abs(tau).max()
        pi, surface = sheet.plane.pi + step[size : size + 3], tau + step[size + 3 :]
        # the cut of both planes, point by point the nearest to the old one
        system = np.stack(
            [
                np.broadcast_to(pi, (len(whole), 3)),
                np.broadcast_to(surface, (len(whole), 3)),
                np.gradient(whole.points, axis=0),
            ],
            axis=1,
        )
        known = np.column_stack([np.ones((len(whole), 2)), np.einsum("ni,ni->n", system[:, 2], whole.points)])
        moved = sensing.camera.project(np.linalg.solve(system, known[..., None])[..., 0])
        seen = np.sqrt(np.mean(offsets(line, moved) ** 2))
        assert told(information, step, line) == pytest.approx(seen, rel=0.03)


def test_a_longer_focal_length_moves_a_stripe_as_its_information_says(sensing, sheet):
    stage = Stage(SMALL, 50.0)
    whole = max(stage.lines([sheet], SeenStripes.of_hand(SMALL)), key=len)
    line = whole.select(INNER)
    face = stage.faces[line.face]
    tau = face.normal / (face.normal @ face.corners[0])
    information = flat_stripe(sensing, line, 1.0, sheet.plane.pi, tau, np.zeros((6, sensing.unknowns)))
    step = np.zeros(sensing.unknowns)
    step[[0, 1, 4]] = 2.0, 2.0, 0.3
    other_camera = camera_of(parameters_of(sensing.camera) + np.append(step[:9], 0.0), sensing.camera.image_size)
    seen = np.sqrt(np.mean(offsets(line, other_camera.project(whole.points)) ** 2))

    assert told(information, step, line) == pytest.approx(seen, rel=0.03)


def test_a_round_stripe_moves_in_the_picture_as_its_information_says(sensing):
    scene = SMALL.ball(50.0)
    (ball,) = scene.spheres
    sheets = SMALL.sweeps_over(scene, seed=1)
    sheet = min(sheets, key=lambda one: abs(float(one.plane.distances(ball.centre[None])[0])))
    rig = SMALL.rig()
    (whole,) = lit_ball(sheet, ball, -1, rig.camera, rig.blur_px)
    line = whole.select(INNER)
    size = sensing.unknowns
    by = np.zeros((7, size + 7))
    by[:, size:] = np.eye(7)
    information = round_stripe(sensing, line, 1.0, sheet.plane.pi, ball.centre, by)
    for change in ([0.2, 0, 0, 0], [0, 0, 0.2, 0], [0, 0, 0, 0.2]):
        step = np.zeros(size + 7)
        step[size + 3 :] = change
        larger = Sphere(ball.centre + change[:3], ball.radius + change[3])
        (moved,) = lit_ball(sheet, larger, -1, rig.camera, rig.blur_px)
        seen = np.sqrt(np.mean(offsets(line, moved.uv) ** 2))
        assert told(information, step, line) == pytest.approx(seen, rel=0.1)
    step = np.zeros(size + 7)
    step[size] = 2e-4 * np.abs(sheet.plane.pi).max()
    (moved,) = lit_ball(
        replace(sheet, plane=LightPlane(sheet.plane.pi + step[size : size + 3])), ball, -1, rig.camera, rig.blur_px
    )
    assert told(information, step, line) == pytest.approx(np.sqrt(np.mean(offsets(line, moved.uv) ** 2)), rel=0.1)


@pytest.fixture(scope="module")
def bounds():
    return {str(one.quantity): one for one in bounds_of(SMALL, (50.0,))}


def test_speckle_costs_and_the_part_is_known_less_well_than_with_perfect_calibrations(bounds):
    assert all(one.with_speckle >= one.without for one in bounds.values())
    whole, alone = bounds["thickness of 50 mm"], bounds["thickness of 50 mm, camera and fan known"]
    assert 0 < alone.with_speckle < whole.with_speckle
    assert 0 < alone.without < whole.without


def test_planes_of_the_fan_are_as_unsure_as_the_rigs_changes_move_them(sensing):
    stability = DEFAULT_STABILITY.times(2.0, 0.5, 1.0, 3.0)
    found = change_covariance(sensing, stability)
    fan = Fan(tuple(LightPlane(pi) for pi in sensing.fan.pis))
    moved = [one.fan.pis - fan.pis for one in changes(sensing.camera, fan)]
    expected = sum(share**2 * np.outer(by, by) for share, by in zip(stability.over_default, moved, strict=True))
    planes = sensing.fan.jacobian @ found[9:, 9:] @ sensing.fan.jacobian.T
    assert planes == pytest.approx(expected, rel=1e-3, abs=1e-6 * np.abs(expected).max()), "a pencil stays one"
    assert np.sqrt(np.diag(found)[[3, 4]]) == pytest.approx(stability.centre_px)
    assert np.sqrt(found[0, 0]) == pytest.approx(stability.focal_share * sensing.camera.focal, rel=1e-3)


def test_what_may_have_changed_since_the_calibration_costs_and_a_check_of_the_day_saves_most_of_it(bounds):
    rows = {str(one.quantity): one for one in bounds_of(SMALL, (50.0,), stability=DEFAULT_STABILITY)}
    assert {name: rows[name] for name in bounds} == bounds, "the others stay as they are"
    still = bounds["thickness of 50 mm"].with_speckle
    unchecked = rows["thickness of 50 mm, changed since the calibration and not checked"].with_speckle
    checked = rows["thickness of 50 mm, changed and checked by 3 pictures"].with_speckle
    assert still < checked < 0.9 * unchecked
    assert checked - still < 0.5 * (unchecked - still)


@pytest.mark.accuracy
def test_four_times_the_poses_and_views_halve_the_calibrations_bounds(bounds):
    more = bounds_of(replace(SMALL, poses=4 * SMALL.poses, views=4 * SMALL.views), (50.0,))
    ratios = {str(one.quantity): one.with_speckle / bounds[str(one.quantity)].with_speckle for one in more}
    assert ratios["focal length"] == pytest.approx(0.5, abs=0.12)
    assert ratios["depth on the fan's lines, from camera and fan"] == pytest.approx(0.5, abs=0.15)
    assert ratios["thickness of 50 mm, camera and fan known"] == pytest.approx(1.0)
