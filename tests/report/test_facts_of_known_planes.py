"""What is told of the known planes in a scan: how points and fan agree with them."""

from dataclasses import replace

import numpy as np
import pytest

from core.messages import NO_BREAK_SPACE
from core.report.facts.fact import Reader, for_reader
from core.report.facts.of_scan import plane_check_facts, plane_tables
from core.report.pdf import build_report
from core.report.wording import Words
from core.scan.known_planes.points_on_planes import PlaneAgreement
from core.scan.plane_check import PlaneCheck, PlaneOff
from tests.report.report_samples import block_content
from tests.report.test_report_pdf import words

WORDS = Words.of("en")
PLATE = PlaneAgreement("plate", 1234, 20, 7, 0.0123, np.array([0, 0, 0.002]), np.zeros((4, 2)))
CHECK = PlaneCheck((PlaneOff("plate", -0.012, 0.001, 0.8), PlaneOff("knocked", 0.4, 0.002, 9.0)), 5.25, 6, 0.954)


def test_each_board_has_a_row_with_its_points_and_how_far_the_fan_is_off_it():
    (table,) = plane_tables((PLATE,), CHECK)
    assert table.texts(WORDS) == [
        ["plate", f"1{NO_BREAK_SPACE}234", "7", "0.012", "−0.012", "0.057"],
        ["knocked", "", "", "", "+0.400", "0.115"],
    ]
    (alone,) = plane_tables((PLATE,), None)
    assert alone.texts(WORDS)[0][4:] == ["", ""]
    assert plane_tables((), None) == ()


def test_the_check_tells_chance_and_what_it_sees():
    facts = {str(one.label): one.text(WORDS) for one in for_reader(plane_check_facts(CHECK), Reader.METROLOGIST)}
    assert facts["chance"].startswith("0.51")
    assert facts["changes it would show"] == "95 %"
    assert facts["fan against planes: χ²"] == "5.2"
    assert plane_check_facts(None) == ()


@pytest.mark.parametrize("planes", [(), (PLATE,)])
def test_the_report_prints_them(planes):
    content = replace(block_content(), known_planes=planes, plane_check=CHECK if planes else None)
    printed = words(build_report(content))
    assert ("changes it would show" in printed.lower()) == bool(planes)
    assert ("known plane" in printed.lower() and "knocked" in printed) == bool(planes)
