"""The 3D view: what it shows, from where, what is chosen in it, and what it does where there is no 3D."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QGuiApplication, QImage, QMouseEvent, QPainter, QPalette
from PySide6.QtWidgets import QApplication, QFileDialog, QMainWindow, QStackedWidget, QWidget
from pyvistaqt import QtInteractor

from core.errors import InputError
from core.inspect.shown.view_frame import CAMERA_FRAME, FRAME_NAMES, FrameKind, ViewFrame
from core.model import Pose
from tests.workbench.views.scene.test_view_numbers import crossing_number
from tests.workbench.watchdog import LIMIT_MS, Watchdog
from workbench.views.layouts import in_column
from workbench.views.scene import drawing, overlay
from workbench.views.scene import ready as ready_module
from workbench.views.scene import view as view_module
from workbench.views.scene.buttons import SceneButtons
from workbench.views.scene.contents import Scene
from workbench.views.scene.ready import Readiness, readiness
from workbench.views.scene.view import Colouring, SceneView

RED, LEFT = "#ff0000", Qt.MouseButton.LeftButton
RNG = np.random.default_rng(3)
FLAT = np.column_stack([*(RNG.random((2, 4000)) * 100 - 50), np.full(4000, 500.0)])
UPRIGHT = ViewFrame(FrameKind.PART, Pose(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.zeros(3)))
"""z up in the camera's picture."""
PART = ViewFrame(FrameKind.PART, Pose.from_vector([2.9, 0.3, -0.1, 12.0, -7.0, 490.0]))
"""Tilted against the camera, z towards it."""
SPARSE = np.array([[x, y, 500.0] for y in (-30, -10, 10, 30) for x in (-40, -20, 0, 20, 40)])


@pytest.fixture
def ready(qapp, qtbot) -> Readiness:
    """3D can be drawn here, and its libraries are there."""
    found = readiness()
    found.find_out()
    qtbot.waitUntil(lambda: found.kind is not None, timeout=30_000)
    if found.kind == "none":
        pytest.skip("no off-screen rendering here")
    return found


@pytest.fixture
def unknown(qapp, monkeypatch) -> Readiness:
    """Nothing is known yet about 3D."""
    made = Readiness(qapp)
    monkeypatch.setattr(ready_module, "_readiness", [made])
    return made


@pytest.fixture
def view(ready, qtbot) -> Iterator[SceneView]:
    made = SceneView()
    qtbot.addWidget(made)
    made.resize(700, 520)
    made.set_axes(False)
    made.show()
    qtbot.waitExposed(made)
    made.activateWindow()
    qtbot.waitUntil(made.isActiveWindow)
    yield made
    made.close()


def complete(view: SceneView, qtbot) -> None:
    qtbot.waitUntil(lambda: view.state().complete, timeout=20_000)


def test_a_cloud_given_before_the_view_is_first_shown_is_seen(ready, qtbot):
    pages, view = QStackedWidget(), SceneView()
    qtbot.addWidget(pages)
    for page in (QWidget(), view):
        pages.addWidget(page)
    pages.resize(500, 400)
    pages.show()
    qtbot.waitExposed(pages)
    view.set_cloud(FLAT, colours=RED)
    pages.setCurrentWidget(view)
    complete(view, qtbot)
    qtbot.wait(300)
    embedded = view.state().kind == "embedded"
    shot = pages.screen().grabWindow(pages.winId()) if embedded else pages.grab()
    image = shot.toImage()
    reddish = [
        colour.red() - colour.blue() > 100
        for x in range(0, image.width(), 2)
        for y in range(0, image.height(), 2)
        for colour in (image.pixelColor(x, y),)
    ]
    assert sum(reddish) > 50
    pages.close()


def ground(view: SceneView) -> np.ndarray:
    colour = view.palette().color(QPalette.ColorRole.Window)
    return np.array([colour.red(), colour.green(), colour.blue()])


def count(picture: np.ndarray, colour: str, tolerance: int = 40) -> int:
    """How many pixels have about this colour."""
    wanted = QColor(colour)
    return int(
        (np.abs(picture.astype(int) - [wanted.red(), wanted.green(), wanted.blue()]).max(axis=2) < tolerance).sum()
    )


def matrix(frame: ViewFrame) -> np.ndarray:
    """(4, 4) from the frame's coordinates to the camera's."""
    pose = frame.pose_camera_frame
    return np.vstack([np.column_stack([pose.rotation, pose.translation]), [0, 0, 0, 1]])


def texts_written(monkeypatch) -> set[str]:
    """Every text that is painted over the scene from now on."""
    written: set[str] = set()

    class Painter(QPainter):
        def drawText(self, *args: Any) -> None:  # type: ignore[override]
            written.add(args[-1])
            super().drawText(*args)

    monkeypatch.setattr(view_module, "QPainter", Painter)
    return written


def click(view: SceneView, qtbot, at, button=LEFT) -> None:
    qtbot.mouseClick(view.focusProxy(), button, pos=QPoint(*(int(c) for c in at)))


def drag(view: SceneView, qtbot, places, button=LEFT) -> None:
    canvas = view.focusProxy()
    assert canvas is not None
    points = [QPoint(*(int(c) for c in place)) for place in places]
    qtbot.mousePress(canvas, button, pos=points[0])
    for point in points[1:]:
        where = QPointF(point)  # QTest sends moves without buttons; the real ones have them
        event = QMouseEvent(
            QEvent.Type.MouseMove,
            where,
            canvas.mapToGlobal(where),
            Qt.MouseButton.NoButton,
            button,
            Qt.KeyboardModifier(0),
        )
        QApplication.sendEvent(canvas, event)
    qtbot.mouseRelease(canvas, button, pos=points[-1])


