import hashlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files.pictures import read_picture
from core.files.recording.recording_set import open_set
from core.simulate import sample
from core.simulate.recording import scan_of, simulate_set
from core.simulate.rig import published_fan
from core.simulate.scenario import OBJECTS, Scenario
from core.simulate.truth import load_truth, truth_folder

SMALL = Scenario(scale=0.12, frames=5, camera_views=2, plane_poses=2, seed=4)


def contents(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def block(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("sets") / "block"
    simulate_set(SMALL, folder)
    return folder


def test_a_set_holds_exactly_what_the_layout_says(block):
    frames = [f"scan/frame{i:04d}.png" for i in range(5)]
    planes = [f"planes/pose0{i}{end}.png" for i in range(2) for end in ("", "_off")]
    cameras = ["camera/view00.png", "camera/view01.png"]
    assert sorted(contents(block)) == sorted([*cameras, *planes, *frames, "scan/reference.png", "rig.toml"])


def test_the_set_opens_as_any_other(block):
    recording_set = open_set(block)
    assert recording_set.rig.lines == 3
    assert np.degrees(recording_set.rig.angle) == pytest.approx(5.0)
    assert recording_set.rig.gauge.nominal_mm == 50.0
    assert len(recording_set.frames) == 5
    assert [pair.off is not None for pair in recording_set.planes] == [True, True]


def test_the_truth_is_beside_the_set_and_never_in_it(block):
    truth = load_truth(block)
    assert truth_folder(block).parent == block.parent
    assert load_truth(truth_folder(block)).thing["thickness_mm"] == 50.0
    assert truth.thing["thickness_mm"] == 50.0
    assert sorted(truth.sweeps) == [f"frame{i:04d}" for i in range(5)]
    assert sorted(truth.plane_poses) == ["pose00", "pose01"]
    assert truth.depth.shape == truth.camera.image_size[::-1]
    assert np.degrees(truth.fan.angles) == pytest.approx([5.0, 5.0])
    rest = b"".join(path.read_bytes() for path in block.rglob("*.toml"))
    assert b"truth" not in rest
    assert not [path for path in block.rglob("*") if "truth" in path.name or path.suffix in (".json", ".npz")]


def test_the_same_scenario_gives_the_same_bytes(block, tmp_path):
    simulate_set(SMALL, tmp_path / "again")
    assert contents(tmp_path / "again") == contents(block)
    assert contents(tmp_path / "again.truth") == contents(truth_folder(block))


def test_another_seed_gives_other_pictures(block, tmp_path):
    simulate_set(replace(SMALL, seed=5), tmp_path / "other")
    ours, theirs = contents(block), contents(tmp_path / "other")
    assert all(ours[name] != theirs[name] for name in ours if name.endswith(".png"))


def test_frames_rendered_alone_are_those_of_the_set(block):
    stage, sheets, _ = scan_of(SMALL)
    assert (stage.frame(3, sheets[3]) == read_picture(block / "scan" / "frame0003.png")).all()
    assert (stage.reference() == read_picture(block / "scan" / "reference.png")).all()
    assert np.abs(load_truth(block).sweeps["frame0003"].pi - sheets[3].plane.pi).max() == 0


def test_the_fans_speckle_stands_still_and_the_sweeps_does_not():
    scenario = replace(SMALL, noise=0.0, scale=0.25, bits=16, texture=0.0)
    stage, sheets, _ = scan_of(scenario)
    reference = stage.reference().astype(int)
    frames = [stage.frame(i, sheets[0]).astype(int) - reference for i in range(2)]
    away = (frames[0] == 0) & (frames[1] == 0)
    fan = reference > reference.min() + 257 * 60
    assert (away & fan).sum() > 100  # where the sweep is not, the fan's grains are the reference's
    lit = frames[0] > 257 * 30
    assert np.corrcoef(frames[0][lit], frames[1][lit])[0, 1] < 0.95
    assert np.abs(frames[0] - frames[1])[lit].mean() > 257 * 4


def test_another_scan_can_share_the_calibration(block, tmp_path):
    simulate_set(replace(SMALL, height_mm=70.0, seed=9), tmp_path / "taller", calibration_from=block)
    ours, theirs = contents(block), contents(tmp_path / "taller")
    for name in ours:
        same = name.startswith(("camera/", "planes/"))
        assert (ours[name] == theirs[name]) == same, name
    mine, other = load_truth(block), load_truth(tmp_path / "taller")
    assert np.abs(mine.plane_poses["pose01"].vector - other.plane_poses["pose01"].vector).max() < 1e-9
    assert other.thing["thickness_mm"] == 70.0


def test_a_calibration_of_another_rig_is_refused(block, tmp_path):
    with pytest.raises(InputError, match="block"):
        simulate_set(replace(SMALL, scale=0.13), tmp_path / "set", calibration_from=block)
    with pytest.raises(InputError, match="block"):
        simulate_set(replace(SMALL, published_planes=True), tmp_path / "set", calibration_from=block)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("after", [0, 3, 7])
def test_cancelling_leaves_nothing_behind(tmp_path, after):
    calls = 0

    def stop(step: str, done: int, total: int) -> None:
        nonlocal calls
        calls += 1
        if calls > after:
            raise Cancelled

    with pytest.raises(Cancelled):
        simulate_set(SMALL, tmp_path / "set", stop)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path):
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "mine.txt").write_text("keep")
    with pytest.raises(InputError, match="set: "):
        simulate_set(SMALL, tmp_path / "set")
    assert (tmp_path / "set" / "mine.txt").read_text() == "keep"


