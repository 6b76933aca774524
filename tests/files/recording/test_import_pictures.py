"""Somebody's folders of pictures become a recording set: order, pairs, links, and what is told."""

import os
from datetime import datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from core.errors import InputError
from core.files.reading import read_json
from core.files.recording import import_pictures as import_module
from core.files.recording.import_pictures import import_pictures
from core.files.recording.import_plan import ImportRequest, Order, Where, plan_import
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig, rig_to_toml

DARK = np.full((24, 32), 40, np.uint8)
LIT = DARK.copy()
LIT[:, 14:18] = 200


def pictures(folder, *names, picture=DARK):
    folder.mkdir(exist_ok=True, parents=True)
    for name in names:
        cv2.imwrite(str(folder / name), picture)
    return folder


def taken(folder, name, at, *, part=""):
    exif = Image.Exif()
    exif.get_ifd(0x8769).update({0x9003: at.strftime("%Y:%m:%d %H:%M:%S")} | ({0x9291: part} if part else {}))
    Image.fromarray(DARK).save(folder / name, exif=exif)


def sources(plan, part):
    return [one.source.name for one in plan.parts[part]]


def pairs(plan):
    return {one.source.name: one.off.name if one.off else None for one in plan.parts["planes"]}


def codes(messages):
    return [one.code for one in messages]


def test_numbers_in_names_count_as_numbers_and_the_set_keeps_that_order(tmp_path):
    shots = pictures(tmp_path / "shots", "v10.png", "v2.png", "v1.png")
    plan = plan_import(ImportRequest(camera=Where(shots)))
    assert sources(plan, "camera") == ["v1.png", "v2.png", "v10.png"]
    (tmp_path / "rig.toml").write_text(rig_to_toml(default_rig()))
    import_pictures(plan, tmp_path / "set", tmp_path / "rig.toml")
    recording_set = open_set(tmp_path / "set")
    assert [path.name for path in recording_set.camera] == ["0-v1.png", "1-v2.png", "2-v10.png"]


def test_names_that_sort_well_are_kept(tmp_path):
    shots = pictures(tmp_path / "shots", "v01.png", "v02.png")
    assert [one.name for one in plan_import(ImportRequest(camera=Where(shots))).pictures] == ["v01", "v02"]


@pytest.mark.parametrize("part", ["", "25"])
def test_pictures_are_ordered_by_the_time_they_were_taken(tmp_path, part):
    start = datetime(2026, 1, 25, 11, 36, 26)
    for number, name in enumerate(["c.jpg", "a.jpg", "b.jpg"]):
        taken(tmp_path, name, start + timedelta(seconds=number), part=part)
    plan = plan_import(ImportRequest(camera=Where(tmp_path), order=Order.TIME))
    assert sources(plan, "camera") == ["c.jpg", "a.jpg", "b.jpg"]
    assert [one.name for one in plan.pictures] == ["0-c", "1-a", "2-b"]
    assert plan.pictures[0].taken_at == start.replace(microsecond=250_000 if part else 0)
    assert plan.notes == ()


def test_without_times_in_the_pictures_those_of_the_files_order_them_and_this_is_told(tmp_path):
    taken(tmp_path, "a.jpg", datetime(2026, 1, 25))
    pictures(tmp_path, "b.png", "c.png")
    for name, at in (("a.jpg", 300), ("b.png", 100), ("c.png", 100)):
        os.utime(tmp_path / name, (at, at))
    plan = plan_import(ImportRequest(camera=Where(tmp_path), order=Order.TIME))
    assert sources(plan, "camera") == ["b.png", "c.png", "a.jpg"]
    assert codes(plan.notes) == ["import.no_time_in_picture", "import.same_time"]


