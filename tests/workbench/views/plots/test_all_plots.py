import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QScrollArea, QVBoxLayout, QWidget

from workbench.theme import DARK, LIGHT
from workbench.views.plots.bars import Bar, BarsWithThreshold
from workbench.views.plots.base import written
from workbench.views.plots.lines import LineChart
from workbench.views.plots.map import HeatMap
from workbench.views.plots.residuals import ResidualPlot
from workbench.views.plots.runs import Histogram, RunChart

LEFT = Qt.MouseButton.LeftButton
BARS = [Bar("view1", 0.1), Bar("view2", 0.4, tip="tilted"), Bar("view3", 0.2, used=False), Bar("view4", None)]


def shown(qtbot, plot):
    plot.resize(500, 300)
    qtbot.addWidget(plot)
    plot.show()
    qtbot.waitExposed(plot)
    return plot


def filled(kind):
    """One plot of each kind with something in it."""
    plot = kind()
    uv = np.array([(100.0, 100.0), (300.0, 200.0), (50.0, 250.0)])
    if kind is BarsWithThreshold:
        plot.set_bars(BARS, label="RMS", unit="px", threshold=0.3)
    elif kind is ResidualPlot:
        plot.set_residuals(uv, uv / 1000, size=(400, 300), rms=0.2, counted=[True, True, False])
    elif kind is RunChart:
        plot.set_runs([50.01, 49.99], [0.03, 0.04], mean=50.0, nominal=50.0, tolerance=0.2)
    elif kind is Histogram:
        plot.set_values([0.01, 0.02, np.nan, 0.02], label="σ", unit="mm", limits=[(0.05, "limit 0.05 mm")])
    elif kind is HeatMap:
        plot.set_map([[0.01, np.nan], [0.02, 0.03]], size=(400, 300), label="error", unit="mm")
    else:
        plot.set_axes("time", "s", "speed", "mm/s")
        plot.set_curve("speed", [0, 1, 2], [3, np.nan, 5], title="Speed")
    return plot


KINDS = [BarsWithThreshold, ResidualPlot, RunChart, Histogram, HeatMap, LineChart]


@pytest.mark.parametrize("kind", KINDS)
def test_every_plot_follows_the_theme(qtbot, theme, kind):
    plot = shown(qtbot, filled(kind))
    for name, shades in (("light", LIGHT), ("dark", DARK)):
        theme(name)
        image = plot.canvas.grab().toImage()
        assert image.pixelColor(1, 1).name() == shades.panel


@pytest.mark.parametrize("kind", KINDS)
def test_every_plot_says_a_sentence_while_it_is_empty(qtbot, theme, kind):
    plot = shown(qtbot, kind())
    plot.clear("Solve the camera first.")
    assert plot.empty_state.isVisible()
    assert plot.empty_state.message == "Solve the camera first."
    theme("dark")
    assert plot.empty_state.isVisible()


@pytest.mark.parametrize("kind", KINDS)
def test_every_plot_can_be_emptied_and_filled_again(qtbot, kind):
    plot = shown(qtbot, filled(kind))
    assert not plot.empty_state.isVisible()
    plot.clear()
    assert plot.empty_state.isVisible()


@pytest.mark.parametrize("kind", KINDS)
def test_axes_have_units_and_no_prefixes(qtbot, kind):
    plot = shown(qtbot, filled(kind))
    plot.canvas.grab()
    assert "[" in plot.axis_text("left") + plot.axis_text("bottom")
    for side in ("left", "bottom"):
        assert plot._item.getAxis(side).autoSIPrefixScale == 1.0


def test_counts_begin_at_zero_and_numbers_have_a_true_minus(qtbot):
    chart = LineChart()
    qtbot.addWidget(chart)
    chart.set_axes("deviation", "mm", "places", "", from_zero=True)
    chart.set_curve("histogram", [-1.0, 0.0, 1.0], [0.0, 40.0, 2.0])
    low, high = chart._box.viewRange()[1]
    assert low == pytest.approx(0.0, abs=0.02 * 40) and high > 40
    assert chart._item.getAxis("bottom").tickStrings([-0.5, 0.5], 1.0, 0.5) == ["−0.5", "0.5"]


@pytest.mark.parametrize("high", [(60.0, 100.0), (0.0, 40.0), (20.0, 45.0), (55.0, 70.0)])
def test_the_legend_of_curves_stands_where_there_are_fewest_of_their_points(qtbot, high):
    chart = shown(qtbot, LineChart())
    chart.resize(420, 240)
    chart.set_axes("along the cut", "mm", "height", "mm")
    x = np.linspace(0.0, 100.0, 201)
    top = np.where((x >= high[0]) & (x <= high[1]), 50.0, 0.0)
    chart.set_curve("points", x, top, title="points near the cut", points=True)
    chart.set_curve("median", x, top, title="their median over each step")
    chart.canvas.grab()
    legend, box = (item.sceneBoundingRect().center() for item in (chart._legend, chart._box))
    assert (legend.x() < box.x()) is (high[0] + high[1] > 100.0)
    assert legend.y() < box.y()


