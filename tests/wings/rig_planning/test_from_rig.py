import math

import pytest

from core.calibrate.change import DEFAULT_STABILITY
from core.errors import InputError
from core.files.recording.rig import read_rig
from core.image.targets import Charuco
from core.simulate.calibration import rig_toml
from core.simulate.scenario import Scenario
from core.wings.rig_planning.prediction.design import Design
from core.wings.rig_planning.prediction.from_rig import read_design, read_stated


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "rig.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_the_rig_toml_of_a_recording_set_is_a_plan_of_the_papers_rig(write):
    path = write(rig_toml(Scenario(height_mm=40.0)))

    assert read_design(path) == Design(heights_mm=(40.0,))
    assert read_design(path.parent) == Design(heights_mm=(40.0,)), "the folder will do"


def test_an_empty_file_is_the_papers_rig(write):
    assert read_design(write("")) == Design()


def test_its_own_table_says_what_differs(write):
    design = read_design(
        write(
            '[camera_target]\nkind = "charuco"\nsquares = [12, 9]\nsquare_mm = 15.0\nmarker_mm = 11.25\n'
            "[laser_fan]\nlines = 2\nangle_deg = 7.0\n"
            "[plan]\npixels = [1920, 1200]\npixel_um = 3.45\nfocal_px = 2000\nheights_mm = [10, 20]\nposes = 15\n"
        )
    )

    assert design.pixels == (1920, 1200)
    assert design.focal_px == pytest.approx(2000)
    assert design.focal_mm == pytest.approx(6.9)
    assert (design.lines, design.angle_deg, design.poses) == (2, 7.0, 15)
    assert design.heights_mm == (10.0, 20.0)
    assert isinstance(design.camera_target, Charuco)


def test_other_commands_read_a_rig_toml_with_a_plan_in_it(write):
    with_plan, without = rig_toml(Scenario()) + "[plan]\nsweeps = 30\n", rig_toml(Scenario())

    assert read_rig(write(with_plan)) == read_rig(write(without))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[plan]\nbase_line_mm = 80\n", "did you mean baseline_mm"),
        ("[plan]\nfocal_mm = 8\nfocal_px = 4000\n", "give focal_mm or focal_px"),
        ("[plan]\npixels = [1920]\n", "width, height"),
        ("[plan]\nposes = 3.5\n", "a whole number"),
        ("[plan]\ndistance_mm = -4\n", "distance_mm"),
        ("[plan]\npixel_um = 900\n", "from 0.5 to 50 µm"),
        ("[plan]\nheights_mm = [800]\n", "above the table"),
        ("[plan\n", "no valid TOML"),
        ("[planning]\nposes = 3\n", "unknown key"),
    ],
)
def test_a_wrong_key_or_value_is_told_in_one_sentence_with_file_and_field(write, text, told):
    path = write(text)
    with pytest.raises(InputError) as error:
        read_design(path)
    sentence = str(error.value)
    assert told in sentence
    assert str(path) in sentence
    assert "\n" not in sentence


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(InputError, match="missing"):
        read_design(tmp_path / "rig.toml")


def test_a_rig_that_is_planned_warmer_than_it_is_calibrated_may_change_more(write):
    stated = "[stability.per_kelvin]\nturn_urad = 40.0\n[air]\ncalibrated_celsius = 20.0\n"
    usual, warm = (read_stated(write(stated + more))[1] for more in ("", "scanned_celsius = 30.0\n"))
    assert usual is not None and warm is not None
    assert usual.turn == pytest.approx(math.hypot(DEFAULT_STABILITY.turn, 200e-6)), "five kelvins where none are stated"
    assert warm.turn == pytest.approx(math.hypot(DEFAULT_STABILITY.turn, 400e-6))