# ---- what is shown


def test_nothing_is_made_before_there_is_something_to_see(view, qtbot):
    qtbot.wait(20)
    assert view.state().kind == "none"


def test_an_empty_view_says_why_it_is_empty(view, qtbot):
    blank = view.grab().toImage()
    view.clear("No cloud yet: scan a part first.")
    qtbot.wait(20)
    assert view.grab().toImage() != blank


def test_a_cloud_is_shown_whole_from_above_where_it_is(view, qtbot):
    view.set_cloud(FLAT, colours=RED)
    view.view("top")
    complete(view, qtbot)
    picture = view.picture()
    assert picture.dtype == np.uint8 and count(picture, RED) > 5000
    screen = view.screen_positions(FLAT).astype(int)
    hit = picture[screen[:, 1], screen[:, 0]]
    assert (hit[:, 0] > 180).mean() > 0.97


def test_the_first_cloud_is_fitted_and_the_next_keeps_the_view(view, qtbot):
    view.set_cloud(FLAT)
    before = view.screen_positions(SPARSE)
    assert (before > 0).all() and (before < [700, 520]).all()
    view.set_cloud(FLAT / 3 + [0, 0, 333])
    assert_allclose(view.screen_positions(SPARSE), before)
    view.set_cloud(FLAT / 3 + [0, 0, 333], keep_camera=False)
    assert np.abs(view.screen_positions(SPARSE) - before).max() > 50


def test_values_have_a_colour_bar_with_name_and_unit_and_colours_of_ones_own_have_none(view, qtbot):
    view.set_cloud(FLAT, colours=RED)
    complete(view, qtbot)
    beside = round(110 * view.devicePixelRatioF())
    plain = view.picture()[:, -beside:]
    view.set_cloud(FLAT, values=FLAT[:, 0], colouring=Colouring("height", "mm"))
    complete(view, qtbot)
    bar = view.picture()[:, -beside:]
    inked = [(np.abs(part.astype(int) - ground(view)).max(axis=2) > 60).sum() for part in (plain, bar)]
    assert inked[1] > inked[0] + 1500


def test_a_view_beside_the_profile_of_a_cut_in_the_smallest_window_has_the_colour_bar(view):
    image = QImage(283, 195, QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.white)
    painter = QPainter(image)
    painter.setFont(view.font())
    colours = overlay.OverlayColours.of(view.palette())
    heights = Colouring("Höhe über der unteren Fläche", "mm", (0.0, 50.0))
    overlay._paint_bar(painter, heights, (283, 195), colours)
    painter.end()
    seen = {image.pixelColor(x, 100).name() for x in range(150, 283)}
    assert any(QColor(name).saturation() > 100 for name in seen)


def test_a_growing_cloud_shows_its_new_points(view, qtbot):
    view.set_cloud(np.empty((0, 3)), values=np.empty(0), colouring=Colouring("σ", "mm", (0, 1)))
    for k in range(0, len(FLAT), 500):
        view.add_points(FLAT[k : k + 500], np.ones(500))
        qtbot.wait(5)
    complete(view, qtbot)
    view.view("top")
    complete(view, qtbot)
    assert view.state().points == len(FLAT)
    assert count(view.picture(), "#fde725") > 5000


def test_points_added_beyond_the_view_are_brought_into_it_until_somebody_turns_it(view, qtbot):
    view.set_cloud(FLAT / 5 + [0, 0, 400])
    view.add_points(FLAT)
    assert ((view.screen_positions(FLAT) > 0) & (view.screen_positions(FLAT) < [700, 520])).all()
    view.orbit(5, 5)
    turned = view.screen_positions(SPARSE)
    view.add_points(FLAT * [9, 9, 1])
    assert_allclose(view.screen_positions(SPARSE), turned)


def test_a_cloud_that_grows_within_its_box_is_not_fitted_again_each_time(view, qtbot, monkeypatch):
    fitted, to_fit = [], Scene.to_fit
    monkeypatch.setattr(Scene, "to_fit", lambda scene: (fitted.append(1), to_fit(scene))[1])
    view.set_cloud(FLAT)
    fitted.clear()
    view.add_points(FLAT * [0.5, 0.5, 1])
    assert not fitted
    wide = FLAT * [3, 3, 1]
    view.add_points(wide)
    assert fitted
    assert ((view.screen_positions(wide) > 0) & (view.screen_positions(wide) < [700, 520])).all()


def test_highlights_planes_and_lines_come_and_go(view, qtbot):
    view.set_cloud(FLAT, colours="#808080")
    view.view("top")
    square = np.array([[-20, -20, 480.0], [20, -20, 480], [20, 20, 480], [-20, 20, 480]])
    view.set_highlight("upper", FLAT[:2000], RED)
    complete(view, qtbot)
    assert count(view.picture(), RED) > 2000
    view.remove_highlight("upper")
    view.remove_highlight("upper")
    view.set_polylines("pose", [np.vstack([square, square[:1]])], "#00ff00", 3)
    complete(view, qtbot)
    picture = view.picture()
    assert count(picture, RED) == 0 and count(picture, "#00ff00") > 300
    view.remove("pose")
    view.set_planes("fan", [square, np.full((4, 3), np.nan)], ["#0000ff", RED], opacity=0.5)
    complete(view, qtbot)
    picture = view.picture()
    assert count(picture, "#00ff00") == 0 and count(picture, "#4040c0", 30) > 1000
    view.remove("fan")
    complete(view, qtbot)
    assert count(view.picture(), "#4040c0", 30) == 0


