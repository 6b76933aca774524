import hashlib
import shutil

import numpy as np
import pytest

from core.errors import InputError
from core.files.pictures import write_picture
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import (
    excludable,
    excluded_names,
    gather_set,
    open_set,
    require_camera,
    require_planes,
    require_scan,
)
from core.files.recording.rig import default_rig, read_rig, rig_to_toml

PARTS = ("camera", "planes", "scan")


def picture(value=7, size=(40, 30)):
    return np.full(size[::-1], value, np.uint8)


@pytest.fixture
def whole(tmp_path):
    root = tmp_path / "block"
    for name in PARTS:
        (root / name).mkdir(parents=True)
    (root / "rig.toml").write_text("# ours\n" + rig_to_toml(default_rig()))
    for name in (
        "camera/b",
        "camera/a",
        "planes/p1",
        "planes/p1_off",
        "planes/p2",
        "scan/reference",
        "scan/f0",
        "scan/f1",
    ):
        write_picture(root / f"{name}.png", picture(len(name)))
    return root


@pytest.fixture
def scattered(whole, tmp_path):
    """The same pictures in folders of other names, in other places."""
    places = [tmp_path / "mon" / "views", tmp_path / "tue" / "scan", tmp_path / "wed" / "fr" / "camera"]
    for part, place in zip(PARTS, places, strict=True):
        shutil.copytree(whole / part, place)
    return places


def hashes(found):
    pictures = PictureReader(found)
    for paths in (found.camera, [found.planes[0].on, found.planes[0].off, found.planes[1].on], found.frames):
        for _, seen in pictures.stream(paths):
            assert not isinstance(seen, str)
    pictures.read(found.reference)
    return pictures.hashes


def test_scattered_pictures_have_the_names_and_hashes_of_a_set(whole, scattered):
    one, other = open_set(whole), gather_set(default_rig(), *scattered)
    assert hashes(one) == hashes(other)
    for found in (one, other):
        assert [found.name_of(path) for path in found.camera] == ["camera/a.png", "camera/b.png"]
        assert [pair.name for pair in found.planes] == ["p1", "p2"]
        assert found.name_of(found.planes[0].off) == "planes/p1_off.png"
        assert found.name_of(found.reference) == "scan/reference.png"
        assert [name for name, _ in PictureReader(found).stream(found.frames)] == ["scan/f0.png", "scan/f1.png"]


def test_every_name_leads_back_to_its_picture(whole, scattered):
    for found in (open_set(whole), gather_set(default_rig(), *scattered)):
        for path in (*found.camera, found.planes[0].on, found.reference, *found.frames):
            assert found.path_of(found.name_of(path)) == path
        for name in ("camera", "rig.toml", "results/x.png", ""):
            with pytest.raises(InputError, match="there is no such picture in the set"):
                found.path_of(name)
        with pytest.raises(ValueError, match=r"is no picture of"):
            found.name_of(whole / "rig.toml")


def test_a_set_gathered_from_its_own_folders_is_the_set(whole):
    one, other = open_set(whole), gather_set(read_rig(whole / "rig.toml"), *(whole / part for part in PARTS))
    assert hashes(one) == hashes(other)
    assert one.rig_hash == other.rig_hash == hashlib.sha256((whole / "rig.toml").read_bytes()).hexdigest()
    assert one.name == other.name == "block"


def test_the_hash_of_a_rig_that_lies_nowhere_is_that_of_its_text(whole, scattered):
    text = hashlib.sha256(rig_to_toml(default_rig()).encode()).hexdigest()
    assert gather_set(default_rig(), *scattered).rig_hash == text
    (whole / "rig.toml").write_text(rig_to_toml(default_rig()).replace("5.0", "6.0"))
    assert gather_set(default_rig(), *(whole / part for part in PARTS)).rig_hash == text
    (whole / "rig.toml").write_text("broken")
    assert gather_set(default_rig(), whole / "camera", None, None).rig_hash == text


