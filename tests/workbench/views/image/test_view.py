import re

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QWheelEvent
from PySide6.QtWidgets import QApplication

from workbench.views.colours import EXCLUDED, sigma_table, to_rgba
from workbench.views.image.view import ImageView

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def view(qtbot):
    view = ImageView()
    view.resize(640, 480)
    qtbot.addWidget(view)
    view.show()
    qtbot.waitExposed(view)
    view.set_picture(np.full((300, 400), 40, dtype=np.uint8))
    return view


def click(qtbot, view, u, v, button=LEFT):
    qtbot.mouseMove(view.canvas, view.to_screen(u, v))
    qtbot.mouseClick(view.canvas, button, pos=view.to_screen(u, v))


def drag(qtbot, view, *places):
    qtbot.mouseMove(view.canvas, view.to_screen(*places[0]))
    qtbot.wait(15)
    qtbot.mousePress(view.canvas, LEFT, pos=view.to_screen(*places[0]))
    for place in places[1:]:
        qtbot.wait(15)  # pyqtgraph drops moves that come faster than a hand's
        qtbot.mouseMove(view.canvas, view.to_screen(*place))
    qtbot.mouseRelease(view.canvas, LEFT, pos=view.to_screen(*places[-1]))


def colour_at(view, u, v):
    image = view.canvas.grab().toImage()
    ratio = image.devicePixelRatio()
    spot = view.to_screen(u, v)
    return QColor(image.pixel(round(spot.x() * ratio), round(spot.y() * ratio)))


