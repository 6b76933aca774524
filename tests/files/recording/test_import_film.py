"""A film becomes the frames of a recording set: what is proposed and told, what is written, what is refused."""

import shutil
from collections import namedtuple

import cv2
import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files.pictures import compression_of
from core.files.reading import read_json
from core.files.recording.import_pictures import import_pictures
from core.files.recording.import_plan import ImportRequest, Where, plan_import
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig, rig_to_toml
from tests.films import say_longer, sweep, write_film


@pytest.fixture
def film(tmp_path):
    a, b, *others = sweep()
    return write_film(tmp_path / "hand.avi", [a, a, b, *others])


def imported(film, target, **more):
    plan = plan_import(ImportRequest(scan=Where(film), **more))
    (target / "rig.toml").parent.mkdir(exist_ok=True)
    (target / "rig.toml").write_text(rig_to_toml(default_rig()))
    return import_pictures(plan, target)


def codes(messages):
    return [one.code for one in messages]


def test_the_frames_of_a_film_are_written_with_their_numbers_and_times(tmp_path, film):
    found = imported(film, tmp_path / "set")
    assert found.ways == {"frame of a film": 12}
    recording_set = open_set(tmp_path / "set")
    assert [path.name for path in recording_set.frames][:3] == ["hand-00.png", "hand-02.png", "hand-03.png"]
    assert all(
        np.array_equal(cv2.imread(str(path)), picture)
        for path, picture in zip(recording_set.frames, sweep(), strict=True)
    )
    log = recording_set.log("scan").frames
    assert [(line.name, line.index) for line in log][:2] == [("hand-00.png", 0), ("hand-02.png", 2)]
    assert log[1].time_s == pytest.approx(0.2)
    kept = read_json(tmp_path / "set" / "import.json")["imports"][0]
    assert kept["from"] == {"scan": str(film.resolve())}
    assert kept["films"]["scan"] | {"from": ""} == {"from": "", "coding": "FFV1", "doubled": 1, "lost": {}}
    assert kept["pictures"][1] | {"from": ""} == {
        "name": "scan/hand-02.png", "from": "", "as": "frame of a film", "frame": 2, "time_s": 0.2,
    }  # fmt: skip


def test_doubled_frames_are_told_and_the_lasers_channel_is_proposed_as_it_will_be_looked_at(tmp_path, film):
    plan = plan_import(ImportRequest(scan=Where(film)))
    assert codes((*plan.notes, *plan.proposals)) == ["import.film_doubled", "import.channel_proposed"]
    assert plan.notes[0].values["n"] == 1
    proposed = plan.proposals[0].values
    imported(film, tmp_path / "set")
    chosen = PictureReader(open_set(tmp_path / "set")).laser_channel("scan")
    assert chosen.channel == "red"
    assert str(proposed["channel"]) == "red"
    assert proposed["times"] == pytest.approx(chosen.times, rel=0.2)


def test_a_laser_of_another_colour_is_found(tmp_path):
    path = write_film(tmp_path / "a.avi", sweep(colour=0))
    assert str(plan_import(ImportRequest(scan=Where(path))).proposals[0].values["channel"]) == "blue"


def test_a_channel_that_is_stated_is_the_one(tmp_path, film):
    imported(film, tmp_path / "set")
    path = tmp_path / "set" / "rig.toml"
    path.write_text('channel = "green"\n' + path.read_text())
    assert PictureReader(open_set(tmp_path / "set")).laser_channel("scan").channel == "green"


def test_of_a_grey_film_no_channel_is_proposed(tmp_path):
    grey = write_film(tmp_path / "grey.avi", [np.repeat(one[:, :, 2:], 3, axis=2) for one in sweep()])
    assert plan_import(ImportRequest(scan=Where(grey))).proposals == ()


def test_the_loss_of_a_film_is_told_and_goes_with_its_frames(tmp_path):
    path = write_film(tmp_path / "a.mp4", sweep(), "mp4v")
    found = imported(path, tmp_path / "set")
    assert "import.film_lossy_assumed" in codes(found.notes)
    frame = open_set(tmp_path / "set").frames[0]
    assert compression_of(frame).assumed
    assert compression_of(frame).grey == pytest.approx(5.77, abs=0.01)
    shutil.copy(frame, tmp_path / "elsewhere.png")
    assert compression_of(tmp_path / "elsewhere.png").assumed