def test_cloud_and_mesh_can_be_hidden(view, qtbot):
    corners = np.array([[-50, -50, 500.0], [50, -50, 500], [50, 50, 500], [-50, 50, 500]])
    view.set_mesh(corners, [[0, 1, 2], [0, 2, 3]], colour="#00ff00")
    view.view("top")
    complete(view, qtbot)
    green = lambda: int((view.picture()[:, :, 1].astype(int) - view.picture()[:, :, 0] > 60).sum())  # noqa: E731
    assert green() > 50_000
    view.show_mesh(False)
    assert green() == 0
    view.set_cloud(FLAT, colours=RED)
    complete(view, qtbot)
    assert count(view.picture(), RED) > 1000
    view.show_cloud(False)
    assert count(view.picture(), RED) == 0


def test_a_hidden_side_is_neither_drawn_nor_chosen_from(view, qtbot):
    view.set_cloud(FLAT, colours=RED)
    complete(view, qtbot)
    whole = count(view.picture(), RED)
    view.hide_side((np.array([0.0, 0, 500]), np.array([1.0, 0, 0])))
    complete(view, qtbot)
    assert count(view.picture(), RED) == pytest.approx(whole / 2, rel=0.15)
    picked: list[int] = []
    view.point_picked.connect(lambda number, place: picked.append(number))
    view.start_picking()
    size = view._canvas.logical_size
    for side in (-20.0, 20.0):
        (spot,), _ = view._camera.project(np.array([[side, 0, 500]]), size)
        click(view, qtbot, spot)
    assert len(picked) == 1 and FLAT[picked[0], 0] <= 0
    view.hide_side(None)
    complete(view, qtbot)
    assert count(view.picture(), RED) > 0.9 * whole, "the mark of the point covers some"


@pytest.mark.parametrize("width", [240, 700])
def test_the_name_of_the_frame_leaves_the_colour_bar_free(view, qtbot, width, monkeypatch):
    plates: list[tuple[str, float]] = []
    painted = overlay.text_plate
    monkeypatch.setitem(FRAME_NAMES, FrameKind.PART, "a frame with a name of many words")

    def noting(painter: QPainter, at: QPointF, text: str, *args: Any) -> Any:
        plate = painted(painter, at, text, *args)
        plates.append((text, plate.right()))
        return plate

    monkeypatch.setattr(overlay, "text_plate", noting)
    view.setMinimumWidth(0)
    view.resize(width, 520)
    view.set_frame(PART)
    view.set_axes(True)
    view.set_cloud(FLAT, values=FLAT[:, 0], colouring=Colouring("height", "mm"))
    complete(view, qtbot)
    plates.clear()
    view.picture()
    view.grab()
    width = view._canvas.logical_size[0]
    named = [(text, right) for text, right in plates if text.replace("\n", " ").startswith("a frame")]
    left_of_bar = width - overlay.bar_width(Colouring("height", "mm", (-50, 50)), view.font())
    assert named and all(right <= left_of_bar for _, right in named)
    assert ("\n" in named[0][0]) == (width < 400)


@pytest.mark.parametrize("side", [1, -1])
def test_a_tilted_mesh_has_the_colour_its_bar_says_and_a_plain_one_is_shaded(view, qtbot, side):
    tilted = np.array([[x, y, 500 + side * 1.7 * x] for x, y in ((-40, -40), (40, -40), (40, 40), (-40, 40))])
    triangles, colouring = [[0, 1, 2], [0, 2, 3]], Colouring("height", "mm", limits=(0.0, 1.0))

    def middle() -> np.ndarray:
        view.view("top")
        place = view.screen_positions(tilted.mean(axis=0, keepdims=True))[0]
        x, y = (place * view.devicePixelRatioF()).astype(int)
        return view.picture()[y - 4 : y + 5, x - 4 : x + 5].reshape(-1, 3).mean(axis=0)

    view.set_mesh(tilted, triangles, values=np.full(4, 0.95), colouring=colouring)
    assert_allclose(middle(), colouring.of(np.array([0.95]))[0], atol=0.1 * 255)
    view.set_mesh(tilted, triangles, colour="#ffffff")
    assert middle().max() < 0.75 * 255


RIDGE = np.array([[-40, -40, 540.0], [40, -40, 540], [40, 0, 500], [-40, 0, 500], [40, 40, 540], [-40, 40, 540]])
ROOF = [[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]]
"""A roof with a ridge along x."""


@pytest.mark.parametrize("parallel", [False, True])
def test_silhouette_and_creases_of_a_mesh_are_drawn_once_it_is_still(view, qtbot, parallel):
    view.set_mesh(RIDGE, ROOF, colour="#ffffff")
    view._navigator.set_parallel(parallel)
    view.view("top")
    complete(view, qtbot)
    picture = view.picture().max(axis=2).astype(int)
    at = (view.screen_positions([[0, 0, 500], [0, -20, 520], [0, -40, 540]]) * view.devicePixelRatioF()).astype(int)
    (x, ridge), (_, slope), (_, end) = at
    near = lambda y: picture[y - 3 : y + 4, x - 20 : x + 20].min(axis=0)  # noqa: E731
    assert near(ridge).max() < 0.6 * near(slope).min(), "the crease is a dark line"
    assert near(end).max() < 0.6 * near(slope).min(), "and so is where the surface ends"
    assert np.ptp(picture[slope - 3 : slope + 4, x - 20 : x + 20]) < 12, "nothing is drawn on a plane"
    view.orbit(8, 0)
    assert view._canvas.edges is None, "while it moves there are none"
    complete(view, qtbot)
    assert view._canvas.edges is not None


