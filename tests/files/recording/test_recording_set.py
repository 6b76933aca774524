import hashlib
from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set, require_camera, require_planes, require_scan
from core.files.recording.rig import Channels, KnownPlaneTarget, default_rig, rig_to_toml
from core.files.recording.set_listing import names_not_read
from core.image.exclusion import Exclusion
from core.image.mosaic import ALL_SITES, Sites
from core.image.targets import Rectangle
from core.messages import Message

RIG = rig_to_toml(default_rig())


def picture(value=7, size=(40, 30), dtype=np.uint8):
    return np.full(size[::-1], value, dtype)


@pytest.fixture
def folder(tmp_path):
    root = tmp_path / "set"
    for name in ("camera", "planes", "scan"):
        (root / name).mkdir(parents=True)
    (root / "rig.toml").write_text(RIG)
    for name in ("camera/b", "camera/a", "planes/p1", "planes/p1_off", "planes/p2", "scan/reference"):
        write_picture(root / f"{name}.png", picture())
    for frame in range(6):
        write_picture(root / "scan" / f"frame_{frame:03d}.png", picture(frame))
    return root


def test_lists_everything_in_the_order_of_names(folder):
    (folder / "scan" / "notes.txt").write_text("not a picture")
    (folder / "scan" / "._frame_000.png").write_bytes(b"left by another system")
    recording_set = open_set(folder)
    assert [p.name for p in recording_set.camera] == ["a.png", "b.png"]
    assert [(p.name, p.off and p.off.name) for p in recording_set.planes] == [("p1", "p1_off.png"), ("p2", None)]
    assert recording_set.reference.name == "reference.png"
    assert [p.name for p in recording_set.frames] == [f"frame_{i:03d}.png" for i in range(6)]


def test_frames_stream_in_order_with_hashes(folder):
    recording_set = open_set(folder)
    stream = list((pictures := PictureReader(recording_set)).stream(recording_set.frames))
    assert [name for name, _ in stream] == [f"scan/frame_{i:03d}.png" for i in range(6)]
    assert [int(p[0, 0]) for _, p in stream] == list(range(6))
    data = (folder / "scan" / "frame_003.png").read_bytes()
    assert pictures.hashes["scan/frame_003.png"] == hashlib.sha256(data).hexdigest()


def test_truncated_frame_among_good_ones_is_told_and_the_rest_go_on(folder):
    path = folder / "scan" / "frame_002.png"
    path.write_bytes(path.read_bytes()[:-20])
    recording_set = open_set(folder)
    stream = list(PictureReader(recording_set).stream(recording_set.frames))
    assert [isinstance(picture, Message) for _, picture in stream] == [False, False, True, False, False, False]
    assert (stream[2][0], str(stream[2][1])) == ("scan/frame_002.png", "the picture ends early")
    assert stream[2][1].code


def test_streaming_reads_only_a_few_frames_ahead(folder, monkeypatch):
    for frame in range(6, 40):
        write_picture(folder / "scan" / f"frame_{frame:03d}.png", picture(frame))
    pictures = PictureReader(open_set(folder))
    stream = pictures.stream(pictures.recording_set.frames)
    next(stream)
    stream.close()
    assert len(pictures.hashes) <= 9


def test_missing_folder_file_and_empty_set(tmp_path):
    with pytest.raises(InputError, match="nowhere: there is no such folder"):
        open_set(tmp_path / "nowhere")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file, not a folder"):
        open_set(tmp_path / "file")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"empty: the recording set is empty; it needs rig\.toml"):
        open_set(tmp_path / "empty")


@pytest.mark.parametrize(
    ("part", "require", "said"),
    [
        ("camera", require_camera, "camera: there are no pictures of the camera target"),
        ("planes", require_planes, "planes: there are no pictures of the plane target"),
        ("scan", require_scan, "scan: there are no frames"),
    ],
)
def test_a_part_without_pictures_is_named(folder, part, require, said):
    for path in (folder / part).iterdir():
        path.unlink()
    recording_set = open_set(folder)
    with pytest.raises(InputError, match=said):
        require(recording_set)


def test_a_reference_alone_is_no_scan(folder):
    for path in (folder / "scan").glob("frame*"):
        path.unlink()
    with pytest.raises(InputError, match="no frames"):
        require_scan(open_set(folder))


def test_mixed_sizes_name_the_odd_picture(folder):
    write_picture(folder / "scan" / "frame_004.png", picture(size=(41, 30)))
    with pytest.raises(InputError, match=r"frame_004\.png: the picture has 41 × 30 pixels, but .* 40 × 30"):
        open_set(folder)