def test_patterns_pair_what_their_stars_stand_for(tmp_path):
    pictures(tmp_path, "laser_01.png", "laser_2.png", picture=LIT)
    pictures(tmp_path, "board_1.jpg", "board_02.jpg")
    plan = plan_import(
        ImportRequest(planes=Where.typed(f"{tmp_path}/laser_*"), planes_off=Where.typed(f"{tmp_path}/board_*.jpg"))
    )
    assert pairs(plan) == {"laser_01.png": "board_1.jpg", "laser_2.png": "board_02.jpg"}
    assert plan.notes == ()


def test_two_folders_pair_by_equal_names_then_by_numbers_then_by_order(tmp_path):
    on = pictures(tmp_path / "on", "a1.png", "a2.png", picture=LIT)
    for name, off_names, rule in (
        ("same", ("a2.png", "a1.png"), "import.pairs_by_name"),
        ("numbers", ("off 2.png", "off 1.png"), "import.pairs_by_number"),
        ("order", ("x.png", "y.png"), "import.pairs_by_order"),
    ):
        off = pictures(tmp_path / name, *off_names)
        plan = plan_import(ImportRequest(planes=Where(on), planes_off=Where(off)))
        assert plan.rules["planes"].values["pairs"].code == rule
        assert pairs(plan) == dict(zip(["a1.png", "a2.png"], sorted(off_names), strict=True))


def test_one_folder_with_names_off_pairs_by_itself(tmp_path):
    pictures(tmp_path, "p1.png", "p2.png", picture=LIT)
    pictures(tmp_path, "p1_off.png")
    plan = plan_import(ImportRequest(planes=Where(tmp_path)))
    assert pairs(plan) == {"p1.png": "p1_off.png", "p2.png": None}
    assert codes(plan.notes) == ["import.no_partner"]


def test_pictures_of_a_check_are_paired_as_poses_are_and_read_as_a_check(tmp_path):
    day, more = tmp_path / "day", tmp_path / "more"
    pictures(day, "c1.png", "c2.png", picture=LIT)
    pictures(day, "c1_off.png", "c2_off.png")
    pictures(more, "views.png")
    plan = plan_import(ImportRequest(check=Where(day)))
    assert [name for one in plan.pictures for name, _ in one.files()] == [
        "check/c1.png", "check/c1_off.png", "check/c2.png", "check/c2_off.png",
    ]  # fmt: skip
    assert plan.rules["check"].values["pairs"].code == "import.pairs_by_off"
    (tmp_path / "rig.toml").write_text(rig_to_toml(default_rig()))
    import_pictures(plan_import(ImportRequest(camera=Where(more))), tmp_path / "set", tmp_path / "rig.toml")
    import_pictures(plan, tmp_path / "set")
    assert [(pair.on.name, pair.off.name) for pair in open_set(tmp_path / "set").check] == [
        ("c1.png", "c1_off.png"), ("c2.png", "c2_off.png"),
    ]  # fmt: skip
    written = read_json(tmp_path / "set" / "import.json")["imports"][-1]
    assert written["from"] == {"check": str(day / "*")}


def test_off_pictures_of_a_check_without_on_pictures_are_refused(tmp_path):
    off = pictures(tmp_path / "off", "c1.png")
    with pytest.raises(InputError, match="nothing says which have it on"):
        plan_import(ImportRequest(check_off=Where(off)))


def test_a_check_of_another_size_than_the_set_is_refused(tmp_path):
    import_pictures(plan_import(ImportRequest(check=Where(pictures(tmp_path / "a", "c1.png")))), tmp_path / "set")
    larger = np.zeros((2 * DARK.shape[0], DARK.shape[1]), np.uint8)
    scan = plan_import(ImportRequest(scan=Where(pictures(tmp_path / "b", "f1.png", picture=larger))))
    with pytest.raises(InputError, match="pixels"):
        import_pictures(scan, tmp_path / "set")


def test_off_pictures_without_a_pose_are_left_out_and_told(tmp_path):
    on = pictures(tmp_path / "on", "a1.png", picture=LIT)
    off = pictures(tmp_path / "off", "b1.png", "b2.png")
    plan = plan_import(ImportRequest(planes=Where(on), planes_off=Where(off)))
    assert codes(plan.notes) == ["import.off_left_over"]
    assert [name for name, _ in plan.pictures[0].files()] == ["planes/a1.png", "planes/a1_off.png"]


