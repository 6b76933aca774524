"""Parts from CAD: a plate of 60 × 40 × 20 mm with a hole of radius 10 mm through its thickness at (20, 20) mm."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from core.errors import Cancelled, InputError, WrongValue
from core.files.cad_part import read_corners
from core.files.results.nominal_surface import read_nominal, read_nominals
from core.inspect.plan.feature_spec import Deviation, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.scan.surface.triangles import Triangles

PLATE = Path(__file__).parent / "plate_with_hole.step"
RADIUS_MM = 10.0


def of_the_hole(corners):
    """Corners (T, 3, 3) of the triangles that stand for the hole's wall, from its axis."""
    from_axis = corners - [20.0, 20.0, 0.0]
    on_wall = np.abs(np.hypot(from_axis[..., 0], from_axis[..., 1]) - RADIUS_MM) < 1e-4
    return from_axis[on_wall.all(axis=1)]


@pytest.mark.parametrize("chord_mm", [0.1, 0.01])
def test_a_curved_face_is_as_near_as_was_asked(chord_mm):
    wall = of_the_hole(read_corners(PLATE, chord_mm))
    middles = (wall + np.roll(wall, 1, axis=1)) / 2
    off = RADIUS_MM - np.hypot(middles[..., 0], middles[..., 1]).min()
    assert chord_mm / 10 < off <= chord_mm


def test_its_volume_is_that_of_the_part_seen_from_outside():
    first, second, third = np.moveaxis(read_corners(PLATE, 0.001), 1, 0)
    volume = np.einsum("ij,ij->", first, np.cross(second, third)) / 6
    assert volume == pytest.approx(20 * (60 * 40 - np.pi * RADIUS_MM**2), rel=2e-4)


def test_a_file_in_inches_is_read_in_mm(tmp_path):
    inches = tmp_path / "plate.STP"
    text = PLATE.read_text(encoding="ascii")
    unit = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"
    assert unit in text
    of_an_inch = "( CONVERSION_BASED_UNIT('INCH',#9002) LENGTH_UNIT() NAMED_UNIT(#9001) )"
    more = (
        "#9000 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) );\n"
        "#9001 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
        "#9002 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(2.54E-02),#9000);\n"
    )
    head, end = text.replace(unit, of_an_inch).rsplit("ENDSEC;", 1)
    inches.write_text(head + more + "ENDSEC;" + end, encoding="ascii")
    size = np.ptp(read_nominal(inches, 1.0).corners.reshape(-1, 3), axis=0)
    np.testing.assert_allclose(size, np.array([60, 40, 20]) * 25.4, rtol=1e-5)


@pytest.mark.parametrize("content", ["", "hello", PLATE.read_text(encoding="ascii")[:9000]])
def test_what_is_no_part_is_refused_in_one_sentence_and_nothing_is_printed(content, tmp_path, capfd):
    spoilt = tmp_path / "part.step"
    spoilt.write_text(content, encoding="ascii")
    with pytest.raises(
        InputError, match=r"part\.step: no surface can be read from it \(it is damaged, or no STEP file\)"
    ):
        read_nominal(spoilt, 0.1)
    assert capfd.readouterr() == ("", "")


def test_a_file_without_faces_is_refused(tmp_path):
    spoilt = tmp_path / "part.step"
    spoilt.write_text(PLATE.read_text(encoding="ascii").replace("ADVANCED_FACE", "UNKNOWN_FACE"), encoding="ascii")
    with pytest.raises(WrongValue):
        read_corners(spoilt, 0.01)


def test_reading_can_be_cancelled():
    def cancel(step, done, total):
        raise Cancelled

    with pytest.raises(Cancelled):
        read_corners(PLATE, 0.01, cancel)


def test_without_its_extra_one_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "cascadio", None)
    with pytest.raises(InputError, match=r"pip install -e '\.\[step\]'"):
        read_nominal(PLATE, 0.1)


def test_a_surface_of_several_features_is_as_fine_as_the_smallest_tolerance_wants():
    plan = InspectionPlan(
        features=tuple(
            FeatureSpec(f"shape {tolerance}", "deviation", deviation=Deviation(str(PLATE), tolerance_mm=tolerance))
            for tolerance in (0.5, 0.05)
        )
    )
    surface = read_nominals(plan, Path())[str(PLATE)]
    assert isinstance(surface, Triangles)
    assert surface.chord_mm == pytest.approx(0.005)