@pytest.mark.parametrize("suffix", [".jpg", ".tif", ".bmp", ".pgm"])
def test_sizes_are_known_for_every_kind_of_file(folder, suffix):
    (folder / "camera" / f"odd{suffix}").write_bytes(cv2.imencode(suffix, picture(size=(20, 30)))[1].tobytes())
    with pytest.raises(InputError, match=rf"odd\{suffix}: the picture has 20 × 30 pixels"):
        open_set(folder)


def test_mixed_depths_name_the_odd_picture(folder):
    write_picture(folder / "scan" / "frame_003.png", picture(dtype=np.uint16))
    recording_set = open_set(folder)
    with pytest.raises(InputError, match=r"frame_003\.png: the picture has 16 bit"):
        list(PictureReader(recording_set).stream(recording_set.frames))


def test_off_picture_without_partner(folder):
    write_picture(folder / "planes" / "p9_off.png", picture())
    with pytest.raises(InputError, match=r"p9_off\.png: there is no picture p9\.png with the fan on beside it"):
        open_set(folder)


def test_two_references(folder):
    (folder / "scan" / "reference.bmp").write_bytes(cv2.imencode(".bmp", picture())[1].tobytes())
    with pytest.raises(InputError, match="there are 2 references"):
        open_set(folder)


def test_pictures_are_read_in_the_channel_of_their_step(tmp_path):
    bgr = np.zeros((20, 20, 3), np.uint8) + np.array([10, 20, 30], np.uint8)
    for part in ("camera", "planes", "scan"):
        (tmp_path / part).mkdir()
        cv2.imwrite(str(tmp_path / part / "a.png"), bgr)
    (tmp_path / "rig.toml").write_text('channel = "green"\n[channels]\ncamera = "blue"\nscan = "red"\n', "utf-8")
    recording_set = open_set(tmp_path)
    pictures = PictureReader(recording_set)
    assert [int(pictures.read(tmp_path / part / "a.png")[0, 0]) for part in ("camera", "planes", "scan")] == [
        10,
        20,
        30,
    ]


def test_further_exposures_are_no_frames_views_or_poses(folder):
    before = open_set(folder)
    for name in ("scan/frame_002@2", "scan/reference@2", "planes/p1@2", "planes/p1_off@2", "scan/frame_002@3"):
        write_picture(folder / f"{name}.png", picture(3))
    recording_set = open_set(folder)
    assert (recording_set.camera, recording_set.frames, recording_set.reference) == (
        before.camera,
        before.frames,
        before.reference,
    )
    assert [(pair.name, pair.on, pair.off) for pair in recording_set.planes] == [
        (pair.name, pair.on, pair.off) for pair in before.planes
    ]
    named = {
        one.name: {number: path.name for number, path in more.items()} for one, more in recording_set.further.items()
    }
    assert named == {
        "frame_002.png": {2: "frame_002@2.png", 3: "frame_002@3.png"},
        "reference.png": {2: "reference@2.png"},
        "p1.png": {2: "p1@2.png"},
        "p1_off.png": {2: "p1_off@2.png"},
    }


def test_a_further_exposure_is_read_and_hashed_beside_the_first(folder):
    write_picture(folder / "scan" / "frame_002@2.png", picture(9))
    recording_set = open_set(folder)
    pictures = PictureReader(recording_set)
    assert int(pictures.read_further(recording_set.frames[2], 2)[0, 0]) == 9
    assert pictures.read_further(recording_set.frames[2], 3) is None
    assert pictures.read_further(recording_set.frames[1], 2) is None
    assert list(pictures.hashes) == ["scan/frame_002@2.png"]
    both = [recording_set.frames[1], recording_set.frames[2], folder / "scan" / "frame_002@2.png"]
    assert recording_set.with_further(recording_set.frames[1:3]) == both


def test_a_further_exposure_without_its_first_is_refused(folder):
    write_picture(folder / "scan" / "frame_099@2.png", picture(9))
    with pytest.raises(InputError) as refused:
        open_set(folder)
    assert refused.value.code == "set.no_first_exposure"
    assert "frame_099.png" in str(refused.value)


def test_a_further_exposure_of_another_size_is_refused(folder):
    write_picture(folder / "scan" / "frame_002@2.png", picture(9, size=(20, 30)))
    with pytest.raises(InputError) as refused:
        open_set(folder)
    assert refused.value.code == "set.size_differs"


