"""How well the fan fixes the scale: stated from the covariance, and true."""

from dataclasses import replace

import numpy as np
import pytest

from core.model import LightPlane
from core.scan.method import ReconstructOptions
from core.scan.network.datum import datum_of, main_plane, note_on_datum
from core.scan.reconstruct import reconstruct
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.locate import by_sweep, locate_together
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactCrossings, ExactScan


def datum(scan, seed=1):
    exact = ExactCrossings.of(scan)
    return solved_datum(exact, seed)[0]


def solved_datum(exact, seed):
    sweeps = locate_together(exact.drawn(seed), exact.line, exact.scan.rig.camera, exact.scan.rig.fan)
    table = by_sweep(exact.table, sweeps.frames)
    return datum_of(sweeps.pis, sweeps.covariance, table, exact.scan.rig.camera), sweeps


@pytest.mark.accuracy
def test_more_relief_fixes_the_scale_better():
    found = [datum(ExactScan.of(Scenario(height_mm=height, scale=0.5))) for height in (10.0, 25.0, 60.0)]
    assert found[0].scale > 1.5 * found[1].scale > 2.5 * found[2].scale
    assert [one.relief_mm for one in found] == pytest.approx([10.0, 25.0, 60.0], rel=0.1)
    assert all(one.depth_mm < 0.03 for one in found)


def test_a_block_under_the_fan_needs_no_advice():
    scan = ExactScan.of(Scenario(scale=0.35))
    result = reconstruct(scan.measured(1), scan.rig.camera, scan.rig.fan)
    assert not result.datum.weak
    assert result.datum.scale < 0.001
    sentence = f"The relief under the fan fixes the scale to {100 * result.datum.scale:.2g} %."
    assert sentence in map(str, result.notes)


def test_a_flat_scene_is_told_that_the_fan_meets_no_relief():
    scan = ExactScan.of(Scenario(object="plane", scale=0.5))
    result = reconstruct(scan.measured(1), scan.rig.camera, scan.rig.fan)
    assert result.datum.weak
    assert result.datum.depth_mm < 0.05  # its place is known all the same
    told = " ".join(map(str, result.notes))
    assert "Nothing fixes the scale of heights. The fan meets no relief: let it cross part and table." in told
    assert "a second pair of faces: outline those of the part" in told


def test_sweeps_that_run_alike_are_named_and_not_the_relief_that_the_fan_has():
    """Parallel sweeps on the table beside a block: the fan crosses block and table."""
    scenario = Scenario(scale=0.35, frames=16)
    first = ExactScan.of(scenario)
    up, foot = first.scene.pose_cam_table.rotation[:, 2], first.scene.pose_cam_table.translation
    along = np.cross(up, np.cross(first.sheets[0].plane.normal, up))
    along /= np.linalg.norm(along)
    steps = np.linspace(-90.0, 90.0, scenario.frames)
    sheets = [replace(first.sheets[0], plane=moved(first.sheets[0], step * along)) for step in steps]
    sheets = [replace(one, emitter=one.emitter + step * along) for one, step in zip(sheets, steps, strict=True)]
    scan = ExactScan.of(scenario, sheets=tuple(sheets))
    on_table = tuple(tuple(c for c in curves if np.all((c.points - foot) @ up < 1.0)) for curves in scan.sweeps)
    scan = replace(scan, sweeps=on_table)
    options = ReconstructOptions(sigma_cut_mm=1e6)
    result = reconstruct(scan.measured(1), scan.rig.camera, scan.rig.fan, options, fan_lines=lines_of(scan))
    assert result.datum.weak
    assert result.datum.tilt < np.radians(5)
    told = " ".join(map(str, result.notes))
    assert "The sweeps run alike: tilt the laser to and fro by 30°." in told
    assert "relief" not in told


def moved(sheet, shift):
    """The light plane of a sheet shifted by so many mm."""
    normal = sheet.plane.normal
    return LightPlane.from_normal(normal, sheet.plane.d_mm + normal @ shift)


def lines_of(scan):
    return FanLines.settled_as(scan.fan_line)


def test_few_sweeps_across_low_relief_are_weak():
    scan = ExactScan.of(Scenario(height_mm=6.0, scale=0.25, frames=14))
    found = datum(scan)
    assert found.weak
    assert "is fixed only to" in str(note_on_datum(found, 6.0))
    assert "Too few sweeps cross the fan at different heights" in str(note_on_datum(found, 6.0))


@pytest.mark.accuracy
def test_the_stated_scale_is_that_of_repeated_scans():
    """The block's height, 50 mm, from the sweeps' planes alone, on 60 scans."""
    exact = ExactCrossings.of(ExactScan.of(Scenario(scale=0.5)))
    scan, stated, found = exact.scan, [], []
    up, foot = scan.scene.pose_cam_table.rotation[:, 2], scan.scene.pose_cam_table.translation
    frame, rays, top = [], [], []
    for index, curves in enumerate(scan.sweeps):
        for curve in curves:
            if np.ptp(curve.points @ up) < 0.1:  # on a level face
                some = scan.rig.camera.rays(curve.uv[::40])
                frame.append(np.full(len(some), index))
                rays.append(some)
                top.append(np.full(len(some), (curve.points[0] - foot) @ up > 25))
    frame, rays, top = (np.concatenate(parts) for parts in (frame, rays, top))
    for seed in range(60):
        datum, sweeps = solved_datum(exact, seed)
        place = np.searchsorted(sweeps.frames, frame)
        pis = sweeps.pis[place]
        blocks = np.array([sweeps.covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(len(sweeps.frames))])
        weight = 1 / np.einsum("ni,nij,nj->n", rays, blocks[place], rays)
        heights = (rays / np.einsum("ni,ni->n", rays, pis)[:, None] - foot) @ up
        means = [np.average(heights[side], weights=weight[side]) for side in (top, ~top)]
        found.append((means[0] - means[1]) / 50 - 1)
        stated.append(datum.scale)
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(np.mean(stated), rel=0.25)


@pytest.mark.parametrize("count", [1, 2])
def test_a_plane_goes_through_fewer_points_than_three(count):
    rays = np.array([[0.1, 0.2, 1.0], [-0.2, 0.1, 1.0]])[:count]
    inverse_depths = np.array([0.002, 0.0021])[:count]
    plane, on_it = main_plane(rays, inverse_depths)
    assert rays @ plane == pytest.approx(inverse_depths)
    assert on_it.all()
