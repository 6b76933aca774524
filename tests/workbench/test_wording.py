"""Nothing in the window speaks of files and options that only the command line has."""

from __future__ import annotations

import re

import pytest

import workbench.language
from core.errors import InputError
from core.files.atomic import ANOTHER_OUT
from core.inspect.faces import region_field
from core.messages import Command, Field, Message
from core.report.facts.of_gauge import gauge_facts
from core.translations import language
from tests.workbench.pages.inspect_cases import gauge
from workbench.language import text_of
from workbench.pages.inspect.words import thickness
from workbench.pages.words import fact_row, mm
from workbench.views.scene.colours import ticks


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("[camera_target]", "check the target"),
        ("laser_fan.lines", "check the number of lines under Laser"),
        ("target.circles", "check columns and rows of the target"),
        ("target.inner_corners", "check columns and rows of the target"),
        ("target.dictionary", "check markers of the target"),
    ],
)
def test_a_field_of_a_file_is_called_as_in_the_window(key: str, said: str) -> None:
    assert text_of(Message("test.field", "check {field}", field=Field(key))) == said


def test_a_command_is_not_told() -> None:
    todo = Message("test.scan", "measure the scan first{command}", command=Command("trisect scan SET --out DIR"))
    missing = InputError(Message("test.missing", "the file is missing"), where="cloud.ply", todo=todo)
    assert text_of(missing) == "cloud.ply: the file is missing; measure the scan first."


def test_advice_of_an_option_is_advice_of_the_windows_own() -> None:
    full = InputError(Message("test.full", "cannot be written"), where="x", todo=ANOTHER_OUT)
    assert text_of(full).endswith("copy the project to another disk and open it there.")
    assert str(full).endswith("choose another folder with --out.")


def test_the_regions_of_faces_are_called_as_in_the_window() -> None:
    exchange = Message("gauge.advice_exchange_faces", "exchange upper_polygon_px and lower_polygon_px")
    exchanged = InputError(Message("test.behind", "it lies behind"), where=region_field("upper"), todo=exchange)
    assert text_of(exchanged) == "region of the upper face: it lies behind; exchange the two regions."
    twice = InputError(Message("test.twice", "it is none"), where=region_field("lower"))
    assert text_of(twice.message) == "region of the lower face: it is none."


def test_a_page_in_german_writes_all_its_numbers_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workbench.language, "_chosen", language("de"))
    measured = gauge()
    said = [
        *(fact_row(fact)[1] for fact in gauge_facts(measured)),
        thickness(measured),
        mm(0.125),
        *ticks(-0.5, 0.5, 5)[1],
    ]
    assert not [one for one in said if re.search(r"\d\.\d|-\d", one)]
    assert "50,012 mm ± 0,024 mm (k = 2)" in said