def test_points_over_a_mesh_a_grid_and_an_empty_scene_have_no_edges(view, qtbot):
    view.set_mesh(RIDGE, ROOF, colour="#ffffff")
    view.view("top")
    complete(view, qtbot)
    lines = view._drawing._line_px()
    assert lines == 0
    view.set_polylines("outline", [[[-30, -20, 519.9], [30, -20, 519.9]]], "#00ff00", 3.0)
    complete(view, qtbot)
    green = view.picture()[:, :, 1].astype(int) - view.picture()[:, :, 0] > 60
    assert green.sum() > 200
    rows = np.flatnonzero(green.any(axis=1))
    beside = view.picture()[rows.min() - 4, green.any(axis=0)].max(axis=1)
    assert beside.min() > 100, "a line laid on the surface is no edge of it"
    view.set_cloud(FLAT, colours=RED)
    complete(view, qtbot)
    assert view._canvas.edges is None
    view.clear()
    assert view._canvas.edges is None


def test_a_graphics_card_darkens_what_other_parts_stand_before(view, qtbot):
    corner = np.array([[-40, -40, 500], [40, -40, 500], [40, 40, 500], [-40, 40, 500.0]])
    wall = np.array([[-40, 0, 500], [40, 0, 500], [40, 0, 440], [-40, 0, 440.0]])
    triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]

    def beside_the_wall() -> float:
        view.set_mesh(np.vstack([corner, wall]), triangles, colour="#ffffff")
        view.view("iso")
        complete(view, qtbot)
        x, y = (view.screen_positions([[0, 2, 500]])[0] * view.devicePixelRatioF()).astype(int)
        return float(view.picture()[y, x - 2 : x + 3].mean())

    without = beside_the_wall()
    renderer = view._drawing._surface.renderer
    assert renderer.has_card is False, "here the processor draws"
    renderer.has_card = True
    assert beside_the_wall() < 0.9 * without


