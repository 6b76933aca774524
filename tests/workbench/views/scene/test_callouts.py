"""Plates of words beside the surface: where they stand, that they stay at their places, and how they are dragged."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt

from tests.workbench.views.scene.test_view import FLAT, complete, drag, ready, view
from workbench.views.scene.callouts import lay_out
from workbench.views.scene.contents import Callout

__all__ = ["ready", "view"]

ROOM = QRectF(4, 26, 640, 480)
GOOD = ("mdi6.check-decagram", "good")


def laid(places, *, moved=None, room=ROOM, kept=(), size=(150.0, 34.0)):
    places = np.array(places, float)
    return lay_out(places, np.tile(size, (len(places), 1)), moved or [None] * len(places), room, kept)


def callout(name, place, **more):
    return Callout(name, np.array(place, float), f"{name} flatness", "0.050 ± 0.012 mm", GOOD, **more)


@pytest.fixture
def called(view, qtbot):
    view.set_cloud(FLAT, colours="#808080")
    view.view("top")
    view.set_callouts([callout("left", (-20, 0, 500)), callout("right", (20, 0, 500))])
    complete(view, qtbot)
    return view


def seen(view):
    return {one.name: (at, plate) for one, at, plate in view.visible_callouts()}


def test_plates_of_places_side_by_side_hide_neither_each_other_nor_a_place():
    places = [(300 + 9 * k, 250 + 5 * k) for k in range(8)]
    plates = laid(places)
    assert not any(a.intersects(b) for a, b in combinations(plates, 2))
    assert not any(plate.contains(QPointF(*place)) for plate in plates for place in places)
    assert all(ROOM.contains(plate) for plate in plates)


def test_where_there_is_no_room_for_all_none_is_hidden_whole():
    plates = laid([(100 + k, 60) for k in range(6)], room=QRectF(0, 0, 330, 150))
    corners = {(plate.left(), plate.top()) for plate in plates}
    assert len(corners) == len(plates)


def test_a_moved_plate_stays_where_it_was_put_and_others_give_way():
    free = laid([(300, 250), (310, 250)])
    offset = free[1].center() - QPointF(300, 250)
    plates = laid([(300, 250), (310, 250)], moved=[(offset.x(), offset.y()), None])
    assert plates[0] == free[1] and not plates[0].intersects(plates[1])


def crossings(places, plates):
    lines = [(np.array(place), nearest(plate, place)) for place, plate in zip(places, plates, strict=True)]
    return sum(crossing(*a, *b) for a, b in combinations(lines, 2))


def nearest(plate, place):
    low, high = (plate.left(), plate.top()), (plate.right(), plate.bottom())
    return np.clip(np.array(place, float), low, high)


def crossing(a, b, c, d):
    def side(p, q, r):
        return np.sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


@pytest.mark.parametrize(("count", "most"), [(2, 0), (3, 0), (8, 5)])
def test_where_two_lines_cross_the_plates_change_places(count, most):
    """Of as many as eight close together a pair is left now and then; without an exchange some forty are."""
    rng = np.random.default_rng(3)
    room, crossed = QRectF(4, 26, 900, 640), 0
    for _ in range(20):
        places = (450, 340) + rng.normal(scale=(40, 30), size=(count, 2))
        sizes = np.column_stack([rng.uniform(110, 200, count), np.full(count, 34.0)])
        plates = lay_out(places, sizes, [None] * count, room, [])
        crossed += crossings(places, plates)
        assert not any(a.intersects(b) for a, b in combinations(plates, 2))
        assert all(room.contains(plate) for plate in plates)
        assert_allclose([(plate.width(), plate.height()) for plate in plates], sizes)
    assert crossed <= most


def test_no_plate_lies_under_the_handle(called):
    free = seen(called)["left"][1].center()
    at = called.screen_positions([[-20, 0, 500]])[0]
    called.view("top")
    per_mm = called.screen_positions([[-19, 0, 500]])[0] - at
    across = (free.x() - at[0]) / per_mm[0]
    up = called.screen_positions([[-20, 1, 500]])[0][1] - at[1]
    place = (-20 + across, (free.y() - at[1]) / up, 500.0)
    assert_allclose(called.screen_positions([place])[0], free.toTuple(), atol=1.0)
    called.set_handle((place, (1.0, 0, 0)))
    assert not any(plate.adjusted(-9, -9, 9, 9).contains(free) for _, plate in seen(called).values())


def test_plates_leave_free_what_else_is_written_there():
    corner = QRectF(0, 400, 200, 120)
    assert not any(plate.intersects(corner) for plate in laid([(150, 380), (170, 390)], kept=[corner]))


def test_a_plate_points_at_its_place_however_the_view_is_turned(called):
    for name in ("top", "iso", "front"):
        called.view(name)
        places = called.screen_positions([[-20, 0, 500], [20, 0, 500]])
        shown = seen(called)
        assert_allclose([shown["left"][0].toTuple(), shown["right"][0].toTuple()], places)


def test_out_of_sight_a_place_has_no_plate(called):
    called.hide_side(((0.0, 0, 500), (1.0, 0, 0)))
    assert list(seen(called)) == ["left"]


@pytest.mark.parametrize("name", ["light", "dark"])
def test_plates_are_painted_over_the_scene_in_either_theme(called, theme, name, qtbot):
    theme(name)
    complete(called, qtbot)
    plate = seen(called)["right"][1]
    ratio = called.devicePixelRatioF()
    rows = slice(*(int(ratio * y) for y in (plate.top(), plate.bottom())))
    inside = called.picture()[rows, int(ratio * plate.left()) : int(ratio * plate.right())].astype(int)
    ground, ink = called.palette().window().color().lightness(), called.palette().windowText().color().lightness()
    assert abs(np.median(inside) - ground) < 25, "the ground of the theme"
    assert np.abs(inside - ink).min() < 40, "and its text"


def test_a_dragged_plate_keeps_its_distance_from_its_place_and_the_view_stands_still(called, qtbot):
    moved = []
    called.callout_moved.connect(lambda *told: moved.append(told))
    before, (at, plate) = called.screen_positions(FLAT[:5]), seen(called)["right"]
    start = plate.center().toPoint()
    drag(called, qtbot, [start.toTuple(), (start + QPoint(20, 30)).toTuple(), (start + QPoint(60, 90)).toTuple()])
    assert_allclose(called.screen_positions(FLAT[:5]), before)
    _, now = seen(called)["right"]
    assert_allclose((now.center() - plate.center()).toTuple(), (60, 90), atol=1)
    offset = (now.center() - at).toTuple()
    assert [one[0] for one in moved] == ["right"], "told once, when it is let go"
    assert_allclose(moved[-1][1], offset)
    called.pan(-30, 10)
    at, now = seen(called)["right"]
    assert_allclose((now.center() - at).toTuple(), offset, atol=1e-6)


def test_a_double_click_puts_a_plate_back_and_a_click_tells_which_it_was(called, qtbot):
    free = seen(called)["right"][1]
    called.set_callouts([callout("left", (-20, 0, 500)), callout("right", (20, 0, 500), moved=(90.0, 140.0))])
    at = seen(called)["right"][1].center().toPoint()
    canvas = called.focusProxy()
    with qtbot.waitSignal(called.callout_chosen, check_params_cb=lambda name: name == "right"):
        qtbot.mouseClick(canvas, Qt.MouseButton.LeftButton, pos=at)
    with qtbot.waitSignal(called.callout_moved, check_params_cb=lambda name, to: to is None):
        qtbot.mouseDClick(canvas, Qt.MouseButton.LeftButton, pos=at)
    assert seen(called)["right"][1] == free


def test_the_cursor_tells_what_can_be_dragged(called, qtbot):
    canvas = called.focusProxy()
    qtbot.mouseMove(canvas, seen(called)["right"][1].center().toPoint())
    qtbot.waitUntil(lambda: canvas.cursor().shape() is Qt.CursorShape.OpenHandCursor)
    qtbot.mouseMove(canvas, QPoint(5, 300))
    qtbot.waitUntil(lambda: canvas.cursor().shape() is Qt.CursorShape.ArrowCursor)
