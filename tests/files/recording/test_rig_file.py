import math
import re
from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from core.calibrate.board_shape import BoardTolerance
from core.errors import InputError
from core.files.recording.rig import (
    GaugeSpec,
    KnownPlaneTarget,
    ReferenceTarget,
    Rig,
    RigTables,
    as_calibrated_with,
    default_rig,
    part_of,
    part_table,
    read_rig,
    require_tables,
    rig_of,
    rig_tables,
    rig_to_toml,
)
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle
from core.inspect.uncertainty.part import Part, TargetTemperature
from core.model.certificate import Certificate

GOOD = """
[camera_target]
kind = "checkerboard"
inner_corners = [17, 12]
square_mm = 10.0
[plane_target]
kind = "black_square"
side_mm = 60.0
[laser_fan]
lines = 3
angle_deg = 5.0
[gauge]
nominal_mm = 50.0
tolerance_mm = 0.2
"""


def read(tmp_path, text):
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    return read_rig(tmp_path / "rig.toml")


def complaint(tmp_path, text):
    with pytest.raises(InputError) as error:
        read(tmp_path, text)
    sentence = str(error.value)
    assert "rig.toml" in sentence
    assert "\n" not in sentence
    assert sentence.endswith(".")
    return sentence


def test_the_rig_of_the_design_is_read(tmp_path):
    rig = read(tmp_path, GOOD)
    target = rig.camera_target
    assert isinstance(target, Checkerboard)
    assert (target.columns, target.rows, target.square_mm) == (17, 12, 10.0)
    assert isinstance(rig.plane_target, BlackSquare)
    assert rig.plane_target.side_mm == 60
    assert (rig.lines, rig.angle) == (3, math.radians(5))
    assert (rig.gauge.nominal_mm, rig.gauge.tolerance_mm) == (50.0, 0.2)
    assert rig.gauge.upper_polygon_px is None
    assert rig.channel is None


def test_every_kind_of_target_channel_and_polygons(tmp_path):
    rig = read(
        tmp_path,
        """
        channel = "green"
        [camera_target]
        kind = "charuco"
        squares = [9, 7]
        square_mm = 20
        marker_mm = 15
        dictionary = "DICT_5X5_100"
        [plane_target]
        kind = "circle_grid"
        circles = [7, 7]
        pitch_mm = 37.5
        [laser_fan]
        lines = 1
        [gauge]
        upper_polygon_px = [[0, 0], [10, 0], [10, 10]]
        lower_polygon_px = [[20, 0], [30, 0], [30, 10], [20.5, 10]]
        """,
    )
    assert isinstance(rig.camera_target, Charuco)
    assert rig.camera_target.dictionary == "DICT_5X5_100"
    assert isinstance(rig.plane_target, CircleGrid)
    assert not rig.plane_target.asymmetric
    assert (rig.lines, rig.angle, rig.channel) == (1, 0.0, "green")
    assert rig.gauge.nominal_mm is None
    assert np.array_equal(rig.gauge.lower_polygon_px[-1], [20.5, 10])


def test_how_true_the_targets_are_can_be_said(tmp_path):
    said = GOOD.replace("square_mm = 10.0", "square_mm = 10.0\nflatness_mm = 0.05\nscale_sd = 1e-4", 1)
    path = tmp_path / "rig.toml"
    path.write_text(said.replace("side_mm = 60.0", "side_mm = 60.0\nscale_sd = 2e-4\nflatness_mm = 0.1", 1))
    rig = read_rig(path)
    assert rig.camera_board == BoardTolerance(0.05, 1e-4)
    assert rig.plane_board == BoardTolerance(0.1, 2e-4)
    assert written(tmp_path, rig) == rig
    assert default_rig().camera_board == BoardTolerance()


def test_certificates_of_the_targets_can_be_said_and_no_calibration_rests_on_them(tmp_path):
    said = 'side_mm = 60.0\ncertificate = "D-K 7"\nlaboratory = "Labor Nord"\ndue = 2028-03-01'
    rig = read(tmp_path, GOOD.replace("side_mm = 60.0", said))
    assert rig.certificates == {"plane_target": Certificate("D-K 7", "Labor Nord", date(2028, 3, 1))}
    assert written(tmp_path, rig) == rig
    plain = as_calibrated_with(rig_tables(read(tmp_path, GOOD))["plane_target"])
    assert as_calibrated_with(rig_tables(rig)["plane_target"]) == plain
    assert not default_rig().certificates