def raw_set(folder, **rig):
    """The set with raw pictures of a red light along a line, seen by sites of RGGB, and on a board in white light."""
    (folder / "rig.toml").write_text(rig_to_toml(replace(default_rig(), **rig)))
    rng = np.random.default_rng(1)
    for path in sorted(folder.glob("*/*.png")):
        raw = rng.normal(20, 1, (60, 80))
        if path.parent.name == "camera":
            raw[:, 40:] *= 8
        elif not path.stem.endswith(("_off", "reference")):
            raw[20:24] += np.tile([150, 18], 40) * np.array([1, 0, 1, 0])[:, None]
        write_picture(path, raw.round().clip(0, 255).astype(np.uint8))
    return open_set(folder)


def test_a_laser_in_raw_pictures_is_measured_at_the_sites_that_see_it(folder):
    recording_set = raw_set(folder, mosaic="RGGB")
    pictures = PictureReader(recording_set)
    for part in ("planes", "scan"):
        assert pictures.sites(part) == Sites(0, 0)
        assert pictures.laser_channel(part).channel == "red"
    frame = recording_set.frames[0]
    raw = cv2.imread(str(frame), cv2.IMREAD_UNCHANGED)
    assert pictures.read(frame).shape == raw.shape
    assert np.array_equal(pictures.sites("scan").of(pictures.read(frame))[1:-1, 1:-1], raw[::2, ::2][1:-1, 1:-1])


def test_colours_interpolated_from_a_mosaic_that_is_stated_are_measured_where_they_were(folder):
    recording_set = raw_set(folder, mosaic="RGGB")
    frame = recording_set.frames[0]
    raw = cv2.imread(str(frame), cv2.IMREAD_UNCHANGED)
    for path in (frame, *(path for pair in recording_set.planes for path in (pair.on, pair.off) if path)):
        cv2.imwrite(str(path), cv2.cvtColor(cv2.imread(str(path), cv2.IMREAD_UNCHANGED), cv2.COLOR_BayerRGGB2BGR))
    recording_set = open_set(folder)
    pictures = PictureReader(recording_set)
    assert pictures.sites("planes") == Sites(0, 0)
    assert np.array_equal(pictures.sites("planes").of(pictures.read(frame))[1:-1, 1:-1], raw[::2, ::2][1:-1, 1:-1])
    assert pictures.read_target(recording_set.planes[0].on).shape == raw.shape


def test_the_stated_colour_of_a_laser_chooses_the_sites(folder):
    assert PictureReader(raw_set(folder, mosaic="GBRG", channel="red")).sites("scan") == Sites(0, 1)
    assert PictureReader(raw_set(folder, mosaic="RGGB", channel="red-green")).sites("scan") == ALL_SITES


def test_pictures_of_no_mosaic_are_looked_at_whole(folder):
    recording_set = raw_set(folder)
    pictures = PictureReader(recording_set)
    assert pictures.sites("scan") == ALL_SITES
    assert pictures.read(recording_set.frames[0]).dtype == np.uint8


def test_a_target_is_looked_for_in_all_sites_of_a_raw_picture(folder):
    recording_set = raw_set(folder, mosaic="RGGB")
    pictures = PictureReader(recording_set)
    for board in (pictures.read(recording_set.camera[0]), pictures.read_board(recording_set.camera[0])):
        assert board.shape == (60, 80)
        assert board.dtype == np.uint16
    assert pictures.read_target(recording_set.planes[0].on).dtype == np.uint16


def test_a_set_of_grey_pictures_whose_targets_are_stated_in_red_reads_them_as_they_are(folder):
    recording_set = raw_set(folder, channels=Channels(camera="red"))
    pictures = PictureReader(recording_set)
    assert np.array_equal(pictures.read_target(recording_set.planes[0].on), pictures.read(recording_set.planes[0].on))


@pytest.mark.parametrize("name", ["p1_OFF.png", "p1_Off.png", "P1_OFF.png"])
def test_the_picture_with_the_fan_off_may_be_named_in_capitals(folder, name):
    (folder / "planes" / "p1_off.png").rename(folder / "planes" / name)
    assert [(p.name, p.off and p.off.name) for p in open_set(folder).planes] == [("p1", name), ("p2", None)]


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("sweep.MP4", r"import the frames of sweep\.MP4"),
        ("sweep.apng", r"import the frames of sweep\.apng"),
        ("sweep.wmv", r"convert sweep\.wmv to png"),
        ("sweep.mpg", r"convert sweep\.mpg to png"),
    ],
)
def test_a_film_in_the_place_of_pictures_is_told_with_what_can_be_done_with_it(folder, name, advice):
    for path in (folder / "scan").iterdir():
        path.unlink()
    (folder / "scan" / name).write_bytes(b"film")
    with pytest.raises(InputError, match=rf"there are no frames of a scan; {advice}\.$"):
        require_scan(open_set(folder))