def test_a_foreign_folder_where_the_truth_would_go_is_left_alone(tmp_path):
    (tmp_path / "set.truth").mkdir()
    (tmp_path / "set.truth" / "mine.txt").write_text("keep")
    with pytest.raises(InputError, match=r"set\.truth"):
        simulate_set(SMALL, tmp_path / "set")
    assert (tmp_path / "set.truth" / "mine.txt").read_text() == "keep"


def test_progress_comes_to_its_end(tmp_path):
    told = []
    simulate_set(SMALL, tmp_path / "set", lambda *what: told.append(what))
    assert ("calibration pictures", 4, 4) in told
    assert ("frames", 6, 6) in told


@pytest.mark.parametrize("name", [name for name in OBJECTS if name != "stl"])
def test_every_object_can_be_rendered(name):
    stage, sheets, figures = scan_of(replace(SMALL, object=name))
    assert figures["kind"] == name
    frame = stage.frame(2, sheets[2])
    assert (frame > 60).sum() > 60


def test_published_planes_and_sixteen_bits_are_choices(tmp_path):
    scenario = replace(SMALL, published_planes=True, bits=16, frames=1, reference=False, camera_views=1, plane_poses=1)
    simulate_set(scenario, tmp_path / "set")
    assert np.abs(load_truth(tmp_path / "set").fan.pis - published_fan().pis).max() == 0
    assert read_picture(tmp_path / "set" / "scan" / "frame0000.png").dtype == np.uint16
    assert not (tmp_path / "set" / "scan" / "reference.png").exists()


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("heigth_mm = 50.0", "heigth_mm"),
        ("frames = 2.5", "frames"),
        ("reference = 1", "reference"),
        ("frames = true", "frames"),
        ('object = "teapot"', "teapot"),
        ("height_mm = -1", "height_mm"),
        ("height_mm = nan", "height_mm"),
        ("bits = 12", "bits"),
        ('object = "stl"', "stl_path"),
        ("frames =", "TOML"),
    ],
)
def test_a_wrong_scenario_is_named_by_its_field(text, named):
    with pytest.raises(InputError, match=named):
        Scenario.from_toml(text)


def test_the_sample_is_rendered_once_and_then_found(tmp_path, monkeypatch):
    monkeypatch.setattr(sample.platformdirs, "user_cache_dir", lambda *_, **__: str(tmp_path / "cache"))
    monkeypatch.setattr(sample, "sample_scenario", lambda has_fan=True: SMALL)
    told = []
    first = sample.sample_set(lambda *what: told.append(what))
    assert open_set(first).frames
    assert told
    told.clear()
    assert sample.sample_set(lambda *what: told.append(what)) == first
    assert not told


def test_the_sample_is_the_50_mm_block_at_half_resolution():
    scenario = sample.sample_scenario()
    assert (scenario.object, scenario.height_mm, scenario.scale, scenario.frames) == ("block", 50.0, 0.5, 48)


def test_without_the_hand_held_laser_frames_show_the_fan_alone_and_the_plate_lies_on_the_table(tmp_path):
    scenario = replace(SMALL, hand_laser=False, fan_lines=1, travel_mm=2.0, frames=2)
    simulate_set(scenario, tmp_path / "set")
    found, truth = open_set(tmp_path / "set"), load_truth(tmp_path / "set")
    assert found.reference is None
    assert found.rig.lines == truth.fan.lines == 1
    assert [path.name for path in found.frames] == ["frame0000.png", "frame0001.png"]
    assert truth.sweeps == {}
    assert abs(truth.plane_poses["stage"].rotation[:, 2] @ truth.thing["table_normal"]) == pytest.approx(1.0)
    first, second = (read_picture(path).astype(float) for path in found.frames)
    assert np.abs(first - second).mean() > 0.5