def test_what_is_known_of_the_part_can_be_said(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        GOOD + '\n[part]\nmaterial = "wax"\noffset_mm = 0.12\noffset_sd_mm = 0.01\nspray_mm = 0.01\n'
        "spray_sd_mm = 0.003\nalpha_per_K = 1e-4\nu_alpha_per_K = 1e-5\ncelsius = 21.5\nu_celsius = 0.5\n"
    )
    rig = read_rig(path)
    assert rig.part == Part("wax", 0.12, 0.01, 0.01, 0.003, 1e-4, 1e-5, 21.5, 0.5)
    assert written(tmp_path, rig) == rig
    assert part_of(part_table(rig.part), path) == rig.part
    assert default_rig().part == Part() and part_table(Part()) == {}


def test_the_temperature_of_the_plane_target_can_be_said(tmp_path):
    said = "side_mm = 60.0\ncelsius = 23.0\nu_celsius = 0.5\nalpha_per_K = 24e-6\nu_alpha_per_K = 1e-6"
    rig = read(tmp_path, GOOD.replace("side_mm = 60.0", said) + '\n[part]\nmaterial = "steel"\n')
    assert rig.part == Part("steel", target=TargetTemperature(23.0, 0.5, 24e-6, 1e-6))
    assert written(tmp_path, rig) == rig
    assert part_of(part_table(rig.part), tmp_path) == rig.part
    half = complaint(tmp_path, GOOD.replace("side_mm = 60.0", "side_mm = 60.0\ncelsius = 23.0"))
    assert "u_celsius is missing" in half and "plane_target" in half


def test_a_target_of_known_size_to_compare_the_plane_target_with_can_be_said(tmp_path):
    reference = '[reference_target]\nkind = "black_square"\nside_mm = 36.0\nscale_sd = 1e-5\n'
    rig = read(tmp_path, GOOD + reference)
    assert rig.reference == ReferenceTarget(BlackSquare(36.0), BoardTolerance(scale_sd=1e-5))
    assert written(tmp_path, rig) == rig
    assert "as the plane target is" in complaint(tmp_path, GOOD + reference.replace("36", "60"))


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('material = "cheese"', ["part.material is cheese", "metal", "wax"]),
        ("celsius = 21", ["part.u_celsius is missing", "celsius go together"]),
        ("spray_sd_mm = 0.01", ["part.spray_mm is missing"]),
        ("celsius = 900\nu_celsius = 1", ["part.celsius is 900", "−50 to 200"]),
        ('colour = "red"', ["part.colour is an unknown key"]),
    ],
)
def test_a_wrong_part_is_refused_by_name(tmp_path, table, said):
    text = complaint(tmp_path, f"{GOOD}\n[part]\n{table}\n")
    assert all(one in text for one in said), text


def test_without_gauge(tmp_path):
    assert read(tmp_path, GOOD.partition("[gauge]")[0]).gauge is None


def test_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"rig\.toml: the file is missing"):
        read_rig(tmp_path / "rig.toml")


def test_text_that_is_no_toml_names_the_line(tmp_path):
    assert "line 3" in complaint(tmp_path, "a = 1\n[b]\nc = open\nd = 2")