def test_points_are_shaded_by_their_normals_and_keep_the_colour_their_bar_says(view, qtbot):
    colouring = Colouring("height", "mm", limits=(0.0, 1.0))
    edge_on = np.tile(np.array([np.sin(1.3), 0, -np.cos(1.3)], np.float32), (len(FLAT), 1))

    def seen(normals: np.ndarray | None) -> np.ndarray:
        view.set_cloud(FLAT, values=np.full(len(FLAT), 0.95), colouring=colouring, normals=normals)
        view.view("top")
        complete(view, qtbot)
        rows, columns = view.picture().shape[:2]
        middle = view.picture()[rows // 3 : 2 * rows // 3, columns // 3 : 2 * columns // 3].reshape(-1, 3)
        colours, counts = np.unique(middle, axis=0, return_counts=True)
        return colours[counts.argsort()[-2]].astype(float)  # after the background's

    unlit, tilted, unknown = seen(None), seen(edge_on), seen(np.zeros_like(edge_on))
    assert tilted.max() < 0.95 * unlit.max()
    assert_allclose(tilted, unlit, atol=0.15 * 255)
    assert_allclose(unknown, unlit, atol=3)


def test_labels_and_measures_are_written_over_the_scene(view, qtbot):
    view.set_cloud(SPARSE, colours="#808080")
    complete(view, qtbot)
    before = view.picture()
    view.set_measure("thickness", SPARSE[0], SPARSE[4], "50.012 mm")
    view.set_labels("faces", [(SPARSE[10], "upper face")])
    complete(view, qtbot)
    assert (view.picture() != before).any(axis=2).sum() > 500
    view.remove("thickness")
    view.remove("faces")
    complete(view, qtbot)
    assert_array_equal(view.picture(), before)


def test_no_label_is_written_over_another_one(view, qtbot, monkeypatch):
    painted, said = overlay.text_plate, []

    def noting(painter: QPainter, at: QPointF, text: str, *args: Any) -> Any:
        said.append(text)
        return painted(painter, at, text, *args)

    monkeypatch.setattr(overlay, "text_plate", noting)
    view.set_cloud(SPARSE, colours="#808080")
    view.view("top")
    towards = np.array([0.0, 0.0, 5.0])
    view.set_labels("poses", [(SPARSE[0] + towards, "01"), (SPARSE[0] - towards, "02"), (SPARSE[19], "03")])
    complete(view, qtbot)
    said.clear()
    view.picture()
    poses = [text for text in said if text.startswith("0")]
    assert len(poses) == 2 and "03" in poses, "of two at one place the nearer"


def test_the_ground_follows_the_theme_at_once(view, qtbot, theme):
    view.set_cloud(SPARSE, colours=RED)
    for name, dark in (("dark", True), ("light", False)):
        theme(name)
        complete(view, qtbot)
        corner = view.picture()[2:10, 2:10].reshape(-1, 3)
        assert (corner.mean() < 80) == dark
        assert_allclose(corner, np.broadcast_to(ground(view), corner.shape), atol=3)


def test_the_grid_lies_under_the_scene(view, qtbot):
    view.set_cloud(FLAT, colours=RED)
    complete(view, qtbot)
    before = view.picture()
    view.findChild(SceneButtons).action("grid").setChecked(True)
    complete(view, qtbot)
    assert (view.picture() != before).any(axis=2).sum() > 1000
    view.findChild(SceneButtons).action("grid").setChecked(False)
    complete(view, qtbot)
    assert_array_equal(view.picture(), before)


def test_wrong_shapes_are_refused_and_leave_what_was_shown(view):
    view.set_cloud(FLAT)
    with pytest.raises(ValueError, match="values"):
        view.set_cloud(FLAT, values=[1, 2])
    with pytest.raises(ValueError, match="shape"):
        view.set_highlight("x", np.zeros((3, 2)), RED)
    with pytest.raises(ValueError, match="colour"):
        view.set_highlight("x", FLAT, "no colour at all")
    assert view.state().points == len(FLAT)


# ---- from where


def test_keys_choose_the_standard_views(view, qtbot):
    view.set_cloud(FLAT)
    view.view("iso")
    seen = set()
    for key in "12345678":
        qtbot.keyClick(view.focusProxy(), key)
        seen.add(tuple(np.round(view.screen_positions(SPARSE).ravel()).tolist()))
    assert len(seen) >= 7  # what the camera sees is nearly the view from above
    view.zoom(5)
    qtbot.keyClick(view.focusProxy(), "r")
    fitted = view.screen_positions(SPARSE)
    assert (fitted > 0).all() and (fitted < [700, 520]).all()


def test_in_parallel_projection_equal_lengths_look_equal(view, qtbot):
    view.set_cloud(np.vstack([FLAT, FLAT - [0, 0, 90]]))
    view.view("top")
    near_far = np.array([[0, 0, 410.0], [10, 0, 410], [0, 0, 500], [10, 0, 500]])
    a, b, c, d = view.screen_positions(near_far)
    assert np.hypot(*(b - a)) > 1.05 * np.hypot(*(d - c))
    view.set_parallel(True)
    a, b, c, d = view.screen_positions(near_far)
    assert_allclose(b - a, d - c, atol=1e-3)


def test_the_mouse_turns_moves_and_zooms(view, qtbot):
    view.set_cloud(FLAT)
    places = [view.screen_positions(SPARSE)]
    drag(view, qtbot, [(300, 200), (340, 210), (380, 220)])
    places.append(view.screen_positions(SPARSE))
    drag(view, qtbot, [(300, 200), (340, 200)], Qt.MouseButton.RightButton)
    places.append(view.screen_positions(SPARSE))
    assert np.abs(places[1] - places[0]).max() > 20
    assert_allclose((places[2] - places[1]).mean(axis=0), [40, 0], atol=8)


def test_another_orientation_turns_the_standard_views(view, qtbot):
    view.set_cloud(FLAT)
    view.view("front")
    edge_on = np.ptp(view.screen_positions(FLAT)[:, 1])
    view.set_frame(UPRIGHT)
    assert np.ptp(view.screen_positions(FLAT)[:, 1]) > 5 * edge_on + 20


@pytest.mark.parametrize("frame", [CAMERA_FRAME, PART])
def test_dragging_sideways_turns_about_the_z_of_the_frame(view, qtbot, frame):
    view.set_cloud(FLAT)
    view.set_frame(frame)
    view.view("front")
    upright = frame.pose_camera_frame.apply([[0, 0, 0], [0, 0, -30]])
    before = np.diff(view.screen_positions(upright), axis=0)[0]
    drag(view, qtbot, [(300, 200), (340, 200), (400, 200)])
    after = np.diff(view.screen_positions(upright), axis=0)[0]
    assert_allclose([before[0], after[0]], 0, atol=abs(after[1]) / 20)
    assert abs(after[1]) > 20


@pytest.mark.parametrize("frame", [CAMERA_FRAME, PART])
def test_the_view_says_its_frame_and_reads_points_out_in_it(view, qtbot, frame, monkeypatch):
    read = []
    monkeypatch.setattr(view_module, "place_text", lambda place: read.append(place) or "")
    written = texts_written(monkeypatch)
    view.set_axes(True)
    view.set_cloud(SPARSE)
    view.set_frame(frame)
    view.view("top" if frame is CAMERA_FRAME else "iso")
    view.start_picking()
    with qtbot.waitSignal(view.point_picked) as picked:
        click(view, qtbot, view.screen_positions(SPARSE)[7])
    view.picture()
    assert picked.args[0] == 7
    assert_array_equal(picked.args[1], SPARSE[7])  # what is told stays in the camera's frame
    assert_allclose(read[-1], np.linalg.inv(matrix(frame))[:3] @ [*SPARSE[7], 1])
    assert FRAME_NAMES[frame.kind] in written
    assert {"x", "y", "z"} <= written
    others = {name for kind, name in FRAME_NAMES.items() if kind is not frame.kind}
    assert not others & written


@pytest.mark.parametrize("frame", [CAMERA_FRAME, PART])
def test_a_region_drawn_in_any_frame_holds_what_is_seen_in_it(view, qtbot, frame):
    view.set_cloud(SPARSE)
    view.set_frame(frame)
    view.view("top" if frame is CAMERA_FRAME else "iso")
    view.start_polygon()
    at = view.screen_positions(SPARSE)
    corners = at[[0, 1, 6, 5]]
    out = corners - corners.mean(axis=0)
    outwards = corners + 8 * out / np.linalg.norm(out, axis=1)[:, None]
    with qtbot.waitSignal(view.region_selected) as chosen:
        for corner in outwards:
            click(view, qtbot, corner)
        qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Return)
    assert_array_equal(np.flatnonzero(chosen.args[0]), [0, 1, 5, 6])