def wheel(view, at, notches):
    place = QPointF(at)
    glob = QPointF(view.canvas.mapToGlobal(at))
    turn = QWheelEvent(
        place,
        glob,
        QPoint(),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(view.canvas, turn)


def test_the_centre_of_the_first_pixel_is_nought_nought(view):
    picture = np.zeros((3, 4), dtype=np.uint8)
    picture[0, 0] = 255
    view.set_picture(picture)
    for u, v in ((0, 0), (-0.4, -0.4), (0.4, 0.4)):
        assert colour_at(view, u, v).red() == 255
    for u, v in ((0.6, 0), (0, 0.6), (1, 1)):
        assert colour_at(view, u, v).red() == 0


def test_a_point_at_nought_nought_is_drawn_on_the_first_pixel(view):
    view.set_picture(np.zeros((3, 4), dtype=np.uint8))
    view.set_points("p", [(0, 0)], colour="#ff0000", symbol=".", size=12)
    assert colour_at(view, 0, 0) == QColor("#ff0000")
    assert colour_at(view, 1, 0) == QColor("#000000")


def test_pixels_of_a_reduced_picture_cover_those_of_the_full_one(view):
    picture = np.zeros((3, 4), dtype=np.uint8)
    picture[1, 2] = 255
    view.set_picture(picture, scale=2)
    for u, v in ((3.6, 1.6), (5.4, 3.4), (4.5, 2.5)):  # full pixels 4 and 5, 2 and 3
        assert colour_at(view, u, v).red() == 255
    for u, v in ((3.4, 2), (5.6, 2), (4, 1.4), (4, 3.6)):
        assert colour_at(view, u, v).red() == 0


def test_the_readout_names_place_and_grey(qtbot, view):
    picture = np.zeros((300, 400), dtype=np.uint8)
    picture[100, 200] = 87
    view.set_picture(picture)
    view.centre_on(200, 100)
    for _ in range(8):
        qtbot.keyClick(view, "+")
    qtbot.mouseMove(view.canvas, view.to_screen(200, 100))
    qtbot.waitUntil(lambda: "87" in view.readout)
    u, v = (float(part) for part in re.findall(r"[uv] (\d+\.\d)", view.readout))
    assert (u, v) == pytest.approx((200, 100), abs=0.3)


def test_the_wheel_zooms_about_the_cursor(qtbot, view):
    corner = view.to_screen(100, 50)
    before = view.zoom
    wheel(view, corner, 3)
    assert view.zoom > 1.5 * before
    assert (view.to_screen(100, 50) - corner).manhattanLength() <= 2


def test_dragging_pans(qtbot, view):
    before = view.to_screen(200, 150)
    drag(qtbot, view, (200, 150), (210, 160), (240, 170))
    moved = view.to_screen(200, 150) - before
    assert moved.x() > 10
    assert moved.y() > 5


def test_keys_fit_and_show_pixel_on_pixel(qtbot, view):
    whole = view.zoom
    qtbot.keyClick(view, "1")
    assert view.zoom == pytest.approx(1.0, rel=0.01)
    qtbot.keyClick(view, "+")
    assert view.zoom == pytest.approx(1.25, rel=0.01)
    place = view.to_screen(200, 150)
    qtbot.keyClick(view, Qt.Key.Key_Right)
    assert view.to_screen(200, 150).x() < place.x()
    qtbot.keyClick(view, "f")
    assert view.zoom == pytest.approx(whole, rel=0.01)


def test_the_view_is_kept_for_the_next_picture_of_the_same_size(qtbot, view):
    qtbot.keyClick(view, "1")
    view.set_picture(np.zeros((300, 400), dtype=np.uint8))
    assert view.zoom == pytest.approx(1.0, rel=0.01)
    view.set_picture(np.zeros((150, 200), dtype=np.uint8), scale=2)
    assert view.zoom == pytest.approx(1.0, rel=0.01)
    view.set_picture(np.zeros((300, 400), dtype=np.uint8), keep_view=False)
    fitted = view.zoom
    view.set_picture(np.zeros((600, 800), dtype=np.uint8))
    assert view.zoom < 0.6 * fitted


def test_a_fitted_picture_stays_fitted_when_the_window_grows(qtbot, view):
    before = view.zoom
    view.resize(1200, 900)
    qtbot.waitUntil(lambda: view.zoom > 1.5 * before)


@pytest.mark.parametrize(
    ("picture", "shown"),
    [
        (np.array([[0, 4095]], dtype=np.uint16), [0, 255]),
        (np.array([[0, 60000]], dtype=np.uint16), [0, 233]),
        (np.array([[-2.0, 2.0]]), [0, 255]),
        (np.array([[np.nan, 1.0]]), [0, 0]),
        (np.array([[False, True]]), [0, 255]),
    ],
)
def test_any_type_of_picture_is_shown_from_black_to_white(view, picture, shown):
    view.set_picture(picture)
    assert [colour_at(view, u, 0).red() for u in (0, 1)] == pytest.approx(shown, abs=1)


def test_levels_and_colour_and_brightness(view):
    view.set_picture(np.array([[100, 150]], dtype=np.uint8), levels=(100, 200))
    assert [colour_at(view, u, 0).red() for u in (0, 1)] == pytest.approx([0, 127], abs=1)
    view.set_tone(2.0, 1.0)
    assert colour_at(view, 1, 0).red() == pytest.approx(254, abs=2)
    view.set_tone(1.0, 1.0)
    view.set_picture(np.array([[[255, 0, 0], [0, 0, 255]]], dtype=np.uint8))
    assert colour_at(view, 0, 0) == QColor(255, 0, 0)


def test_what_is_no_picture_is_refused(view):
    with pytest.raises(ValueError, match="no picture"):
        view.set_picture(np.zeros((2, 2, 2)))


def test_without_a_picture_there_is_a_sentence_and_a_button(qtbot, view):
    pressed = []
    view.set_points("p", [(1, 1)], colour="red", title="P")
    view.clear("Record some views.", "Record", lambda: pressed.append(True))
    assert view.layer_names() == ()
    assert view.empty_state.isVisible()
    assert view.empty_state.message == "Record some views."
    qtbot.mouseClick(view.empty_state.button, LEFT)
    assert pressed == [True]
    view.set_picture(np.zeros((30, 40), dtype=np.uint8))
    assert not view.empty_state.isVisible()


def hide(view, title):
    """Take the tick from a layer in the menu."""
    view._layers_menu.fill()
    (action,) = (action for action in view._layers_menu.actions() if action.text() == title)
    action.setChecked(False)


def test_layers_are_replaced_hidden_and_listed(view):
    view.set_points("b", [(10, 10)], colour="red", title="Corners")
    view.set_lines("a", [[(0, 0), (9, 9)]], colour="blue", title="Fan line 1")
    view.set_points("b", [(20, 20)], colour="red", title="Corners")
    assert view.layer_names() == ("b", "a")
    assert view.legend_titles == ["Corners", "Fan line 1"]
    hide(view, "Corners")
    assert view.legend_titles == ["Fan line 1"]
    view.remove_layer("b")
    view.remove_layer("never there")
    view.set_points("b", [(20, 20)], colour="red", title="Corners")
    assert view.legend_titles == ["Fan line 1"]
    view.set_legend_visible(False)
    assert view.legend_titles == []
    view.clear_layers()
    assert view.layer_names() == ()


def test_a_legend_never_covers_much_of_a_small_picture(view, qtbot):
    for number in range(7):
        view.set_points(f"{number}", [(10, 10)], colour="red", title=f"crossing number {number}")
    view.resize(900, 700)
    qtbot.waitUntil(lambda: len(view.legend_titles) == 7)
    button = view._strip.layers
    tip = button.toolTip()
    view.resize(240, 270)
    qtbot.waitUntil(lambda: view.legend_titles == [])
    assert button.toolTip().splitlines() == [tip, *(f"crossing number {number}" for number in range(7))]
    view._layers_menu.fill()
    assert "crossing number 3" in [action.text() for action in view._layers_menu.actions()], "its signs are there"


def test_a_legend_stands_in_the_corner_with_fewest_points_and_leaves_it_only_for_one_far_emptier(view, qtbot):
    view.resize(480, 360)
    width, height = view.canvas.width(), view.canvas.height()

    def corner(*crowds):
        """Crowds of points on the screen, as (count, x, y); left and top of the legend are told."""
        places = [(x, y) for count, x, y in crowds for _ in range(count)]
        at = [view._box.mapSceneToView(QPointF(*place)) for place in places]
        view.set_points("crowd", [(one.x(), one.y()) for one in at], colour="red", title="points used, upper")
        middle = view._legend.geometry().center()
        return middle.x() < width / 2, middle.y() < height / 2

    left, right, top, bottom = 20, width - 20, 15, height - 15
    assert corner((1, width / 2, height / 2)) == (True, True)
    assert corner((50, left, top)) == (True, False)
    assert corner((40, left, top), (30, left, bottom), (40, right, top), (40, right, bottom)) == (True, False)
    assert corner((40, left, top), (50, left, bottom), (40, right, bottom)) == (False, True)


def test_the_menu_hides_and_shows_layers_with_a_title(view):
    view.set_points("corners", [(10, 10)], colour="red", title="Corners")
    view.set_points("nameless", [(10, 10)], colour="red")
    menu = view._layers_menu
    menu.fill()
    assert [action.text() for action in menu.actions() if action.text()] == ["Corners", "Legend"]
    menu.actions()[0].setChecked(False)
    assert view.legend_titles == []
    menu.actions()[0].setChecked(True)
    assert view.legend_titles == ["Corners"]
    menu.actions()[-1].setChecked(False)
    assert view.legend_titles == []


def test_points_may_have_a_colour_each(view):
    colours = np.array([[255, 0, 0], [0, 255, 0]], dtype=np.uint8)
    view.set_points("p", [(100, 100), (200, 100)], colour=colours, symbol=".", size=12)
    assert colour_at(view, 100, 100) == QColor(255, 0, 0)
    assert colour_at(view, 200, 100) == QColor(0, 255, 0)


def test_lines_are_coloured_by_the_value_along_them(view):
    line = np.column_stack([np.linspace(50, 350, 301), np.full(301, 150.0)])
    sigma = np.where(line[:, 0] < 150, 0.001, np.where(line[:, 0] < 250, 0.049, 0.2))
    view.set_lines("sweep", [line], values=[sigma], limits=(0, 0.05), width=6)
    shown = [colour_at(view, u, 150) for u in (100, 200, 300)]
    meant = [*sigma_table()[[5, 249]], to_rgba(EXCLUDED)]
    for colour, rgba in zip(shown, meant, strict=True):
        assert (
            np.abs(np.array([colour.red(), colour.green(), colour.blue()]) - np.array(rgba[:3], dtype=float)).max() < 20
        )


def test_a_gap_in_a_line_is_not_drawn_over(view):
    line = [(50, 150), (100, 150), (np.nan, np.nan), (300, 150), (350, 150)]
    view.set_lines("sweep", [line, np.zeros((0, 2))], colour=["#ff0000", "#00ff00"], labels=["1", "2"], width=6)
    assert colour_at(view, 75, 150) == QColor("#ff0000")
    assert colour_at(view, 200, 150).red() == 40


def test_every_kind_of_layer_draws_empty_and_full(view):
    for uv in (np.zeros((0, 2)), np.array([[10.0, 10.0], [np.nan, np.nan], [390.0, 290.0]])):
        view.set_points("points", uv, colour="#ff0000", tips=["a"] * len(uv))
        view.set_lines("lines", [uv] if len(uv) else [], values=[np.arange(len(uv))] if len(uv) else [])
        view.set_vectors("vectors", uv, uv, factor=2)
        view.set_polygon("region", uv[np.isfinite(uv).all(axis=1)], editable=True)
        view.set_cells("cells", np.eye(len(uv) + 1, dtype=bool))
        view.canvas.grab()


def test_covered_cells_are_tinted_over_the_whole_picture(view):
    view.set_cells("covered", [[True, False]], "#00ff00")
    assert colour_at(view, 20, 150).green() > colour_at(view, 20, 150).red() + 30
    assert colour_at(view, 380, 150).green() == 40


def test_clicking_a_point_names_layer_and_index(qtbot, view):
    view.set_points("low", [(100, 100)], colour="red")
    view.set_points("high", [(300, 200), (100, 101)], colour="green", title="High")
    with qtbot.waitSignal(view.point_clicked) as said:
        click(qtbot, view, 100, 100)
    assert said.args == ["high", 1]
    hide(view, "High")
    with qtbot.waitSignal(view.point_clicked) as said:
        click(qtbot, view, 100, 100)
    assert said.args == ["low", 0]
    with qtbot.assertNotEmitted(view.point_clicked):
        click(qtbot, view, 200, 250)


def test_a_polygon_is_drawn_by_clicks_and_closed_by_a_double_click(qtbot, view):
    view.start_polygon("upper face")
    click(qtbot, view, 100, 100)
    qtbot.wait(15)
    click(qtbot, view, 300, 100)
    qtbot.wait(15)
    with qtbot.waitSignal(view.polygon_drawn) as said:
        click(qtbot, view, 300, 200)
        qtbot.mouseDClick(view.canvas, LEFT, pos=view.to_screen(300, 200))
        qtbot.mouseRelease(view.canvas, LEFT, pos=view.to_screen(300, 200))
    name, corners = said.args
    assert name == "upper face"
    assert corners == pytest.approx(np.array([(100, 100), (300, 100), (300, 200)]), abs=1.0)


def test_backspace_takes_a_corner_back_enter_closes_and_escape_cancels(qtbot, view):
    view.start_polygon("region")
    for place in ((100, 100), (300, 100), (300, 200), (50, 250)):
        click(qtbot, view, *place)
        qtbot.wait(15)
    qtbot.keyClick(view, Qt.Key.Key_Backspace)
    with qtbot.waitSignal(view.polygon_drawn) as said:
        qtbot.keyClick(view, Qt.Key.Key_Return)
    assert len(said.args[1]) == 3
    view.start_polygon("another")
    with qtbot.waitSignal(view.drawing_cancelled) as cancelled, qtbot.assertNotEmitted(view.polygon_drawn):
        qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert cancelled.args == ["another"]


def test_two_corners_are_no_region(qtbot, view):
    view.start_polygon("region")
    for place in ((100, 100), (300, 100)):
        click(qtbot, view, *place)
    with qtbot.assertNotEmitted(view.polygon_drawn):
        qtbot.keyClick(view, Qt.Key.Key_Return)
    view.stop_drawing()
    view.stop_drawing()


def test_a_polygon_can_be_drawn_by_keys_alone(qtbot, view):
    view.start_polygon("region")
    with qtbot.waitSignal(view.polygon_drawn) as said:
        for key in (Qt.Key.Key_Right, Qt.Key.Key_Down, Qt.Key.Key_Left):
            qtbot.keyClick(view, key, Qt.KeyboardModifier.ShiftModifier)
            qtbot.keyClick(view, Qt.Key.Key_Space)
        qtbot.keyClick(view, Qt.Key.Key_Return)
    corners = said.args[1]
    assert np.diff(corners, axis=0) == pytest.approx(np.array([(0, 20), (-20, 0)]), abs=0.01)


def test_a_lasso_is_one_stroke(qtbot, view):
    view.start_lasso("region")
    with qtbot.waitSignal(view.polygon_drawn) as said:
        drag(qtbot, view, (100, 100), (200, 100), (300, 150), (200, 250), (120, 200))
    assert said.args[0] == "region"
    assert len(said.args[1]) >= 4
    assert said.args[1][0] == pytest.approx([100, 100], abs=1)


def test_corners_of_an_editable_region_and_the_whole_can_be_dragged(qtbot, view):
    corners = [(100, 100), (300, 100), (300, 200), (100, 200)]
    view.set_polygon("region", corners, editable=True)
    with qtbot.waitSignal(view.polygon_edited) as said:
        drag(qtbot, view, (300, 200), (310, 205), (320, 230))
    assert said.args[0] == "region"
    assert said.args[1][2] == pytest.approx([320, 230], abs=1.5)
    assert said.args[1][:2] == pytest.approx(np.array(corners[:2]), abs=0.1)
    middle = said.args[1].mean(axis=0)
    with qtbot.waitSignal(view.polygon_edited) as said:
        drag(qtbot, view, tuple(middle), tuple(middle + [5, 0]), tuple(middle + [20, 10]))
    assert said.args[1][0] == pytest.approx([120, 110], abs=1.5)


def test_a_region_that_is_not_editable_stays(qtbot, view):
    view.set_polygon("region", [(100, 100), (300, 100), (300, 200)])
    with qtbot.assertNotEmitted(view.polygon_edited):
        drag(qtbot, view, (300, 200), (310, 205), (320, 230))


def test_the_ground_follows_the_theme(theme, view):
    shown = []
    view.set_picture(np.zeros((30, 300), dtype=np.uint8))
    for name in ("light", "dark"):
        theme(name)
        shown.append(view.canvas.grab().toImage().pixelColor(3, view.canvas.height() - 3).lightness())
    assert shown[0] > 180
    assert shown[1] < 60