def test_parts_that_are_not_there_are_empty_until_they_are_needed(tmp_path, scattered):
    found = gather_set(default_rig(), scattered[0], None, tmp_path / "nowhere")
    require_camera(found)
    assert (found.planes, found.reference, found.frames) == ((), None, ())
    with pytest.raises(InputError, match=r"planes: there are no pictures of the plane target"):
        require_planes(found)
    with pytest.raises(InputError, match=r"nowhere: there are no frames of a scan"):
        require_scan(found)
    nothing = gather_set(default_rig(), None, None, None)
    assert nothing.name == ""
    with pytest.raises(InputError, match=r"camera: there are no pictures of the camera target"):
        require_camera(nothing)
    with pytest.raises(InputError, match="there is no such picture"):
        nothing.path_of("camera/a.png")


def test_a_gathered_set_is_called_as_one_says_or_like_the_folder_of_the_scan(scattered):
    assert gather_set(default_rig(), *scattered, name="Block 50").name == "Block 50"
    assert gather_set(default_rig(), *scattered).name == "fr"
    assert gather_set(default_rig(), scattered[0], None, None).name == "mon"


def test_one_folder_cannot_be_two_parts(scattered):
    with pytest.raises(InputError, match="is the folder of both camera and scan"):
        gather_set(default_rig(), scattered[0], None, scattered[0].parent / "x" / ".." / "views")


def test_sizes_must_agree_within_a_part_only(scattered):
    for path in scattered[2].iterdir():
        write_picture(path, picture(size=(20, 10)))
    assert gather_set(default_rig(), *scattered).frames
    write_picture(scattered[2] / "f1.png", picture(size=(20, 11)))
    with pytest.raises(InputError, match=r"f1\.png: the picture has 20 × 11 pixels"):
        gather_set(default_rig(), *scattered)


def test_results_do_not_go_among_the_pictures(whole, scattered, tmp_path):
    recording_set = open_set(whole)
    assert recording_set.contains(whole)
    assert recording_set.contains(whole / "scan" / "..")
    assert recording_set.contains(whole / "scan")
    assert not recording_set.contains(whole / "results")
    gathered = gather_set(default_rig(), *scattered)
    assert gathered.contains(scattered[1])
    assert not gathered.contains(tmp_path / "results")


def test_names_to_leave_out_are_those_of_the_set(whole):
    recording_set = open_set(whole)
    names = ("camera/a.png", "camera/b.png", "planes/p1", "planes/p2", "scan/f0.png", "scan/f1.png")
    assert excludable(recording_set) == names
    assert excluded_names(recording_set, names) == set(names)
    assert excluded_names(recording_set, []) == frozenset()
    assert excluded_names(recording_set, ["planes/p1.png", "planes/p1_off.png", "scan\\f0.png"]) == {
        "planes/p1",
        "scan/f0.png",
    }


@pytest.mark.parametrize(("typed", "said"), [
    ("camera/aa.png", "block: there is no picture camera/aa.png to leave out; the nearest is camera/a.png."),
    ("f1.png", "the nearest is scan/f1.png"),
    ("planes/p3", "the nearest is planes/p"),
    ("scan/reference.png", "there is no picture scan/reference.png to leave out"),
    ("17", "name it as in the set"),
])  # fmt: skip
def test_a_name_that_is_not_in_the_set_is_told_with_the_nearest(whole, typed, said):
    with pytest.raises(InputError) as error:
        excluded_names(open_set(whole), ["camera/a.png", typed])
    assert said in str(error.value)


def test_boards_beside_the_part_are_gathered_with_the_scan_unless_they_are_the_poses(whole, scattered, tmp_path):
    scan = scattered[2]
    (scan / "planes").mkdir()
    write_picture(scan / "planes" / "plate.png", picture())
    found = gather_set(default_rig(), None, None, scan)
    assert [found.name_of(path) for path in found.known_plane_pictures()] == ["scan/planes/plate.png"]
    assert gather_set(default_rig(), None, scan / "planes", scan).known_planes == ()