@pytest.mark.parametrize("frame", [CAMERA_FRAME, PART])
def test_lines_marks_and_callouts_are_drawn_where_their_points_are_in_any_frame(view, qtbot, frame, monkeypatch):
    view.set_cloud(SPARSE, colours="#808080")
    view.set_frame(frame)
    view.view("top" if frame is CAMERA_FRAME else "iso")
    at = view.screen_positions(SPARSE)
    view.set_polylines("section", [SPARSE[[0, 4]]], RED, 4.0)
    view.set_highlight("face", SPARSE[[12]], "#00ff00")
    plates = []
    monkeypatch.setattr(overlay, "text_plate", lambda painter, place, text, *rest: plates.append((text, place)))
    view.set_labels("callout", [(SPARSE[19], "P1")])
    view.set_measure("distance", SPARSE[15], SPARSE[17], "20 mm")
    complete(view, qtbot)
    picture = view.picture()
    scale = picture.shape[0] / view.focusProxy().height()
    for place, colour in ((at[[1, 3]].mean(axis=0), RED), (at[12], "#00ff00")):
        x, y = np.round(place * scale).astype(int)
        assert count(picture[y - 3 : y + 4, x - 3 : x + 4], colour) >= 3
    written = {text: (place.x(), place.y()) for text, place in plates}
    assert_allclose(written["P1"], at[19] - [0, 14])
    assert_allclose(written["20 mm"], at[[15, 17]].mean(axis=0))


@pytest.mark.parametrize("frame", [CAMERA_FRAME, PART])
def test_a_handle_follows_the_mouse_along_its_direction_and_the_view_stands_still(view, qtbot, frame):
    view.set_cloud(FLAT)
    view.set_frame(frame)
    view.view("top" if frame is CAMERA_FRAME else "iso")
    view.set_parallel(True)
    place, direction = np.array([5.0, -10.0, 500.0]), frame.axes[0]
    view.set_handle((place, direction))
    before = view.screen_positions(SPARSE)
    start, end = view.screen_positions([place, place + 25 * direction])
    pulled = []
    view.handle_pulled.connect(pulled.append)
    drag(view, qtbot, [start, (start + end) / 2, end])
    assert sum(pulled) == pytest.approx(25, abs=0.5)
    assert_array_equal(view.screen_positions(SPARSE), before)
    view.set_handle(None)
    drag(view, qtbot, [start, (start + end) / 2, end])
    assert sum(pulled) == pytest.approx(25, abs=0.5)
    assert np.abs(view.screen_positions(SPARSE) - before).max() > 5, "without a handle it turns"


def test_beside_its_ring_a_drag_turns_the_view(view, qtbot):
    view.set_cloud(FLAT)
    view.set_handle((np.array([0.0, 0, 500]), np.array([1.0, 0, 0])))
    x, y = view.screen_positions([[0.0, 0, 500]])[0]
    with qtbot.assertNotEmitted(view.handle_pulled):
        drag(view, qtbot, [(x + 40, y + 30), (x + 70, y + 30), (x + 90, y + 30)])


def test_a_handle_seen_end_on_is_not_pulled(view, qtbot):
    view.set_cloud(FLAT)
    view.view("top")
    view.set_parallel(True)
    view.set_handle((np.array([0.0, 0, 500]), np.array([0.0, 0, 1])))
    x, y = view.screen_positions([[0.0, 0, 500]])[0]
    with qtbot.assertNotEmitted(view.handle_pulled):
        drag(view, qtbot, [(x, y), (x + 30, y), (x + 60, y)])


def test_a_frame_given_again_moves_nothing(view, qtbot):
    view.set_cloud(FLAT)
    view.set_frame(PART)
    drag(view, qtbot, [(300, 200), (340, 210), (380, 220)])
    before = view.screen_positions(SPARSE)
    view.set_frame(ViewFrame(FrameKind.PART, PART.pose_camera_frame))
    assert_array_equal(view.screen_positions(SPARSE), before)


# ---- choosing


def test_a_click_picks_the_point_of_the_cloud_it_was_given(view, qtbot):
    view.set_cloud(SPARSE)
    view.view("top")
    view.start_picking()
    with qtbot.waitSignal(view.point_picked) as picked:
        click(view, qtbot, view.screen_positions(SPARSE)[7] + [3, -2])
    assert picked.args[0] == 7
    assert_array_equal(picked.args[1], SPARSE[7])
    with qtbot.assertNotEmitted(view.point_picked):
        click(view, qtbot, (3, 3))


def test_added_points_are_picked_by_their_number_in_the_whole_cloud(view, qtbot):
    view.set_cloud(SPARSE[:10])
    view.add_points(SPARSE[10:])
    view.view("top")
    view.start_picking()
    with qtbot.waitSignal(view.point_picked) as picked:
        click(view, qtbot, view.screen_positions(SPARSE)[13])
    assert picked.args[0] == 13


def test_enter_takes_what_was_picked_and_its_mark_goes(view, qtbot):
    view.set_cloud(SPARSE)
    view.view("top")
    view.start_picking()
    view.set_hint("Click a face.")
    click(view, qtbot, view.screen_positions(SPARSE)[7])
    assert view._marked is not None and view._canvas.tool.hint == "Click a face."
    with qtbot.waitSignal(view.taken), qtbot.assertNotEmitted(view.drawing_cancelled):
        qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Return)
    assert view._marked is None
    with qtbot.waitSignal(view.point_picked):
        click(view, qtbot, view.screen_positions(SPARSE)[9])