def test_films_and_pictures_that_are_not_read_are_told_beside_those_that_are(folder):
    for name in ("one.webp", "two.mov", "three.MPG", "four.apng", "notes.txt"):
        (folder / "camera" / name).write_bytes(b"x")
    found = open_set(folder)
    assert [str(note) for note in found.not_read("camera")] == [
        "2 files in camera are of a kind that is not read (one.webp, three.MPG): convert them to png.",
        "2 films in camera are not read (four.apng, two.mov): import the frames of one.",
    ]
    assert found.not_read("scan") == ()
    assert names_not_read(found.folders["camera"]) == (("one.webp", "three.MPG"), ("four.apng", "two.mov"))


def test_of_equal_pictures_in_a_stream_the_first_one_counts(folder):
    noise = np.random.default_rng(1).integers(0, 255, (30, 40), np.uint8)
    for frame in (1, 4):
        write_picture(folder / "scan" / f"frame_{frame:03d}.png", noise)
    found = open_set(folder)
    again = [picture is Exclusion.REPEATED for _, picture in PictureReader(found).stream(found.frames)]
    assert again == [False] * 4 + [True, False]


def with_boards(folder, *names):
    (folder / "scan" / "planes").mkdir()
    for name in names:
        write_picture(folder / "scan" / "planes" / f"{name}.png", picture())
    return open_set(folder)


def test_pictures_of_known_planes_are_no_frames_and_are_told_apart_by_their_names(folder):
    frames = open_set(folder).frames
    found = with_boards(folder, "plate", "plate_10", "plate_2", "wall_2", "wall_3")
    assert found.frames == frames
    assert {plane.name: [path.name for path in plane.pictures] for plane in found.known_planes} == {
        "plate": ["plate.png", "plate_2.png", "plate_10.png"],
        "wall_2": ["wall_2.png"],
        "wall_3": ["wall_3.png"],
    }
    assert {plane.target for plane in found.known_planes} == {found.rig.plane_target}
    assert {plane.print_of for plane in found.known_planes} == {"plane_target"}
    first = found.known_plane_pictures()[0]
    assert found.name_of(first) == "scan/planes/plate.png"
    assert found.path_of("scan/planes/plate.png") == first
    assert PictureReader(found).read_target(first).shape == (30, 40)


def test_a_stated_board_takes_its_numbered_pictures_and_is_a_known_plane_without_one(folder):
    rig = replace(
        default_rig(),
        known_planes={"wall": KnownPlaneTarget(Rectangle(250.0, 150.0)), "a_2": KnownPlaneTarget(Rectangle(9.0, 8.0))},
    )
    (folder / "rig.toml").write_text(rig_to_toml(rig))
    found = with_boards(folder, "wall_2", "a", "a_2")
    assert {plane.name: len(plane.pictures) for plane in found.known_planes} == {"a": 1, "a_2": 1, "wall": 1}
    assert [plane.print_of for plane in found.known_planes] == ["plane_target", "a_2", "wall"]
    assert found.known_planes[2].target == Rectangle(250.0, 150.0)
    (folder / "scan" / "planes" / "wall_2.png").unlink()
    wall = open_set(folder).known_planes[2]
    assert (wall.name, wall.target, wall.pictures) == ("wall", Rectangle(250.0, 150.0), ())


def test_a_board_of_which_nothing_is_stated_is_refused_when_a_scan_is_measured(folder):
    text = (folder / "rig.toml").read_text()
    before, _, after = text.partition("[plane_target]")
    (folder / "rig.toml").write_text(before + after[after.index("[laser_fan]") :])
    require_scan(open_set(folder))
    found = with_boards(folder, "plate")
    require_camera(found)
    with pytest.raises(InputError, match=r"planes/plate.png: there is neither a table \[known_planes.plate\] nor"):
        require_scan(found)


def test_a_board_of_another_size_than_the_frames_is_refused(folder):
    with_boards(folder, "plate")
    write_picture(folder / "scan" / "planes" / "wall.png", picture(size=(41, 30)))
    with pytest.raises(InputError, match=r"wall.png: the picture has 41 × 30 pixels"):
        open_set(folder)
