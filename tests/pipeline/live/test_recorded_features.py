"""What a live scan's frames show is kept while they are recorded, and is what the measurement would find."""

import shutil
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import gather_set
from core.files.results.scan_features import FEATURES
from core.pipeline.live import scan as live_scan
from core.pipeline.live.recorded_features import RecordedFeatures
from core.pipeline.steps.kept_features import stored_features
from core.pipeline.steps.scan.features import crossed_scan
from core.pipeline.steps.scan.pictures import look_at_scan
from core.scan.features.extraction import LOOK_AHEAD
from core.settings.options import Options
from tests.pipeline.live.test_scan import RIG, Stage, scan, swept
from tests.pipeline.live_bench import Window

SETTINGS = Options()


@pytest.fixture(scope="module")
def stage():
    return Stage()


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """However busy the machine is."""
    monkeypatch.setattr(live_scan, "LOOKING_S", 300.0)


def paced(stage, frames):
    """A source slow enough that most of its frames come when the reference has been read."""
    return swept(stage, frames, pace_s=0.1)


def recorded(folder):
    return gather_set(RIG, None, None, folder)


def looked_at_now(folder, camera):
    return crossed_scan(look_at_scan((recorded(folder), SETTINGS), camera=camera), camera)


def same(one, other):
    assert one.image_size == other.image_size and one.notes == other.notes
    assert (one.fan_stripe, one.sweep_stripe) == (other.fan_stripe, other.sweep_stripe)
    assert np.array_equal(one.crossings.uv, other.crossings.uv)
    for mine, theirs in zip(one.frames, other.frames, strict=True):
        assert (mine.name, mine.exclusion, mine.gain) == (theirs.name, theirs.exclusion, theirs.gain)
        assert [piece.uv.tobytes() for piece in mine.centrelines] == [p.uv.tobytes() for p in theirs.centrelines]
        assert [piece.sigma.tobytes() for piece in mine.centrelines] == [p.sigma.tobytes() for p in theirs.centrelines]


def test_after_a_recording_the_measurement_finds_what_its_frames_show(monkeypatch, tmp_path, stage):
    ended = scan(monkeypatch, tmp_path, stage, paced(stage, 30), Window())
    assert ended.recorded > 12
    folder = tmp_path / "scan"
    kept = stored_features(None, PictureReader(recorded(folder)), SETTINGS, stage.camera)
    assert kept is not None and len(kept.frames) == ended.recorded
    same(kept, looked_at_now(folder, stage.camera))


def test_they_are_not_taken_for_other_pictures_settings_or_camera(monkeypatch, tmp_path, stage):
    scan(monkeypatch, tmp_path, stage, paced(stage, 24), Window())
    folder = tmp_path / "scan"
    other = replace(stage.camera, distortion=2 * stage.camera.distortion)
    assert stored_features(None, PictureReader(recorded(folder)), SETTINGS, other) is None
    excluded = Options(excluded=frozenset({"scan/frame00003.png"}))
    assert stored_features(None, PictureReader(recorded(folder)), excluded, stage.camera) is None
    shutil.copy(folder / "frame00002.png", folder / "frame00003.png")
    assert stored_features(None, PictureReader(recorded(folder)), SETTINGS, stage.camera) is None
    (folder / FEATURES).write_bytes(b"torn")
    assert stored_features(None, PictureReader(recorded(folder)), SETTINGS, stage.camera) is None


@pytest.mark.filterwarnings("error::pytest.PytestUnhandledThreadExceptionWarning")
def test_of_a_folder_that_was_taken_away_nothing_is_kept(tmp_path, stage):
    looking = RecordedFeatures(tmp_path, ".png", RIG, stage.camera, SETTINGS, lambda: LOOK_AHEAD)
    for number in range(LOOK_AHEAD):
        looking.add(f"frame{number:05d}")
    assert looking.wait(30.0)
    assert not list(tmp_path.iterdir())


def test_without_a_calibrated_camera_or_with_too_few_frames_nothing_is_kept(monkeypatch, tmp_path, stage):
    scan(monkeypatch, tmp_path / "few", stage, paced(stage, 5), Window())
    assert not (tmp_path / "few" / "scan" / FEATURES).exists()
    scan(monkeypatch, tmp_path / "none", stage, paced(stage, 24), Window(), camera=None, fan=None)
    assert not (tmp_path / "none" / "scan" / FEATURES).exists()


def slowly(features):
    """The frames, three a second."""
    for name in features._names:
        time.sleep(0.3)
        yield features._path(name)


def test_frames_that_are_not_looked_at_in_time_are_left_to_the_measurement(monkeypatch, tmp_path, stage):
    monkeypatch.setattr(live_scan, "LOOKING_S", 0.0)
    monkeypatch.setattr(live_scan, "SAY_EVERY_S", 0.01)
    monkeypatch.setattr(RecordedFeatures, "_coming", slowly)
    ended = scan(monkeypatch, tmp_path, stage, paced(stage, 24), Window())
    assert not [thread for thread in threading.enumerate() if thread.name == "features"]
    assert ended.recorded > 8 and ended.error is None
    assert not (tmp_path / "scan" / FEATURES).exists()
