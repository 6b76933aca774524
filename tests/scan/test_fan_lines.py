import numpy as np

from core.image.centreline import Centreline
from core.model import LightPlane
from core.scan.fan_lines import UNASSIGNED, assign_fan_lines, settle_by_sweeps
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


def test_every_stretch_on_table_and_block_gets_its_line():
    for height in (40.0, 50.0, 60.0, 70.0):
        pieces, truth = [], []
        for line in range(3):
            for face, x in ((TABLE, (-150, -38)), (raised(height), (-35, 35)), (TABLE, (38, 150))):
                pieces.append(stripe(line, face, x))
                truth.append(line)
        order = np.random.default_rng(int(height)).permutation(len(pieces))
        lines = assign_fan_lines([pieces[i] for i in order], CAMERA, FAN)
        assert list(lines.line) == [truth[i] for i in order]


def with_two_lines_on_the_block() -> list[Centreline]:
    pieces = [stripe(line, TABLE, x) for line in range(3) for x in ((-150, -40), (40, 150))]
    return pieces + [stripe(line, raised(50.0), (-35, 35)) for line in (0, 1)]


def test_a_stretch_missing_on_the_block_leaves_only_the_block_unsure():
    lines = assign_fan_lines(with_two_lines_on_the_block(), CAMERA, FAN)
    assert lines.line[:6] == (0, 0, 1, 1, 2, 2)
    assert lines.sure.line[6:] == (UNASSIGNED, UNASSIGNED)


def test_the_sweeps_decide_where_the_order_leaves_a_choice():
    pieces = with_two_lines_on_the_block()
    lines = assign_fan_lines(pieces, CAMERA, FAN)
    rays = np.concatenate([CAMERA.rays(piece.uv[::40]) for piece in pieces[6:]])
    piece = np.repeat([6, 7], [len(p.uv[::40]) for p in pieces[6:]])
    settled = settle_by_sweeps(lines, piece, rays, rays @ raised(50.0).pi, FAN)
    assert settled.line == (0, 0, 1, 1, 2, 2, 0, 1)


def test_a_reflection_beside_three_lines_is_left_out():
    pieces = [stripe(line, TABLE, (-150, 150)) for line in range(3)]
    ghost = stripe(1, raised(-12.0), (-20, 5))
    lines = assign_fan_lines([*pieces, ghost], CAMERA, FAN)
    assert lines.line == (0, 1, 2, UNASSIGNED)
    assert "reflection" in lines.reason[3]


def test_one_line_needs_no_numbering():
    single = type(FAN)((FAN.planes[1],))
    assert assign_fan_lines([stripe(1, TABLE, (-50, 50))], CAMERA, single).line == (0,)