def test_that_a_film_says_it_is_longer_than_its_frames_is_told(tmp_path):
    film = say_longer(write_film(tmp_path / "hand.mkv", sweep(60), "FFV1", rate=30.0), 0.2)
    notes = plan_import(ImportRequest(scan=Where(film))).notes
    assert [str(note) for note in notes if note.code == "import.film_shorter_than_said"] == [
        "hand.mkv has 60 frames, 6 fewer than its duration says: a longer sound track or a cut at its beginning would "
        "explain it; otherwise frames are lost."
    ]


def test_a_film_in_a_folder_without_pictures_is_found_and_of_several_one_is_to_be_named(tmp_path, film):
    assert len(plan_import(ImportRequest(scan=Where(tmp_path))).pictures) == 12
    shutil.copy(film, tmp_path / "other.avi")
    with pytest.raises(InputError, match=r"there are 2 films, as hand\.avi"):
        plan_import(ImportRequest(scan=Where(tmp_path)))
    assert len(plan_import(ImportRequest(scan=Where(tmp_path, "o*"))).pictures) == 12
    cv2.imwrite(str(tmp_path / "a.png"), sweep(1)[0])
    plan = plan_import(ImportRequest(scan=Where(tmp_path)))
    assert [one.source.name for one in plan.pictures] == ["a.png"]
    assert codes(plan.notes) == ["set.films_not_read"]


def test_a_picture_of_the_fan_alone_goes_with_a_film_if_it_has_its_size(tmp_path, film):
    cv2.imwrite(str(tmp_path / "fan.png"), sweep(1)[0])
    found = imported(film, tmp_path / "set", reference=tmp_path / "fan.png")
    assert open_set(tmp_path / "set").reference is not None
    assert found.ways == {"hard link": 1, "frame of a film": 12}
    cv2.imwrite(str(tmp_path / "fan.png"), np.zeros((8, 8), np.uint8))
    with pytest.raises(InputError, match="8 × 8 pixels"):
        plan_import(ImportRequest(scan=Where(film), reference=tmp_path / "fan.png"))


def test_views_and_poses_may_be_films_without_partners(tmp_path, film):
    plan = plan_import(ImportRequest(camera=Where(film), planes=Where(film)))
    assert {part: len(found) for part, found in plan.parts.items()} == {"camera": 12, "planes": 12}
    with pytest.raises(InputError, match="no partners"):
        plan_import(ImportRequest(planes=Where(film), planes_off=Where(film)))


def test_a_broken_film_leaves_nothing(tmp_path, film):
    film.write_bytes(film.read_bytes()[:-100])
    with pytest.raises(InputError, match="of its 13 frames can be read"):
        imported(film, tmp_path / "set")
    film.unlink()
    with pytest.raises(InputError, match="no such folder"):
        plan_import(ImportRequest(scan=Where(film)))


def test_a_film_that_breaks_between_the_preview_and_the_import_leaves_nothing(tmp_path, film):
    plan = plan_import(ImportRequest(scan=Where(film)))
    write_film(film, sweep(5))
    with pytest.raises(InputError, match="4 of its 12 frames can be read"):
        import_pictures(plan, tmp_path / "set")
    assert list((tmp_path / "set").iterdir()) == []


def test_an_import_that_is_cancelled_leaves_nothing(tmp_path, film):
    def at_five(step, done, total):
        if done == 5:
            raise Cancelled

    plan = plan_import(ImportRequest(scan=Where(film)))
    with pytest.raises(Cancelled):
        import_pictures(plan, tmp_path / "set", progress=at_five)
    assert list((tmp_path / "set").iterdir()) == []


def test_a_film_without_room_on_the_disk_is_refused_before_it_is_written(tmp_path, film, monkeypatch):
    plan = plan_import(ImportRequest(scan=Where(film)))
    monkeypatch.setattr(shutil, "disk_usage", lambda _: namedtuple("Usage", "free")(1000))
    with pytest.raises(InputError, match=r"0\.0 GB are free"):
        import_pictures(plan, tmp_path / "set")
    assert not (tmp_path / "set").exists()
