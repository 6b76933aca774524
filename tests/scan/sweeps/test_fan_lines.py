import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.image.stripes.extraction import extract_centrelines
from core.image.stripes.noise import estimate_noise
from core.image.stripes.settings import choose_settings
from core.model import LightPlane
from core.scan.sweeps.fan_lines import UNASSIGNED, FanLines, possible_fan_lines, settle_by_sweeps
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario
from tests.scan.synthetic import CAMERA, FAN, TABLE


def stripe(line: int, face: LightPlane, x_range: tuple[float, float], fan=FAN) -> Centreline:
    """The light of one fan line on a face, between two values of x in mm."""
    pi = fan.planes[line].pi
    direction = np.cross(pi, face.pi)
    direction /= direction[0]
    start = np.linalg.lstsq(np.array([pi, face.pi]), np.ones(2), rcond=None)[0]
    x = np.arange(*x_range, 0.3)
    points = start + (x - start[0])[:, None] * direction
    uv = CAMERA.project(points)
    tangent = np.gradient(uv, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    flat = np.full(len(uv), 0.05)
    return Centreline(uv, normal, flat, flat, flat, np.zeros(len(uv), bool))


def raised(height: float) -> LightPlane:
    return LightPlane.from_normal(TABLE.normal, TABLE.d_mm - height)


@pytest.mark.accuracy
@pytest.mark.parametrize(("thing", "height"), [("block", 40), ("block", 70), ("narrow-block", 50), ("steps", 50)])
def test_every_stretch_on_a_rendered_part_can_get_its_line(thing, height):
    stage, _, _ = scan_of(Scenario(object=thing, height_mm=height, scale=0.5, frames=2))
    picture = stage.reference().astype(np.float32)
    pieces = extract_centrelines(picture, choose_settings(picture, 255.0), noise=estimate_noise(picture))
    camera, fan = stage.rig.camera, stage.rig.fan
    truth = []
    for piece in pieces:
        u, v = piece.uv.astype(int).T
        misfit = np.abs(camera.rays(piece.uv) @ fan.pis.T - 1 / stage.maps.depth[v, u][:, None])
        truth.append(int(np.argmin(np.median(misfit, axis=0))))
    assert len(pieces) >= 8
    assert truth in [list(lines.line) for lines in possible_fan_lines(pieces, camera, fan)]


def with_two_lines_on_the_block() -> list[Centreline]:
    pieces = [stripe(line, TABLE, x) for line in range(3) for x in ((-150, -40), (40, 150))]
    return pieces + [stripe(line, raised(50.0), (-35, 35)) for line in (0, 1)]


def test_the_sweeps_decide_where_the_order_leaves_a_choice():
    pieces = with_two_lines_on_the_block()
    rays = np.concatenate([CAMERA.rays(piece.uv[::40]) for piece in pieces[6:]])
    piece = np.repeat([6, 7], [len(p.uv[::40]) for p in pieces[6:]])
    open_on_the_block = FanLines(
        (0, 0, 1, 1, 2, 2, 1, 2), ("",) * 8, (*((k,) for k in (0, 0, 1, 1, 2, 2)), (0, 1), (1, 2))
    )
    settled = settle_by_sweeps(open_on_the_block, piece, rays, rays @ raised(50.0).pi, FAN)
    assert settled.line == (0, 0, 1, 1, 2, 2, 0, 1)


def test_a_reflection_beside_three_lines_is_left_out():
    pieces = [stripe(line, TABLE, (-150, 150)) for line in range(3)]
    ghost = stripe(1, raised(-12.0), (-20, 5))
    for lines in possible_fan_lines([*pieces, ghost], CAMERA, FAN):
        assert lines.line == (0, 1, 2, UNASSIGNED)
        assert "reflection" in str(lines.reason[3])


def test_one_line_needs_no_numbering():
    single = type(FAN)((FAN.planes[1],))
    assert possible_fan_lines([stripe(1, TABLE, (-50, 50))], CAMERA, single)[0].line == (0,)