def test_numbers_at_an_axis_have_as_many_decimals(qtbot):
    for limits in ((49.75, 50.25), (-0.15, 0.15), (0.0, 3.0)):
        chart = shown(qtbot, LineChart())
        chart.resize(300, 700)
        chart.set_axes("scan", "", "thickness", "mm")
        chart.set_curve("runs", [1, 2], limits)
        chart.canvas.grab()
        axis, image = chart._item.getAxis("left"), QImage(10, 10, QImage.Format.Format_RGB32)
        painter = QPainter(image)
        texts = [text for *_, text in axis.generateDrawSpecs(painter)[2]]
        painter.end()
        assert len(texts) > 2 and len({len(text.partition(".")[2]) for text in texts}) == 1, texts


def test_the_wheel_is_left_to_the_panel_around_a_plot(qtbot):
    inside = QWidget()
    column = QVBoxLayout(inside)
    plot = filled(BarsWithThreshold)
    column.addWidget(plot)
    column.addSpacing(2000)
    panel = QScrollArea()
    panel.setWidget(inside)
    panel.setWidgetResizable(True)
    shown(qtbot, panel)
    QTest.wheelEvent(panel.windowHandle(), QPointF(100, 100), QPoint(0, -240))
    assert panel.verticalScrollBar().value() > 0


def test_the_threshold_is_dragged_and_told_when_let_go(qtbot):
    plot = shown(qtbot, filled(BarsWithThreshold))
    moving, changed = [], []
    plot.threshold_moving.connect(moving.append)
    plot.threshold_changed.connect(changed.append)
    start, end = (plot.to_screen(0.5, y).toPoint() for y in (0.3, 0.2))
    qtbot.mouseMove(plot.canvas, start)
    qtbot.wait(15)
    qtbot.mousePress(plot.canvas, LEFT, pos=start)
    for share in (0.3, 0.6, 1.0):
        qtbot.wait(15)
        qtbot.mouseMove(plot.canvas, start + (end - start) * share)
    assert changed == []
    qtbot.mouseRelease(plot.canvas, LEFT, pos=end)
    assert moving
    assert changed == [pytest.approx(0.2, abs=0.01)]
    assert plot.threshold == changed[0]


def test_the_threshold_says_what_it_does(qtbot):
    plot = shown(qtbot, filled(BarsWithThreshold))
    assert plot._line.label.toPlainText() == "left out above 0.300 px"


def test_the_threshold_moves_by_keys_as_well(qtbot):
    plot = shown(qtbot, filled(BarsWithThreshold))
    with qtbot.waitSignal(plot.threshold_changed) as said:
        qtbot.keyClick(plot, Qt.Key.Key_Down)
    assert 0.28 < said.args[0] < 0.3


def test_bars_are_gone_to_by_click_and_by_key(qtbot):
    plot = shown(qtbot, filled(BarsWithThreshold))
    with qtbot.waitSignal(plot.bar_clicked) as said:
        qtbot.mouseClick(plot.canvas, LEFT, pos=plot.to_screen(1, 0.1).toPoint())
    assert said.args == ["view2"]
    with qtbot.waitSignal(plot.bar_clicked) as said:
        qtbot.keyClick(plot, Qt.Key.Key_Right)
    assert said.args == ["view3"]


def test_hovering_over_a_bar_names_it(qtbot):
    plot = shown(qtbot, filled(BarsWithThreshold))
    assert plot._tip(1.2, 0.1) == "view2: 0.400 px\ntilted"
    assert plot._tip(3, 0.1) == "view4: no value"
    assert plot._tip(7, 0.1) == ""


def test_bars_without_a_threshold_have_no_line(qtbot):
    plot = BarsWithThreshold()
    shown(qtbot, plot)
    plot.set_bars(BARS, label="RMS", unit="mm")
    assert plot.threshold is None
    with qtbot.assertNotEmitted(plot.threshold_changed):
        qtbot.keyClick(plot, Qt.Key.Key_Up)


def test_residuals_are_enlarged_so_that_they_can_be_seen(qtbot):
    plot = shown(qtbot, filled(ResidualPlot))
    assert plot.factor_used == 50
    plot.factor.setCurrentIndex(plot.factor.findData(200))
    assert plot.factor_used == 200
    plot.kind.setCurrentIndex(1)
    assert plot.axis_text("bottom") == "residual in u [px]"
    assert not plot.factor.isEnabled()


def test_residuals_of_a_view_without_a_pose_are_left_out(qtbot):
    plot = shown(qtbot, ResidualPlot())
    plot.set_residuals([(1, 1), (2, 2)], np.full((2, 2), np.nan), size=(40, 30))
    assert plot.empty_state.isVisible()


def test_a_run_is_told_on_hover_with_its_uncertainty(qtbot):
    plot = shown(qtbot, filled(RunChart))
    assert plot._tip(1.1, 50.0) == "1: 50.010 ± 0.030 mm (k = 2)"
    assert "k = 2" in plot.axis_text("left")


def test_a_map_is_read_cell_by_cell(qtbot):
    plot = shown(qtbot, filled(HeatMap))
    assert plot._tip(10, 10).endswith("0.01000 mm")
    assert plot._tip(300, 10).endswith("no value")
    assert plot._tip(-5, 10) == ""
    assert plot.bar.title == "error [mm]"


def test_a_map_of_one_value_has_a_scale_too(qtbot):
    plot = shown(qtbot, HeatMap())
    plot.set_map(np.full((2, 2), 0.02), size=(400, 300), label="error", unit="mm", colour_map="sigma")
    plot.grab()


def test_numbers_have_the_decimals_their_step_needs():
    assert written(0.123456, 0.001) == "0.123"
    assert written(-12.0, 5) == "−12"
    assert written(0.5, 0.5) == "0.5"