def test_text_in_another_encoding_is_refused(tmp_path):
    (tmp_path / "rig.toml").write_bytes('channel = "grün"'.encode("latin-1"))
    with pytest.raises(InputError, match="UTF-8"):
        read_rig(tmp_path / "rig.toml")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("square_mm = 10.0", "squaremm = 10.0", ["camera_target.squaremm is an unknown key", "did you mean square_mm"]),
        ("[gauge]", "[gage]", ["gage is an unknown key", "did you mean gauge"]),
        ("[gauge]", "[zebra]\n[gauge]", ["zebra is an unknown key", "camera_target, plane_target, laser_fan"]),
        ("square_mm = 10.0", "", ["camera_target.square_mm is missing", "a length in mm above 0"]),
        ("square_mm = 10.0", 'square_mm = "10"', ['camera_target.square_mm is "10"', "a length in mm"]),
        ("square_mm = 10.0", "square_mm = -3", ["camera_target.square_mm is -3", "above 0 and at most 5000"]),
        ("square_mm = 10.0", "square_mm = nan", ["camera_target.square_mm is NaN", "above 0"]),
        ("square_mm = 10.0", "square_mm = 1e9", ["camera_target.square_mm is 1000000000.0", "at most 5000"]),
        ("square_mm = 10.0", "square_mm = 0.01", ["camera_target.square_mm is 0.01", "in mm: is it 10?"]),
        ("side_mm = 60.0", "side_mm = 0.06", ["plane_target.side_mm is 0.06", "is it 60?"]),
        ("square_mm = 10.0", "square_mm = true", ["camera_target.square_mm is true"]),
        ("square_mm = 10.0", "square_mm = 10.0\nflatness_mm = -1", ["camera_target.flatness_mm is -1", "0 to 100"]),
        ("side_mm = 60.0", "side_mm = 60.0\nscale_sd = 2", ["plane_target.scale_sd is 2", "0 to 0.1"]),
        ("[17, 12]", "[17]", ["camera_target.inner_corners is [17]", "[columns, rows]"]),
        ("[17, 12]", "[17, 12.5]", ["camera_target.inner_corners[1] is 12.5", "whole numbers from 3 to 500"]),
        ("[17, 12]", "[17, 0]", ["camera_target.inner_corners[1] is 0", "whole numbers from 3 to 500"]),
        ("[17, 12]", '"17x12"', ['camera_target.inner_corners is "17x12"']),
        ('"checkerboard"', '"chessboard"', ['kind is "chessboard"', '"checkerboard" or "charuco" or "circle_grid"']),
        ('kind = "black_square"', "", ["plane_target.kind is missing", '"black_square"']),
        ('"checkerboard"', '"black_square"', ['camera_target.kind is "black_square", not "checkerboard"']),
        ("lines = 3", "lines = 0", ["laser_fan.lines is 0", "from 1 to 20"]),
        ("lines = 3", "lines = 3.0", ["laser_fan.lines is 3.0", "whole number"]),
        ("angle_deg = 5.0", "angle_deg = 170", ["laser_fan.angle_deg is 170", "at most 45"]),
        ("angle_deg = 5.0", "", ["laser_fan.angle_deg is missing"]),
        ("tolerance_mm = 0.2", "", ["gauge.tolerance_mm is missing", "give both or neither"]),
        ("tolerance_mm = 0.2", "tolerance_mm = 0", ["gauge.tolerance_mm is 0"]),
        (
            "tolerance_mm = 0.2",
            "tolerance_mm = 0.2\nupper_polygon_px = [[1, 2], [3, 4]]",
            ["gauge.upper_polygon_px is"],
        ),
        (
            "tolerance_mm = 0.2",
            "tolerance_mm = 0.2\nupper_polygon_px = [[1, 2], [3, 4], [5, 6]]",
            ["gauge.lower_polygon_px is missing"],
        ),
        ("[camera_target]", 'channel = "infrared"\n[camera_target]', ['channel is "infrared"', '"red", "green"']),
    ],
)
def test_complaints_name_the_field_and_what_is_allowed(tmp_path, old, new, said):
    assert old in GOOD
    sentence = complaint(tmp_path, GOOD.replace(old, new, 1))
    for part in said:
        assert part in sentence


@pytest.mark.parametrize("name", ["DICT_APRILTAG_36h11", "DICT_APRILTAG_36H11"])
def test_april_tags_are_written_as_opencv_writes_them_or_in_capitals(tmp_path, name):
    board = f'kind = "charuco"\nsquares = [9, 7]\nsquare_mm = 20\nmarker_mm = 15\ndictionary = "{name}"\n'
    rig = read(tmp_path, GOOD.replace('kind = "checkerboard"\ninner_corners = [17, 12]\nsquare_mm = 10.0\n', board))
    assert rig.camera_target.dictionary == "DICT_APRILTAG_36H11", "as the window's list has it"


