"""A scan solved again with its stripes where the light planes cut the surface."""

from dataclasses import replace

import numpy as np
import pytest

from core.image.stripes.runs import arc_length
from core.inspect.fit.round import sphere_through
from core.scan.bend_correction import corrected_for_bends, reconstruct_twice
from core.scan.features.bent_crossings import BentLine, crossed_again
from core.scan.features.straightening import straightened
from core.scan.method import ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.surface.sections import LARGEST_SHIFT
from core.scan.sweeps.fan_lines import FanLines
from core.simulate.scenario import Scenario
from tests.accuracy.lit_scan import lit
from tests.accuracy.sphere_bound import FAINT
from tests.scan.centreline_scan import ExactScan, Noise

SPHERE = Scenario(object="sphere", height_mm=50.0, seed=11, scale=0.5, frames=30)


@pytest.fixture(scope="module")
def scans():
    exact = ExactScan.of(SPHERE)
    noise = Noise.of_twin(0.5)
    faint = Noise(FAINT * noise.sweep_px, FAINT * noise.fan_px, noise.correlation_px)
    features = lit(exact).measured(1, faint)
    camera, fan, lines = exact.rig.camera, exact.rig.fan, FanLines.settled_as(exact.fan_line)
    first = reconstruct(features, camera, fan, fan_lines=lines)
    return exact, (features, first), corrected_for_bends(features, first, camera, fan)


def _diameter_error(exact, scan):
    """By least squares over the points that the rim's σ does not make useless."""
    (sphere,) = exact.scene.spheres
    on = np.abs(np.linalg.norm(scan.cloud.points - sphere.centre, axis=1) - sphere.radius) < 0.3
    return 2 * (sphere_through(scan.cloud.points[on]).radius - sphere.radius)


@pytest.mark.accuracy
def test_a_ball_that_wide_light_makes_too_small_has_its_diameter_when_solved_again(scans):
    exact, (_, first), even = scans
    lines = FanLines.settled_as(exact.fan_line)
    second = reconstruct(even, exact.rig.camera, exact.rig.fan, fan_lines=lines)
    assert _diameter_error(exact, first) < -0.03
    assert abs(_diameter_error(exact, second)) < 0.01


@pytest.mark.accuracy
def test_stripes_move_towards_their_light_planes_on_the_ball_and_stay_on_the_table(scans):
    exact, (features, _), even = scans
    (sphere,) = exact.scene.spheres
    before, after = [], []
    for frame, moved, curves in zip(features.frames, even.frames, exact.sweeps, strict=True):
        for line, again, curve in zip(frame.centrelines, moved.centrelines, curves, strict=True):
            step = np.linalg.norm(again.uv - line.uv, axis=1)
            if abs(np.linalg.norm(curve.points[0] - sphere.centre) - sphere.radius) > 0.1:
                assert np.median(step) == 0
                continue
            assert (step <= LARGEST_SHIFT * line.width + 1e-9).all()
            for uv, into in ((line.uv, before), (again.uv, after)):
                into.extend(((uv - curve.uv) * curve.normal).sum(axis=1))
    assert np.median(np.abs(after)) < 0.5 * np.median(np.abs(before))


def test_what_is_moved_is_less_sure(scans):
    _, (features, _), even = scans
    for line, again in zip(features.fan, even.fan, strict=True):
        step = np.linalg.norm(again.uv - line.uv, axis=1)
        assert (again.sigma[step > 1e-3] > line.sigma[step > 1e-3]).all()


def test_a_flat_part_is_solved_once_and_nothing_of_it_moves():
    exact = ExactScan.of(Scenario(scale=0.25, frames=30))
    features = exact.measured(1)
    even, _ = reconstruct_twice(features, exact.rig.camera, exact.rig.fan)
    assert even is features


def test_by_the_paper_s_method_a_ball_is_solved_once(scans):
    exact, (features, _), _ = scans
    options = ReconstructOptions(method="three-crossings")
    even, _ = reconstruct_twice(features, exact.rig.camera, exact.rig.fan, options)
    assert even is features


def test_crossings_on_a_bend_lie_where_the_averaged_lines_meet(scans):
    """Wherever they were found before, and as sure as these lines are."""
    exact, (features, _), _ = scans
    table = features.crossings
    lines = {
        (frame, piece): BentLine(line, _arc(line, exact.rig.camera), np.ones(len(line), dtype=bool))
        for frame, pieces in ((-1, features.fan), *((one.index, one.centrelines) for one in features.frames))
        for piece, line in enumerate(pieces)
    }
    again = crossed_again(table, lines)
    assert np.linalg.norm(again.uv - table.uv, axis=1).max() < 0.1
    off = table.uv + 0.3 * table.tangent_a
    back = crossed_again(replace(table, uv=off, sigma_a=table.sigma_a + 1.0), lines)
    assert np.abs(back.uv - again.uv).max() < 1e-2
    assert back.sigma_a == pytest.approx(again.sigma_a, rel=1e-3)
    flat = {name: line._replace(bent=np.zeros(len(line.line), dtype=bool)) for name, line in lines.items()}
    assert crossed_again(table, flat).uv.tobytes() == table.uv.tobytes()


def _arc(line, camera):
    return arc_length(straightened((line,), camera)[0].uv)
