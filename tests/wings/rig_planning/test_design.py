from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.simulate.rig import paper_rig
from core.simulate.scenario import Scenario
from core.simulate.scene.stage import build_scene
from core.wings.rig_planning.prediction.design import Design


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_what_is_not_said_is_the_papers_rig(scale):
    planned = Design(pixels=(round(3840 * scale), round(2748 * scale)), pixel_um=1.67 / scale).rig()
    paper = paper_rig(scale)

    assert np.allclose(planned.camera.matrix, paper.camera.matrix, rtol=1e-5, atol=1e-2)
    assert np.allclose(planned.fan.pis, paper.fan.pis, rtol=1e-4, atol=1e-7)
    assert np.allclose(planned.fan_emitter, paper.fan_emitter, atol=1e-3)
    assert planned.blur_px == pytest.approx(paper.blur_px)
    assert planned.grain_px == pytest.approx(paper.grain_px)


def test_the_block_stands_where_the_twin_stands_it():
    ours = Design().scene(50.0)
    theirs, _ = build_scene(Scenario(height_mm=50.0))

    assert np.allclose(ours.meshes[0].triangles, theirs.meshes[0].triangles)


@pytest.mark.parametrize("change", [{"baseline_mm": 95.0}, {"angle_deg": 8.0}, {"distance_mm": 700.0}, {"lines": 4}])
def test_a_changed_fan_still_is_a_pencil_over_the_middle_of_the_work(change):
    design = replace(Design(), **change)
    fan = design.fan()

    assert fan.lines == design.lines
    assert np.degrees(fan.angles) == pytest.approx(design.angle_deg)
    assert np.linalg.matrix_rank(fan.pis - fan.pis.mean(axis=0), tol=1e-9) == 1
    on_both_sides = fan.pis @ design.work_point - 1
    assert on_both_sides.min() <= 1e-9 and on_both_sides.max() >= -1e-9


def test_a_longer_baseline_lets_light_planes_meet_rays_at_larger_angles():
    def sine(design):
        plane, ray = design.fan().planes[1], design.work_point
        return abs(plane.normal @ ray) / np.linalg.norm(ray)

    assert sine(replace(Design(), baseline_mm=90.0)) > 1.2 * sine(Design())


def test_distance_and_focal_length_set_the_scale_of_the_picture():
    near, far = Design(), replace(Design(), distance_mm=1120.0, focal_mm=2 * Design().focal_mm)

    assert far.focal_px == pytest.approx(2 * near.focal_px)
    assert far.table().translation[2] == 1120.0
    assert far.camera().project([far.work_point])[0] == pytest.approx(
        2 * near.camera().project([near.work_point])[0] - near.camera().matrix[:2, 2], rel=0.02
    )


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"pixel_um": 0.0}, "pixel_um"),
        ({"views": 2}, "views"),
        ({"pixels": (10, 10)}, "pixels"),
        ({"heights_mm": ()}, "heights_mm"),
        ({"heights_mm": (500.0,)}, "above the table"),
    ],
)
def test_an_impossible_quantity_is_told_by_name_with_what_to_do(change, named):
    with pytest.raises(InputError, match=named) as told:
        replace(Design(), **change)
    assert "rig.toml" in str(told.value)


def test_a_baseline_that_puts_a_plane_through_the_camera_is_refused():
    with pytest.raises(InputError, match="baseline_mm"):
        replace(Design(), angle_deg=30.0, lines=5).fan()