def test_marker_must_fit_its_square(tmp_path):
    board = 'kind = "charuco"\nsquares = [9, 7]\nsquare_mm = 20\nmarker_mm = 20\n'
    text = GOOD.replace('kind = "checkerboard"\ninner_corners = [17, 12]\nsquare_mm = 10.0\n', board)
    assert "camera_target.marker_mm is 20, not smaller than square_mm = 20" in complaint(tmp_path, text)


def test_a_table_given_as_a_number(tmp_path):
    assert "laser_fan is 3, not a table [laser_fan]" in complaint(
        tmp_path, "laser_fan = 3\n" + GOOD.replace("[laser_fan]\nlines = 3\nangle_deg = 5.0", "")
    )


def test_each_step_wants_its_own_tables_only(tmp_path):
    camera_only = GOOD.partition("[plane_target]")[0]
    rig = read(tmp_path, camera_only)
    assert rig.unstated == {"plane_target"}
    require_tables(rig, tmp_path / "rig.toml", "camera_target")
    with pytest.raises(InputError, match=r"plane_target is missing; it must be a table \[plane_target\]"):
        require_tables(rig, tmp_path / "rig.toml", "plane_target", "laser_fan")
    with pytest.raises(InputError, match=r"it has no table \[laser_fan\], which states that the rig has no fan"):
        require_tables(rig, tmp_path / "rig.toml", "laser_fan")
    assert read(tmp_path, rig_to_toml(rig)) == rig


def test_a_target_that_is_not_stated_is_not_the_same_as_one_that_is(tmp_path):
    """The paper's checkerboard stands in for a camera target that is not there."""
    board = 'kind = "checkerboard"\ninner_corners = [17, 12]\nsquare_mm = 10.0\n'
    both = read(tmp_path, f"[camera_target]\n{board}[plane_target]\n{board}")
    planes_only = read(tmp_path, f"[plane_target]\n{board}")
    assert both.one_target
    assert planes_only.camera_target == planes_only.plane_target
    assert not planes_only.one_target


def written(tmp_path, rig):
    (tmp_path / "rig.toml").write_text(rig_to_toml(rig), encoding="utf-8")
    return read_rig(tmp_path / "rig.toml")


POLYGONS = (
    np.array([[0.5, 0.0], [10.0, 1 / 3], [10.0, 10.0]]),
    np.array([[20, 0], [30, 0], [30, 10], [20.5, 10]]),
)


@pytest.mark.parametrize("target", [
    Checkerboard(17, 12, 10.0), Checkerboard(9, 6, 10 / 3), Charuco(9, 7, 20, 15, "DICT_5X5_100"),
    CircleGrid(7, 6, 37.5, asymmetric=True), CircleGrid(7, 7, 20.0), BlackSquare(60.0),
])  # fmt: skip
@pytest.mark.parametrize("gauge", [
    None, GaugeSpec(), GaugeSpec(50.0, 0.2), GaugeSpec(None, None, *POLYGONS), GaugeSpec(0.1 + 0.2, 1e-5, *POLYGONS),
])  # fmt: skip
@pytest.mark.parametrize("channel", [None, "red"])
def test_a_written_rig_reads_as_the_same_rig(tmp_path, target, gauge, channel):
    camera_target = Checkerboard(5, 4, 3.0) if isinstance(target, BlackSquare) else target
    rig = Rig(camera_target, target, 3, math.radians(5.0), gauge, channel)
    assert written(tmp_path, rig) == rig
    assert rig_of(RigTables.model_validate(rig_tables(rig)), tmp_path) == rig


@pytest.mark.parametrize("degrees", [5.0, 0.1, 1 / 3, 44.999, 7.3, 2.5000001])
def test_an_angle_in_degrees_comes_back_as_it_was_written(tmp_path, degrees):
    rig = Rig(Checkerboard(5, 4, 3.0), BlackSquare(60.0), 2, math.radians(degrees))
    assert written(tmp_path, rig) == rig
    assert math.radians(rig_tables(rig)["laser_fan"]["angle_deg"]) == rig.angle


def test_one_line_has_no_angle_and_keeps_one_it_was_given(tmp_path):
    alone = Rig(Checkerboard(5, 4, 3.0), BlackSquare(60.0), 1, 0.0)
    assert "angle_deg" not in rig_to_toml(alone)
    assert written(tmp_path, alone) == alone
    assert written(tmp_path, replace(alone, angle=math.radians(5.0))).angle == math.radians(5.0)


