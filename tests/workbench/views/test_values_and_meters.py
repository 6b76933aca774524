import pytest
from PySide6.QtWidgets import QApplication

from workbench.views.lists.value_rows import LEVEL_ICONS, NAME_PX, VALUE_PX, ValueRows, Verdict
from workbench.views.plots.meters import HintBar, Meter


def test_values_are_shown_beside_their_labels_and_rows_may_go(qtbot, theme):
    rows = ValueRows()
    qtbot.addWidget(rows)
    rows.set_rows(
        [("RMS", "0.11 px", "", ""), ("Coverage", "93 %", "at least 80 %", "good"), ("Views", "8", "", "bad")]
    )
    rows.show()
    qtbot.waitExposed(rows)
    assert rows.text_of("Coverage") == "93 %"
    tall = rows.sizeHint().height()
    rows.set_rows([("RMS", "0.12 px", "", "warn")])
    assert rows.text_of("RMS") == "0.12 px"
    assert rows.text_of("Coverage") == ""
    assert rows.sizeHint().height() < tall
    theme("dark")
    theme("light")


def test_a_level_is_told_by_an_icon_and_in_words_too(qtbot):
    rows = ValueRows()
    qtbot.addWidget(rows)
    rows.set_rows([("Coverage", "93 %", "at least 80 %", "good"), ("Skew", "0.1 px", "", "")])
    (_, value, sign), (_, _, no_sign) = rows._labels
    assert sign.shown == LEVEL_ICONS["good"]
    assert no_sign.shown == ("", "")
    assert value.accessibleDescription() == "good: at least 80 %"


@pytest.mark.parametrize("kind", ["", "conforming", "not conforming", "not proven"])
def test_a_verdict_is_a_word_and_a_sentence(qtbot, theme, kind):
    verdict = Verdict()
    qtbot.addWidget(verdict)
    verdict.set_verdict(kind, "50.004 mm ± 0.035 mm (k = 2).")
    verdict.show()
    qtbot.waitExposed(verdict)
    theme("dark")
    assert verdict.text.lower() == (kind or "no verdict")
    assert verdict.accessibleName() == verdict.text


def test_a_meter_names_its_zone(qtbot, theme):
    meter = Meter("Speed", [(3, "warn"), (20, "good"), (40, "bad")])
    qtbot.addWidget(meter)
    meter.show()
    qtbot.waitExposed(meter)
    for value, said in ((2, "2 mm/s · fair"), (3.1, "2 mm/s · good"), (99, "2 mm/s · poor")):
        meter.set_value(value, "2 mm/s")
        assert meter.value_text == said
    for unknown in (None, float("nan")):
        meter.set_value(unknown)
        assert meter.value_text == "–"
        meter.grab()
    theme("dark")


def test_a_meter_may_be_logarithmic(qtbot):
    meter = Meter("Condition", [(10, "good"), (100, "bad")], minimum=1, logarithmic=True)
    qtbot.addWidget(meter)
    assert meter.share(10) == pytest.approx(0.5)
    assert meter.share(0.1) == 0
    assert meter.share(1e9) == 1


@pytest.mark.parametrize(
    ("zones", "options"),
    [
        ([], {}),
        ([(3, "good"), (2, "bad")], {}),
        ([(3, "good")], {"logarithmic": True}),
        ([(3, "good")], {"minimum": 5}),
    ],
)
def test_zones_that_make_no_scale_are_refused(qapp, zones, options):
    with pytest.raises(ValueError, match="no scale"):
        Meter("Speed", zones, **options)


def test_a_hint_stays_for_a_second(qtbot):
    bar = HintBar()
    qtbot.addWidget(bar)
    bar.show()
    qtbot.waitExposed(bar)
    bar.set_hints(["Move more slowly."])
    assert bar.text == "Move more slowly."
    bar.set_hints(["Cross more of the fan.", "Tilt more."])
    qtbot.wait(300)
    assert bar.text == "Move more slowly."
    qtbot.waitUntil(lambda: bar.text == "Cross more of the fan.   Tilt more.", timeout=1500)


def test_a_hint_that_comes_back_at_once_does_not_flicker(qtbot):
    bar = HintBar()
    qtbot.addWidget(bar)
    bar.set_hints(["Move more slowly."])
    bar.set_hints([])
    bar.set_hints(["Move more slowly."])
    assert bar.text == "Move more slowly."
    qtbot.wait(1100)
    assert bar.text == "Move more slowly."


def test_a_hidden_hint_bar_keeps_no_clock_running(qtbot):
    bar = HintBar()
    qtbot.addWidget(bar)
    bar.show()
    bar.set_hints(["a"])
    bar.set_hints(["b"])
    bar.hide()
    assert not bar._steady._clock.isActive()


def test_a_long_value_takes_several_lines_where_there_is_no_room_for_one(qtbot):
    rows, long = ValueRows(), "3.0 % of the places, mean −0.018 mm, at most −0.046 mm"
    qtbot.addWidget(rows)
    rows.set_rows([("Less material", long, "", "warn"), ("Detectable from", "0.020 mm", "", "")])
    rows.show()
    assert rows.minimumSizeHint().width() < NAME_PX + VALUE_PX + 50
    value = rows._labels[0][1]
    lines = []
    for width in (rows.minimumSizeHint().width(), 700):
        rows.resize(width, 200)
        QApplication.processEvents()
        assert value.height() >= value.heightForWidth(value.width()), "nothing is cut off"
        lines.append(value.heightForWidth(value.width()) // value.fontMetrics().height())
    assert lines[0] > lines[1] == 1
    assert rows.text_of("Less material") == long


def test_a_long_value_without_a_blank_is_not_cut(qtbot):
    rows = ValueRows()
    qtbot.addWidget(rows)
    rows.set_rows([("Surface", "a_surface_of_the_part_as_designed_second_revision.stl of 2026", "", "")])
    rows.show()
    rows.resize(rows.minimumSizeHint().width(), 200)
    QApplication.processEvents()
    value = rows._labels[0][1]
    assert value.width() >= value.fontMetrics().horizontalAdvance(value.text().split()[0]) > VALUE_PX