def test_light_in_the_off_pictures_is_told(tmp_path):
    on, off = pictures(tmp_path / "on", "a1.png"), pictures(tmp_path / "off", "a1.png", picture=LIT)
    plan = plan_import(ImportRequest(planes=Where(on), planes_off=Where(off)))
    assert codes(plan.notes) == ["import.exchanged"]


def test_files_are_linked_and_the_set_says_where_they_came_from(tmp_path):
    views, frames = pictures(tmp_path / "views", "v1.png"), pictures(tmp_path / "frames", "f1.png", "reference.png")
    imported = import_pictures(plan_import(ImportRequest(camera=Where(views), scan=Where(frames))), tmp_path / "set")
    assert imported.ways == {"hard link": 3}
    assert (tmp_path / "set/scan/reference.png").samefile(frames / "reference.png")
    assert imported.notes == ()
    assert codes(imported.all_notes) == ["import.no_rig"]
    (log,) = read_json(tmp_path / "set/import.json")["imports"]
    assert {one["name"]: one["from"] for one in log["pictures"]} == {
        "camera/v1.png": str(views / "v1.png"),
        "scan/reference.png": str(frames / "reference.png"),
        "scan/f1.png": str(frames / "f1.png"),
    }
    assert log["rules"]["camera"]["code"] == "import.by_name"


def test_parts_are_added_to_a_set_and_the_log_keeps_both(tmp_path):
    views, frames = pictures(tmp_path / "views", "v1.png"), pictures(tmp_path / "frames", "f1.png")
    import_pictures(plan_import(ImportRequest(camera=Where(views))), tmp_path / "set")
    import_pictures(plan_import(ImportRequest(scan=Where(frames))), tmp_path / "set")
    assert len(read_json(tmp_path / "set/import.json")["imports"]) == 2
    with pytest.raises(InputError, match="has its camera pictures already"):
        import_pictures(plan_import(ImportRequest(camera=Where(views))), tmp_path / "set")


@pytest.mark.parametrize("symlinks", [True, False])
def test_where_there_are_no_hard_links_it_is_told_what_was_done_instead(tmp_path, monkeypatch, symlinks):
    def refused(*_args, **_more):
        raise OSError(1, "no links here")

    monkeypatch.setattr(os, "link", refused)
    if not symlinks:
        monkeypatch.setattr(Path, "symlink_to", refused)
    views = pictures(tmp_path / "views", "v1.png")
    imported = import_pictures(plan_import(ImportRequest(camera=Where(views))), tmp_path / "set")
    assert imported.ways == {"symbolic link" if symlinks else "copy": 1}
    assert codes(imported.notes)[0] == ("import.linked_by_name" if symlinks else "import.copied")
    assert (tmp_path / "set/camera/v1.png").read_bytes() == (views / "v1.png").read_bytes()


def test_nothing_half_made_stays_when_a_file_cannot_be_linked(tmp_path):
    views = pictures(tmp_path / "views", "v1.png", "v2.png")
    plan = plan_import(ImportRequest(camera=Where(views)))
    (views / "v2.png").unlink()
    with pytest.raises(InputError, match="the file is missing"):
        import_pictures(plan, tmp_path / "set")
    assert list((tmp_path / "set").iterdir()) == []


