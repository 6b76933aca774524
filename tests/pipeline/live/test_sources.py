"""Live sources by name: what there is, what is missing, what is made of a choice."""

import pickle
from dataclasses import replace

import cv2
import numpy as np
import pytest

from core.acquire.source import Lasers, SourceChoice, SourceSettings, Unplugged
from core.errors import InputError
from core.files.pictures import write_picture
from core.files.recording.rig import read_rig
from core.image.targets import Charuco
from core.pipeline.live.sources import SOURCES, list_sources, make_source, scenario_of
from core.simulate.calibration import rig_toml
from core.simulate.sample import sample_scenario
from core.simulate.scenario import Scenario


@pytest.fixture
def rig(tmp_path):
    (tmp_path / "rig.toml").write_text(rig_toml(Scenario(camera_target="charuco")))
    return read_rig(tmp_path / "rig.toml")


def test_every_kind_has_a_title_and_one_line_of_help():
    assert list(SOURCES) == ["simulated", "opencv", "replay", "basler", "genicam", "aravis"]
    for kind in SOURCES.values():
        assert str(kind.title) and str(kind.device) and str(kind.device_help)
        assert "\n" not in str(kind.help)


def test_the_simulated_rig_is_never_missing_and_offers_several_objects():
    assert SOURCES["simulated"].missing is None
    offered = list_sources("simulated")
    assert offered[0].choice == SourceChoice("simulated", "")
    assert str(offered[0].detail) == "1920 × 1374 pixels"
    for info in offered:
        scenario_of(info.choice.id)


def test_without_its_driver_a_kind_lists_nothing_and_says_what_to_install(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert SOURCES["basler"].missing.code == "source.install_pypylon"
    assert list_sources("basler") == ()
    with pytest.raises(InputError, match=r"pip install .*\[basler\]"):
        make_source(SourceChoice("basler"))
    assert SOURCES["opencv"].missing is None


def test_unknown_kinds_are_refused():
    for call in (list_sources, lambda kind: make_source(SourceChoice(kind))):
        with pytest.raises(InputError, match="'webcam' is not one of simulated, opencv, replay, basler"):
            call("webcam")


def test_a_scenario_is_the_samples_or_toml_or_a_file_and_never_larger_than_real_time_allows(tmp_path):
    assert scenario_of("") == sample_scenario()
    assert scenario_of('object = "sphere"\nheight_mm = 40').height_mm == 40
    assert scenario_of("scale = 1.0").scale == 0.5
    (tmp_path / "small.toml").write_text("scale = 0.2")
    assert scenario_of(str(tmp_path / "small.toml")).scale == 0.2
    for wrong in ("colour = 3", str(tmp_path / "missing.toml")):
        with pytest.raises(InputError):
            scenario_of(wrong)


def test_the_simulated_rig_shows_the_projects_target(rig):
    source = make_source(SourceChoice("simulated", "scale = 0.2"), rig)
    assert isinstance(rig.camera_target, Charuco)
    width = source._scene._plates["camera"].outline[:, 0].max()
    assert width == pytest.approx(12 * 15 + 10)


def test_the_simulated_rigs_laser_must_be_the_projects(rig):
    with pytest.raises(InputError, match=r"3 lines, 5° apart.*1, 0° apart"):
        make_source(SourceChoice("simulated"), replace(rig, lines=1, angle=0.0))


def test_a_replayed_set_shows_the_step_that_is_recorded(tmp_path):
    for part, level in (("camera", 10), ("scan", 30)):
        (tmp_path / part).mkdir()
        write_picture(tmp_path / part / "one.png", np.full((4, 4), level, np.uint8))
    source = make_source(SourceChoice("replay", str(tmp_path)))
    source.configure(SourceSettings(rate_hz=0))
    source.open()
    source.prepare("scan")
    source.lasers(Lasers(fan=True, hand=True))
    assert source.read(1).picture[0, 0] == 30
    source.prepare("camera")
    assert source.read(1).picture[0, 0] == 10
    with pytest.raises(InputError, match="no folder is chosen"):
        make_source(SourceChoice("replay"))


def test_a_video_can_be_replayed_like_a_folder(tmp_path):
    film = tmp_path / "film.avi"
    writer = cv2.VideoWriter(str(film), cv2.VideoWriter.fourcc(*"MJPG"), 20, (64, 48), isColor=False)
    for level in (20, 200):
        writer.write(np.full((48, 64), level, np.uint8))
    writer.release()
    source = make_source(SourceChoice("replay", str(film)))
    source.configure(SourceSettings(rate_hz=0))
    source.open()
    assert [round(float(source.read(1).picture.mean()), -1) for _ in range(2)] == [20, 200]
    source.close()
    (tmp_path / "notes.txt").write_text("no video")
    with pytest.raises(InputError, match=r"notes\.txt: this is no video"):
        make_source(SourceChoice("replay", str(tmp_path / "notes.txt"))).open()


def test_sources_are_named_as_a_person_would(tmp_path):
    assert make_source(SourceChoice("simulated", "scale = 0.1")).name == "Simulated rig"
    assert make_source(SourceChoice("opencv", "1")).name == "camera 1"
    assert make_source(SourceChoice("replay", str(tmp_path / "monday"))).name == "monday"


def test_being_unplugged_is_an_input_error_that_survives_another_process():
    problem = pickle.loads(pickle.dumps(Unplugged("gone", where="camera 1", todo="plug it in")))
    assert isinstance(problem, Unplugged)
    assert str(problem) == "camera 1: gone; plug it in."


@pytest.mark.parametrize("settings", [{"exposure_ms": 0}, {"gain_db": 200}, {"rate_hz": -1}])
def test_absurd_settings_are_refused(settings):
    with pytest.raises(InputError):
        SourceSettings(**settings)


def test_settings_are_kept_where_nothing_newer_is_said():
    kept = SourceSettings(exposure_ms=2.0, rate_hz=10.0).updated(SourceSettings(rate_hz=0.0))
    assert kept == SourceSettings(exposure_ms=2.0, rate_hz=0.0)