def test_the_rig_of_the_design_is_written_as_the_design_has_it():
    rig = replace(default_rig(), gauge=GaugeSpec(50.0, 0.2))
    lines = [line for line in rig_to_toml(rig).splitlines() if line]
    assert lines == GOOD.split("\n")[1:-1]


def test_the_default_rig_is_the_papers(tmp_path):
    assert default_rig() == read(tmp_path, GOOD.partition("[gauge]")[0])


def test_a_channel_stands_before_the_tables():
    assert rig_to_toml(replace(default_rig(), channel="red")).startswith('channel = "red"\n')


def test_rigs_are_equal_if_their_polygons_are():
    def rig(u):
        return replace(default_rig(), gauge=GaugeSpec(50.0, 0.2, np.array([[u, 0], [1, 0], [1, 1.0]]), POLYGONS[1]))

    assert rig(0) == rig(0)
    assert hash(rig(0)) == hash(rig(0))
    assert rig(0) != rig(0.25)
    assert rig(0) != replace(rig(0), gauge=GaugeSpec(50.0, 0.2))
    assert rig(0) != default_rig()
    assert GaugeSpec(50.0, 0.2) != GaugeSpec(50.0, 0.1)
    assert GaugeSpec() != "gauge"


def test_a_polygon_belongs_to_its_rig_alone():
    corners = np.array([[0, 0], [1, 0], [1, 1.0]])
    spec = GaugeSpec(upper_polygon_px=corners, lower_polygon_px=corners)
    corners[0, 0] = 7
    assert spec.upper_polygon_px[0, 0] == 0
    with pytest.raises(ValueError, match="read-only"):
        spec.upper_polygon_px[0, 0] = 7
    with pytest.raises(ValueError, match="upper_polygon_px has shape"):
        GaugeSpec(upper_polygon_px=np.zeros(6))


