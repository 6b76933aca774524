"""`trisect record` and `trisect sources`: what is told and asked, what ends a recording, and what it refuses."""

import json
import signal
import sys
from functools import partial

import numpy as np
import pytest

from core.acquire.source import SourceChoice, SourceSettings
from core.calibrate.results import CameraCalibration, FanCalibration
from core.cli import recording
from core.files.recording.rig import Rig, rig_to_toml
from core.files.results.camera_file import camera_id, write_camera
from core.files.results.planes_file import write_planes
from core.image.targets import BlackSquare, Checkerboard
from core.messages import Message, label, plain
from core.model import Camera, Fan, LightPlane
from core.pipeline.live.commands import Capture, Resume, Stop
from core.pipeline.live.events import LiveAnswered, LiveAsk, LiveEnded, LiveNotice, LiveTaken, LiveView, PlanesDetail
from tests.calibrate.fan_scenes import CAMERA, PAPER
from tests.simulated import trisect

SIMULATED = ("--source", "simulated", "--device", "scale = 0.25")
QUESTION = LiveAsk(Message("live.take_reference", "Switch the laser on."), label("Start"), Resume())


@pytest.fixture
def folder(tmp_path):
    rig = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, np.radians(5.0))
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "rig.toml").write_text(rig_to_toml(rig), encoding="utf-8")
    return tmp_path / "set"


def performed(monkeypatch, script):
    """Have `script(commands, emit)` in the place of a live session, and what it returns come back."""

    def run_live(request, commands, emit, ready):
        assert ready()
        recorded, error = script(commands, emit)
        return LiveEnded(request.folder, recorded, 0, error)

    monkeypatch.setattr(recording, "run_live", run_live)


def typed(monkeypatch, *chunks):
    """Have these bytes come from standard input, and then its end."""
    left = [*chunks, b""]
    monkeypatch.setattr(recording.os, "read", lambda handle, most: left.pop(0))


def first(commands):
    """The next command, once there is one."""
    return next(filter(None, iter(commands, ())))


def view(recorded, missing=()):
    detail = PlanesDetail(0, None, (), (), None, None, missing, recorded, auto=True)
    return LiveView(None, 1, recorded, 10.0, recorded, 0, detail)


def test_a_simulated_scan_is_recorded_into_the_set_and_told_for_machines(folder):
    said = trisect("record", folder, "scan", *SIMULATED, "--pictures", "3", "--yes", "--json")
    assert said.code == 0, said.err
    told = json.loads(said.out)
    frames = sorted(path.name for path in (folder / "scan").glob("frame*.png"))
    assert told["pictures"] == len(frames) >= 3
    assert (folder / "scan" / "reference.png").exists()
    assert "reference taken" in said.err


def test_enter_answers_what_is_asked(monkeypatch, folder):
    def script(commands, emit):
        emit(QUESTION)
        assert first(commands) == Resume()
        emit(LiveAnswered())
        return 1, None

    performed(monkeypatch, script)
    typed(monkeypatch, b"\n")
    said = trisect("record", folder, "scan", *SIMULATED)
    assert said.code == 0, said.err
    assert "Switch the laser on. Enter: Start" in said.err


def test_enter_takes_a_pose_where_nothing_is_asked(monkeypatch, folder):
    performed(monkeypatch, lambda commands, emit: (int(first(commands) == Capture()), None))
    typed(monkeypatch, b"\n")
    assert "1" in trisect("record", folder, "planes", *SIMULATED).out


def test_nobody_there_to_answer_is_one_sentence(monkeypatch, folder):
    from core.errors import InputError

    def script(commands, emit):
        emit(QUESTION)
        with pytest.raises(InputError) as refused:
            first(commands)
        return 0, refused.value.message

    performed(monkeypatch, script)
    typed(monkeypatch)
    said = trisect("record", folder, "scan", *SIMULATED)
    assert said.code == 2
    assert "standard input has ended" in said.err
    assert "--yes" in said.err


def test_poses_end_when_none_is_missing_or_there_are_as_many_as_wanted(monkeypatch, folder):
    more = Message("advice.record_first", "Record at least 8 poses.")

    def script(commands, emit):
        emit(view(1, (more,)))
        assert commands() is None
        emit(LiveTaken("pose01", None))
        emit(view(2))
        return 2, None if commands() == Stop() else more

    performed(monkeypatch, script)
    said = trisect("record", folder, "planes", *SIMULATED, "--yes")
    assert said.code == 0, said.err
    assert said.err.count("Record at least 8 poses.") == 1
    performed(monkeypatch, lambda commands, emit: (emit(view(1, (more,))), more if commands() != Stop() else None))
    assert trisect("record", folder, "planes", *SIMULATED, "--yes", "--pictures", "1").code == 0