def test_turning_the_view_while_picking_picks_nothing(view, qtbot):
    view.set_cloud(SPARSE)
    view.view("top")
    view.start_picking()
    at = view.screen_positions(SPARSE)[7]
    with qtbot.assertNotEmitted(view.point_picked):
        drag(view, qtbot, [at, at + 20, at + 40])
    assert np.abs(view.screen_positions(SPARSE)[7] - at).max() > 1


@pytest.mark.parametrize("closing", ["double click", "enter", "first corner"])
def test_a_polygon_chooses_the_points_inside(view, qtbot, closing):
    points = FLAT.copy()
    points[[5, 6]] = np.nan
    view.set_cloud(points)
    view.view("top")
    corners = np.array([(200, 150), (500, 170), (480, 400), (220, 380)])
    view.start_polygon()
    for corner in corners:
        click(view, qtbot, corner)
    with qtbot.waitSignal(view.region_selected) as selected:
        if closing == "double click":
            qtbot.mouseDClick(view.focusProxy(), LEFT, pos=QPoint(220, 380))
        elif closing == "enter":
            qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Return)
        else:
            click(view, qtbot, corners[0])
    inside = selected.args[0]
    assert inside.shape == (len(points),) and inside.dtype == bool and not inside[5]
    wanted = crossing_number(np.nan_to_num(view.screen_positions(points), nan=-1), corners.astype(float))
    assert (inside != wanted).mean() < 0.002 and inside.sum() > 100


def test_a_lasso_chooses_the_points_inside(view, qtbot):
    view.set_cloud(FLAT)
    view.view("top")
    angles = np.linspace(0, 2 * np.pi, 60)
    outline = np.column_stack([340 + 120 * np.cos(angles), 260 + 90 * np.sin(angles)]).astype(int)
    view.start_lasso()
    with qtbot.waitSignal(view.region_selected) as selected:
        drag(view, qtbot, outline)
    wanted = crossing_number(view.screen_positions(FLAT), outline.astype(float))
    assert (selected.args[0] != wanted).mean() < 0.01 and wanted.sum() > 100


def test_a_hidden_cloud_is_not_chosen_from(view, qtbot):
    view.set_cloud(FLAT)
    view.view("top")
    view.show_cloud(False)
    view.start_polygon()
    for corner in ((200, 150), (500, 170), (480, 400)):
        click(view, qtbot, corner)
    with qtbot.waitSignal(view.region_selected) as selected:
        qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Return)
    assert selected.args[0].shape == (len(FLAT),) and not selected.args[0].any()


@pytest.mark.parametrize("start", ["start_picking", "start_polygon", "start_lasso"])
def test_escape_ends_choosing_without_a_result(view, qtbot, start):
    view.set_cloud(FLAT)
    getattr(view, start)()
    with qtbot.assertNotEmitted(view.region_selected), qtbot.waitSignal(view.drawing_cancelled):
        qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Escape)
    with qtbot.assertNotEmitted(view.drawing_cancelled, wait=20):
        qtbot.keyClick(view.focusProxy(), Qt.Key.Key_Escape)


# ---- large clouds


def test_a_large_cloud_is_thinned_in_motion_and_whole_when_still(view, qtbot):
    large = np.column_stack([*(RNG.random((2, 600_000)) * 100 - 50), np.full(600_000, 500.0)])
    view.set_cloud(large, values=large[:, 0], colouring=Colouring("x", "mm"))
    complete(view, qtbot)
    for _ in range(12):  # it learns how much it can draw
        view.orbit(4, 0)
        qtbot.wait(1)
    with Watchdog() as watchdog:
        for _ in range(10):
            view.orbit(4, 1)
            qtbot.wait(5)
        moving = view.state().drawn_moving
        complete(view, qtbot)
    assert moving <= 600_000
    assert watchdog.longest_ms < LIMIT_MS
    if max(view.state().pass_ms) > 22:
        assert moving < 600_000


def test_nothing_is_drawn_while_nobody_sees_it(view, qtbot):
    view.set_cloud(FLAT)
    complete(view, qtbot)
    view.hide()
    drawn = len(view.state().pass_ms)
    view.set_highlight("a", FLAT[:100], RED)
    view.orbit(10, 10)
    qtbot.wait(300)
    assert len(view.state().pass_ms) == drawn
    view.show()
    complete(view, qtbot)
    assert len(view.state().pass_ms) > drawn


# ---- pictures


def test_a_view_that_was_never_seen_has_a_picture(ready, qtbot):
    unseen = SceneView()
    qtbot.addWidget(unseen)
    unseen.resize(400, 300)
    unseen.set_cloud(FLAT, colours=RED)
    assert count(unseen.picture(), RED) > 1000