def test_each_step_may_have_a_channel_of_its_own(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('channel = "green"\n[channels]\ncamera = "blue"\nscan = "red"\n', encoding="utf-8")
    rig = read_rig(path)
    assert [rig.channel_of(part) for part in ("camera", "planes", "check", "scan")] == ["blue", "green", "green", "red"]
    path.write_text(rig_to_toml(rig), encoding="utf-8")
    assert read_rig(path) == rig


def test_an_unknown_channel_of_a_step_is_refused(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('[channels]\nscan = "violet"\n', encoding="utf-8")
    with pytest.raises(InputError, match="red"):
        read_rig(path)


def test_a_lasers_colour_may_be_a_difference_in_which_no_target_is_looked_for(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text('channel = "red-green"\n', encoding="utf-8")
    rig = read_rig(path)
    assert [rig.channel_of(part) for part in ("camera", "planes", "scan")] == [None, "red-green", "red-green"]
    assert rig.live_channel is None
    path.write_text('[channels]\ncamera = "red-green"\n', encoding="utf-8")
    with pytest.raises(InputError, match=re.escape("channels.camera")):
        read_rig(path)


def test_the_channel_of_one_step_changes_and_the_others_stay(tmp_path):
    rig = replace(default_rig(), channel="green").with_channel("scan", "blue-red")
    assert [rig.channel_of(part) for part in ("camera", "planes", "scan")] == ["green", "green", "blue-red"]
    assert rig.with_channel("scan", None).channel_of("scan") is None


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("turn_urad = 3.0", "stability.shift_um is missing; turn_urad, shift_um, centre_px, focal_ppm go together"),
        ("per_kelvin = { turn_urad = -3.0 }", "stability.per_kelvin.turn_urad is -3.0, not an angle in µrad"),
        ("per_hour = { turn_rad = 1.0 }", "stability.per_hour.turn_rad is an unknown key"),
        ("", "stability.turn_urad is missing"),
    ],
)
def test_what_is_wrong_with_a_stability_is_told_in_one_sentence(tmp_path, text, told):
    path = tmp_path / "rig.toml"
    path.write_text(f"[stability]\n{text}\n")
    with pytest.raises(InputError) as error:
        read_rig(path)
    assert told in str(error.value) and "\n" not in str(error.value)


def test_figures_for_each_kelvin_and_hour_may_stand_alone(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text("[stability.per_kelvin]\nturn_urad = 40.0\n[air]\nscanned_celsius = 24.5\n")
    rig = read_rig(path)
    assert rig.stability is None and rig.air.scanned == 24.5
    assert rig.drift.per_kelvin.turn == pytest.approx(40e-6) and not rig.drift.per_hour.turn
    path.write_text(rig_to_toml(rig))
    assert read_rig(path) == rig


WITHOUT_FAN = """
[camera_target]
kind = "checkerboard"
inner_corners = [17, 12]
square_mm = 10.0

[known_planes.wall]
kind = "rectangle"
size_mm = [250, 150.0]
line_mm = 10
corners_px = [[1, 2], [300.5, 2], [300, 100], [2, 100]]
scale_sd = 1e-3

[known_planes.floor-2]
kind = "charuco"
squares = [9, 7]
square_mm = 20
marker_mm = 15
dictionary = "DICT_4X4_100"
first_id = 32
flatness_mm = 0.3
margin_mm = 12
print_of = "wall"
region_px = [[0, 120], [400, 120], [400, 300]]
celsius = 21
u_celsius = 1
certificate = "K 7"
"""


def test_known_planes_are_read_and_written_and_no_fan_is_a_statement(tmp_path):
    rig = read(tmp_path, WITHOUT_FAN)
    assert not rig.has_fan and rig.lines == 0
    wall, floor = rig.known_planes["wall"], rig.known_planes["floor-2"]
    corners = ((1.0, 2.0), (300.5, 2.0), (300.0, 100.0), (2.0, 100.0))
    assert wall == KnownPlaneTarget(Rectangle(250.0, 150.0, 10.0, corners), BoardTolerance(None, 1e-3))
    assert floor.target == Charuco(9, 7, 20.0, 15.0, "DICT_4X4_100", 32)
    assert (floor.board, floor.margin_mm, floor.print_of) == (BoardTolerance(0.3, None), 12.0, "wall")
    assert floor.region_px == ((0.0, 120.0), (400.0, 120.0), (400.0, 300.0))
    assert floor.temperature.celsius == 21 and floor.certificate == Certificate("K 7")
    assert rig.all_certificates == {"known_planes.floor-2": Certificate("K 7")}
    assert written(tmp_path, rig) == rig
    text = rig_to_toml(rig)
    assert "[known_planes.wall]" in text and "laser_fan" not in text


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"rectangle"', '"circle"', ['known_planes.wall.kind is "circle"', "rectangle"]),
        ("size_mm = [250, 150.0]", "size_mm = 250", ["known_planes.wall.size_mm is 250", "[width, height]"]),
        ("size_mm = [250, 150.0]", "size_mm = [0.25, 150.0]", ["known_planes.wall.size_mm is 0.25", "in mm"]),
        ("size_mm = [250, 150.0]\n", "", ["known_planes.wall.size_mm is missing"]),
        ("line_mm = 10", "line_mm = 90", ["known_planes.wall: line_mm", "half of the shorter side"]),
        (", [2, 100]]", "]", ["known_planes.wall.corners_px", "four [u, v]"]),
        ("corners_px", "corner_px", ["known_planes.wall.corner_px is an unknown key", "corners_px"]),
        ('print_of = "wall"', 'print_of = "door"', ["known_planes.floor-2.print_of is door", "plane_target"]),
        ("scale_sd = 1e-3", 'print_of = "floor-2"', ["known_planes.wall.print_of is floor-2"]),
        ("first_id = 32", "first_id = -1", ["known_planes.floor-2.first_id is -1"]),
        ("region_px = [[0, 120], ", "region_px = [", ["known_planes.floor-2.region_px", "three or more"]),
        ("[known_planes.wall]", '[known_planes."the wall"]', ['known_planes has a table "the wall"', "a name of"]),
    ],
)
def test_what_is_wrong_with_a_known_plane_is_said_by_table_and_field(tmp_path, old, new, said):
    assert old in WITHOUT_FAN
    sentence = complaint(tmp_path, WITHOUT_FAN.replace(old, new, 1))
    for part in said:
        assert part in sentence