def test_bad_requests_are_refused_in_one_sentence(tmp_path):
    shots = pictures(tmp_path / "shots", "laser_1.png", "board_1.png")
    large = pictures(tmp_path / "large", "l1.png", picture=np.zeros((48, 64), np.uint8))
    (tmp_path / "empty").mkdir()
    for request, told in (
        (ImportRequest(), "nothing says which pictures"),
        (ImportRequest(camera=Where(tmp_path / "gone")), "there is no such folder"),
        (ImportRequest(camera=Where(shots / "laser_1.png")), "is a file, not a folder"),
        (ImportRequest(camera=Where(tmp_path / "empty")), "there are no pictures in this folder"),
        (ImportRequest(camera=Where(shots, "*.tif")), "no picture fits"),
        (ImportRequest(planes=Where(shots)), "there are pictures board_\\* and laser_\\*"),
        (ImportRequest(planes=Where(shots), planes_off=Where(shots)), "on and off at once"),
        (ImportRequest(planes_off=Where(shots)), "nothing says which have it on"),
        (ImportRequest(planes=Where(large), planes_off=Where(shots)), "1 with the fan on but 2 with it off"),
        (ImportRequest(camera=Where(shots), scan=Where(large)), "48 pixels, but the others"),
        (ImportRequest(reference=shots / "laser_1.png"), "nothing says which are its frames"),
    ):
        with pytest.raises(InputError, match=told):
            plan_import(request)


def test_pictures_of_kinds_that_are_not_read_are_told(tmp_path):
    pictures(tmp_path, "v1.png")
    (tmp_path / "v2.HEIC").write_bytes(b"x")
    assert codes(plan_import(ImportRequest(camera=Where(tmp_path))).notes) == ["set.not_read"]


def test_boards_beside_the_part_keep_their_names_with_their_scan_before_or_after_it(tmp_path):
    boards = pictures(tmp_path / "boards", "wall.png", "wall_2.png", "wall_10.png")
    frames = pictures(tmp_path / "frames", "f1.png", "f2.png")
    (tmp_path / "rig.toml").write_text(rig_to_toml(default_rig()))
    both = plan_import(ImportRequest(scan=Where(frames), known_planes=Where(boards)))
    import_pictures(both, tmp_path / "at-once", tmp_path / "rig.toml")
    import_pictures(plan_import(ImportRequest(scan=Where(frames))), tmp_path / "one-by-one", tmp_path / "rig.toml")
    later = plan_import(ImportRequest(known_planes=Where(boards)))
    import_pictures(later, tmp_path / "one-by-one")
    import_pictures(later, tmp_path / "boards-first", tmp_path / "rig.toml")
    import_pictures(plan_import(ImportRequest(scan=Where(frames))), tmp_path / "boards-first")
    for name in ("at-once", "one-by-one", "boards-first"):
        assert sorted(path.name for path in (tmp_path / name).iterdir()) == ["import.json", "rig.toml", "scan"]
        found = open_set(tmp_path / name)
        assert [path.name for path in found.frames] == ["f1.png", "f2.png"]
        (wall,) = found.known_planes
        assert [path.name for path in wall.pictures] == ["wall.png", "wall_2.png", "wall_10.png"]
    with pytest.raises(InputError, match="the set has its scan/planes pictures already"):
        import_pictures(later, tmp_path / "at-once")
    (tmp_path / "empty" / "scan" / "planes").mkdir(parents=True)
    import_pictures(both, tmp_path / "empty")
    assert len(list((tmp_path / "empty" / "scan" / "planes").iterdir())) == 3


def test_boards_stay_where_the_frames_of_their_scan_cannot_be_put_beside_them(tmp_path, monkeypatch):
    boards, frames = pictures(tmp_path / "boards", "wall.png"), pictures(tmp_path / "frames", "f1.png", "f2.png")
    import_pictures(plan_import(ImportRequest(known_planes=Where(boards))), tmp_path / "set")

    def failing(source, place):
        if place.name == "scan":
            raise PermissionError("held")
        source.rename(place)

    monkeypatch.setattr(import_module, "rename", failing)
    with pytest.raises(InputError, match="cannot be written"):
        import_pictures(plan_import(ImportRequest(scan=Where(frames))), tmp_path / "set")
    assert [path.name for path in (tmp_path / "set" / "scan" / "planes").iterdir()] == ["wall.png"]
    assert sorted(path.name for path in (tmp_path / "set").iterdir()) == ["import.json", "scan"]