def test_the_picture_is_saved(view, qtbot, tmp_path, monkeypatch):
    view.set_cloud(FLAT, colours=RED)
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "scene"), ""))
    qtbot.keyClick(view.focusProxy(), "s", Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    assert (tmp_path / "scene.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError):
        view.save_picture(tmp_path / "scene.png" / "no" / "folder.png")


# ---- beginning and end


def test_where_there_is_no_3d_the_view_says_so_and_one_notice_tells_of_it(unknown, qtbot, monkeypatch):
    monkeypatch.setenv(ready_module.VARIABLE, "none")
    said, views = [], [SceneView(), SceneView()]
    for made in views:
        qtbot.addWidget(made)
        made.resize(400, 300)
        made.notice.connect(said.append)
        made.show()
        blank = made.grab().toImage()
        made.set_cloud(SPARSE)
        assert made.grab().toImage() != blank
        assert made.picture().shape[2] == 3
    assert len(said) == 1 and "3D" in said[0]
    assert {made.state().kind for made in views} == {"none"}
    views[0].view("top")
    views[0].start_picking()
    with qtbot.waitSignal(views[0].point_picked):  # what is chosen needs no picture
        click(views[0], qtbot, views[0].screen_positions(SPARSE)[7])


def test_it_closes_with_its_window_in_the_middle_of_drawing(ready, qtbot, caplog):
    window, page = QMainWindow(), QWidget()
    inside = SceneView(page)
    inside.resize(500, 400)
    window.setCentralWidget(page)
    qtbot.addWidget(window)
    window.resize(600, 500)
    window.show()
    qtbot.waitExposed(window)
    with caplog.at_level(logging.WARNING):
        inside.set_cloud(RNG.random((300_000, 3)) * 100)
        qtbot.waitUntil(lambda: bool(inside.state().pass_ms), timeout=20_000)
        window.close()
        window.deleteLater()
        qtbot.wait(50)
    assert not caplog.records


def test_the_libraries_come_while_the_view_waits(ready, unknown, qtbot):
    view = SceneView()
    qtbot.addWidget(view)
    view.show()
    view.set_cloud(FLAT)
    complete(view, qtbot)
    assert unknown.kind == view.state().kind != "none"
    view.close()


def test_it_is_embedded_where_a_window_has_opengl_and_else_a_picture_with_one_notice(ready, qtbot, monkeypatch):
    monkeypatch.setattr(ready, "notified", frozenset())
    said, views = [], [SceneView(), SceneView()]
    for made in views:
        qtbot.addWidget(made)
        made.notice.connect(said.append)
        made.resize(500, 400)
        made.show()
        made.set_cloud(FLAT, colours=RED)
        complete(made, qtbot)
    with_window = QGuiApplication.platformName() == "xcb" and ready.opengl_in_windows()
    assert {made.state().kind for made in views} == {"embedded" if with_window else "pictures"}
    assert [len(made.findChildren(QtInteractor)) for made in views] == ([1, 1] if with_window else [0, 0])
    assert len(said) == (0 if with_window else 1)
    for made in views:
        assert count(made.picture(), RED) > 1000
        made.close()


def test_opengl_that_cannot_be_made_or_shows_nothing_is_replaced_by_pictures(ready, unknown, qtbot, monkeypatch):
    class Nothing:
        ready = False
        renderer = None

        def __init__(self, canvas, draw):
            pass

        def fit(self, ground):
            pass

        def close(self):
            pass

    monkeypatch.setattr(unknown, "_kind", "embedded")
    monkeypatch.setattr(drawing, "DOUBT_MS", 50)
    monkeypatch.setattr(sys.modules[ready_module.SURFACES], "EmbeddedSurface", Nothing)
    view = SceneView()
    qtbot.addWidget(view)
    view.show()
    with qtbot.waitSignal(view.notice, timeout=30_000):
        view.set_cloud(FLAT)
    complete(view, qtbot)
    assert view.state().kind == "pictures"
    view.close()


def test_pictures_that_cannot_be_made_leave_a_sentence(ready, unknown, qtbot, monkeypatch, caplog):
    def broken(self):
        raise RuntimeError("no context")

    monkeypatch.setattr(unknown, "_kind", "pictures")
    monkeypatch.setattr(sys.modules[ready_module.SURFACES].PictureSurface, "__init__", broken)
    view = SceneView()
    qtbot.addWidget(view)
    view.show()
    view.set_cloud(FLAT)
    qtbot.waitUntil(lambda: unknown.kind == "none")
    assert "cannot be made" in caplog.text
    view.close()


@pytest.mark.parametrize("program", ["/bin/false", "/no/such/program"])
def test_a_driver_that_crashes_is_found_out_in_another_process(unknown, qtbot, monkeypatch, caplog, program):
    monkeypatch.setattr(ready_module.sys, "executable", program)
    monkeypatch.setattr(unknown, "_opengl", False)
    with qtbot.waitSignal(unknown.known):
        unknown.find_out()
    assert unknown.kind == "none"
    assert "does not work" in caplog.text


def test_the_environment_can_forbid_opengl(unknown, monkeypatch):
    assert unknown.kind is None
    monkeypatch.setenv(ready_module.VARIABLE, "1")
    assert not unknown.opengl_in_windows() and unknown.kind is None
    monkeypatch.setenv(ready_module.VARIABLE, "none")
    assert unknown.kind == "none"


def test_what_makes_the_view_lower_while_it_is_laid_out_leaves_no_canvas_that_is_cut(qtbot):
    """As Qt lays all that is around out anew when the tool bar's button for what it has no room for comes up."""
    page, above, view = QWidget(), QWidget(), SceneView()
    qtbot.addWidget(page)
    above.setFixedHeight(20)
    column = in_column(above, (view, 1), on=page)
    page.resize(900, 500)
    page.show()
    qtbot.waitExposed(page)

    class Lower(QObject):
        def eventFilter(self, watched, event):
            if event.type() == QEvent.Type.Resize and above.height() == 20:
                above.setFixedHeight(60)
                column.activate()
            return False

    lower = Lower(page)
    view._buttons.installEventFilter(lower)
    page.resize(400, 420)
    qtbot.waitUntil(lambda: above.height() == 60 and view.geometry().bottom() == page.rect().bottom())
    qtbot.waitUntil(lambda: view._canvas.geometry().bottom() == view.rect().bottom())