def test_ctrl_c_ends_it_in_order_and_a_second_one_at_once(monkeypatch, folder):
    def script(times, commands, emit):
        for _ in range(times):
            signal.raise_signal(signal.SIGINT)
        emit(LiveNotice(Message("live.marked", "Still here.")))
        return 4, None if commands() == Stop() else QUESTION.sentence

    before = signal.getsignal(signal.SIGINT)
    performed(monkeypatch, partial(script, 1))
    said = trisect("record", folder, "scan", *SIMULATED, "--yes")
    assert said.code == 0
    assert "Still here." in said.err
    performed(monkeypatch, partial(script, 2))
    assert trisect("record", folder, "scan", *SIMULATED, "--yes").code == 130
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_sigterm_ends_it_in_order_too_and_what_is_there_is_counted(monkeypatch, folder):
    def script(commands, emit):
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
        return 4, None if commands() == Stop() else QUESTION.sentence

    performed(monkeypatch, script)
    said = trisect("record", folder, "scan", *SIMULATED, "--yes")
    assert (said.code, "4" in said.out) == (143, True)
    assert said.sentence.startswith("trisect: interrupted;")


def test_a_quiet_recording_says_only_what_somebody_is_asked_to_do(monkeypatch, folder):
    def script(commands, emit):
        emit(LiveNotice(Message("live.marked", "Still here.")))
        emit(QUESTION)
        return 4, None

    performed(monkeypatch, script)
    told = trisect("record", folder, "scan", *SIMULATED, "--quiet").err
    assert "Still here." not in told
    assert "Enter:" in told


def test_what_ended_it_too_early_is_told_and_what_is_there_counted(monkeypatch, folder):
    full = Message("live.paused", "The disk is full.")
    performed(monkeypatch, lambda commands, emit: (7, full))
    said = trisect("record", folder, "scan", *SIMULATED, "--yes")
    assert said.code == 2
    assert "The disk is full." in said.err
    assert "7" in said.out
    as_json = trisect("record", folder, "scan", *SIMULATED, "--yes", "--json")
    assert json.loads(as_json.out)["error"].startswith("The disk is full")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("scan", "--source", "telescope"), "telescope"),
        (("table", "--source", "simulated"), "table"),
        (("scan", "--source", "simulated", "--exposure", "-1"), "exposure"),
        (("scan", "--source", "simulated", "--calibrations", "nowhere"), "nowhere"),
    ],
)
def test_what_cannot_be_recorded_is_refused(folder, words, told):
    said = trisect("record", folder, *words, "--yes")
    assert said.code == 2
    assert told in said.err
    assert not (folder / "scan").exists()


def test_a_scan_is_judged_by_the_camera_that_the_fan_is_used_with(folder, tmp_path):
    planes, places = tuple(LightPlane(pi) for pi in PAPER), 1e-8 * np.eye(9)
    camera = CameraCalibration(CAMERA, 1e-4 * np.eye(10), (), 0.1, 0.1, 1.0, 0.5, 0.01)
    corrected = Camera(CAMERA.image_size, CAMERA.matrix * 1.0001, CAMERA.distortion)
    fan = FanCalibration(
        Fan(planes, places), Fan(planes), (0.01,) * 3, (0.087,) * 2, (0.087,) * 2, 0.02, True, plain("It suits."), (),
        camera=corrected, camera_covariance=1e-4 * np.eye(10),
    )  # fmt: skip
    write_camera(tmp_path / "camera.json", camera)
    write_planes(tmp_path / "planes.json", fan, CAMERA)
    known = (SourceChoice("simulated"), tmp_path, SourceSettings(), ".png")
    assert camera_id(recording.request(folder, "scan", *known).camera) == camera_id(corrected)
    assert camera_id(recording.request(folder, "planes", *known).camera) == camera_id(CAMERA)


def test_pictures_that_are_there_are_not_mixed_with_new_ones(folder):
    (folder / "scan").mkdir()
    (folder / "scan" / "frame00000.png").write_bytes(b"old")
    said = trisect("record", folder, "scan", *SIMULATED, "--yes")
    assert said.code == 2
    assert "something in the folder" in said.err
    assert (folder / "scan" / "frame00000.png").read_bytes() == b"old"


def test_the_sources_are_listed_for_people_and_machines():
    assert "Gauge block of 50 mm" in trisect("sources").out
    listed = json.loads(trisect("sources", "--json").out)["sources"]
    assert {"source": "simulated", "name": "Sphere of 50 mm", "device": 'object = "sphere"'} in listed
