import numpy as np
from PySide6.QtGui import QColor

from workbench.views.colours import (
    CROSSING_GOOD,
    CROSSING_LEFT_OUT,
    CROSSING_WEAK,
    EXCLUDED,
    FAN,
    fan_colour,
    sigma_table,
    to_rgba,
)


def test_small_sigma_is_blue_and_the_limit_yellow():
    colours = sigma_table()
    assert colours.shape == (256, 4)
    assert colours.dtype == np.uint8
    assert colours[0, 2] > colours[0, 0]
    assert colours[-1, 0] > 200 > colours[-1, 2]


def test_crossings_differ_by_symbol_as_well_as_by_colour():
    marks = (CROSSING_GOOD, CROSSING_WEAK, CROSSING_LEFT_OUT)
    assert len({mark.symbol for mark in marks}) == 3
    assert len({mark.colour for mark in marks}) == 3


def test_fan_lines_repeat_their_colours():
    assert [fan_colour(line) for line in (1, 2, 3, 4)] == [*FAN, FAN[0]]


def test_every_meaning_is_readable_on_a_dark_picture():
    for colour in (*FAN, EXCLUDED, CROSSING_GOOD.colour, CROSSING_WEAK.colour, CROSSING_LEFT_OUT.colour):
        assert QColor(colour).lightnessF() > 0.4


def test_colours_may_be_named_in_any_way():
    assert to_rgba("#ff8000") == to_rgba((255, 128, 0)) == to_rgba(QColor(255, 128, 0)) == (255, 128, 0, 255)
    assert to_rgba((1, 2, 3, 4)) == (1, 2, 3, 4)
