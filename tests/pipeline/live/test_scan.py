import json
import time
from dataclasses import replace

import numpy as np
import pytest

from core.acquire.source import Capabilities, Frame, Lasers, SourceSettings
from core.calibrate.fan.poses.pose_features import PoseFeatures
from core.errors import InputError
from core.files.pictures import is_picture, read_picture, write_picture
from core.files.project.calibration_store import READJUSTED_FROM
from core.files.recording.features_file import write_poses
from core.files.recording.marks import marked_frames
from core.files.recording.recording_log import read_log
from core.files.recording.rig import Rig
from core.image.targets import BlackSquare, Checkerboard
from core.pipeline.live import checks as live_checks
from core.pipeline.live import preview as live_preview
from core.pipeline.live import recorded_features
from core.pipeline.live import session as live
from core.pipeline.live.commands import Configure, Mark, Pause, Resume, Stop, Switch, TakeReference
from core.pipeline.live.events import (
    LiveAdvice,
    LiveAnswered,
    LiveAsk,
    LiveBack,
    LiveChecks,
    LiveNotice,
    LiveSaving,
    LiveStarted,
    LiveTaken,
    LiveUnplugged,
    LiveView,
)
from core.pipeline.live.warm_up import get_ready_for_live
from core.scan.features.extraction import read_reference
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario
from tests.pipeline.live_bench import ScriptedSource, Window, after, answer_to, record

RIG = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, np.radians(5.0))
FRAMES, SCALE = 16, 0.2


class Stage:
    """A simulated scan at a small scale, rendered once."""

    def __init__(self):
        stage, sheets, _ = scan_of(Scenario(scale=SCALE, frames=FRAMES))
        self.camera, self.fan = stage.rig.camera, stage.rig.fan
        self.reference = stage.reference()
        self.frames = [stage.frame(index, sheet) for index, sheet in enumerate(sheets)]
        self.dark = np.random.default_rng(0).normal(30, 2, self.reference.shape).astype(np.uint8)

    def __call__(self, lasers: Lasers, number: int):
        if not lasers.fan:
            return self.dark
        return self.frames[number % FRAMES] if lasers.hand else self.reference


@pytest.fixture(scope="module")
def stage():
    """With all compiled that a preview needs: the first look would outlast a recording of a second."""
    get_ready_for_live(np.uint8)
    return Stage()


@pytest.fixture(autouse=True)
def no_features(monkeypatch):
    """As if every recording were too short for its features to be kept: those are test_recorded_features.py's."""
    monkeypatch.setattr(recorded_features, "LOOK_AHEAD", 10**9)


def scan(monkeypatch, folder, stage, source, window, **choices):
    choices = {"camera": stage.camera, "fan": stage.fan, **choices}
    return record(monkeypatch, source, window, "scan", RIG, folder / "scan", **choices)


def swept(picture_of, frames, kind=ScriptedSource, **how):
    """A source that ends after so many frames with the hand-held laser on."""
    return kind(picture_of, frames, counts=lambda lasers: lasers.hand, **how)


def names(folder):
    return sorted(path.name for path in (folder / "scan").iterdir() if is_picture(path))


def test_a_source_that_switches_lasers_itself_takes_the_reference_and_scans(monkeypatch, tmp_path, stage):
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 20, pace_s=0.05), window)
    assert ended.error is None
    assert window.all(LiveStarted)[0].image_size == stage.reference.shape[::-1] == (768, 550)
    assert [taken.name for taken in window.all(LiveTaken)] == ["reference"]
    assert not window.all(LiveAsk)
    assert np.array_equal(read_picture(tmp_path / "scan" / "reference.png"), stage.reference)
    assert names(tmp_path) == [f"frame{i:05d}.png" for i in range(ended.recorded)] + ["reference.png"]
    assert ended.recorded >= 15
    last = window.details[-1]
    assert last.stage == "scanning"
    assert len(last.fan_lines) == 3
    assert last.cells.sum() > 20
    assert 0 < last.share < 1
    assert last.preview.name.startswith("frame")
    assert any(len(detail.points) for detail in window.details)


def test_frames_on_the_disk_are_the_source_s_bytes(monkeypatch, tmp_path, stage):
    shown = []

    def numbered(lasers, number):
        picture = stage(lasers, number)
        if lasers.hand:
            shown.append(picture)
        return picture

    ended = scan(monkeypatch, tmp_path, stage, swept(numbered, 20), Window())
    kept = [read_picture(tmp_path / "scan" / f"frame{i:05d}.png") for i in range(ended.recorded)]
    assert len(kept) > 10
    assert all(np.array_equal(a, b) for a, b in zip(kept[::-1], shown[::-1], strict=False))


def test_recording_does_not_wait_for_a_slow_window_nor_for_the_preview(monkeypatch, tmp_path, stage):
    window = Window(ready=False)
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 120), window)
    assert not window.all(LiveView)
    assert ended.recorded == 120
    assert ended.dropped == 0


def test_points_of_frames_that_were_not_shown_come_with_the_next_view(monkeypatch, tmp_path, stage):
    source = swept(stage, 50, pace_s=0.1)  # so slow that a busy machine previews more frames than it shows
    window = Window(ready=lambda: source.counted == 50)  # however long the reference takes
    scan(monkeypatch, tmp_path, stage, source, window)
    frames = np.unique(np.concatenate([detail.points.frame for detail in window.details]))
    assert len(frames) > len(window.all(LiveView))


def test_a_source_unplugged_in_the_middle_comes_back_and_nothing_is_lost(monkeypatch, tmp_path, stage):
    window = Window()
    source = swept(stage, 24, unplug_at={15}, away=2)
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    assert "cable" in str(window.all(LiveUnplugged)[0].sentence)
    assert len(window.all(LiveBack)) == 1
    assert ended.error is None
    assert names(tmp_path) == [f"frame{i:05d}.png" for i in range(ended.recorded)] + ["reference.png"]
    assert source.lit == Lasers(fan=True, hand=True)


def test_frames_the_source_lost_before_the_first_recorded_one_do_not_count(monkeypatch, tmp_path, stage):
    source = swept(stage, 20)
    read = source.read

    def losing(timeout_s):
        frame = read(timeout_s)
        return replace(frame, dropped=9 if source.counted > 10 else 7)

    source.read = losing
    ended = scan(monkeypatch, tmp_path, stage, source, Window())
    assert ended.dropped == 2


def test_a_damaged_frame_is_told_and_left_out(monkeypatch, tmp_path, stage):
    source = swept(stage, 20)
    read, told = source.read, []

    def damaged(timeout_s):
        if source.counted == 10 and not told:
            told.append(True)
            raise InputError("the picture is damaged", where="frame0010.png")
        return read(timeout_s)

    source.read = damaged
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    assert any("damaged" in str(notice.sentence) for notice in window.all(LiveNotice))
    assert (ended.recorded, ended.error) == (20, None)


def test_a_source_that_gives_nothing_but_damage_ends_with_the_reason(monkeypatch, tmp_path, stage):
    source = swept(stage, 20)

    def damaged(timeout_s):
        raise InputError("the picture is damaged", where="frame0010.png")

    source.read = damaged
    ended = scan(monkeypatch, tmp_path, stage, source, Window())
    assert "damaged" in str(ended.error)


def test_a_source_that_stays_away_can_be_given_up(monkeypatch, tmp_path, stage):
    window = Window(answer_to(LiveUnplugged, Stop()))
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 40, unplug_at={14}, away=10**6), window)
    assert ended.recorded > 0
    assert ended.error is None
    assert len(names(tmp_path)) == ended.recorded + 1


def test_a_person_is_asked_to_switch_lasers_that_the_source_cannot(monkeypatch, tmp_path, stage):
    source = swept(stage, 40, switches=False)

    def hand(event):
        """Do what is asked, then press the button."""
        if isinstance(event, LiveAsk):
            source.lit = Lasers(fan=True, hand=isinstance(event.answer, Resume))
            return event.answer
        return None

    window = Window(hand)
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    first, second = window.all(LiveAsk)
    assert (first.button, first.answer) == ("Take the reference", TakeReference())
    assert (second.button, second.answer) == ("Start", Resume())
    assert len(window.all(LiveAnswered)) == 2
    assert ended.recorded > 10
    assert np.array_equal(read_picture(tmp_path / "scan" / "reference.png"), stage.reference)


def test_a_reference_without_the_fan_is_refused_and_asked_for_again(monkeypatch, tmp_path, stage):
    source = swept(stage, 30, switches=False)
    asked = []

    def hand(event):
        if isinstance(event, LiveAsk):
            asked.append(event)
            source.lit = Lasers(fan=len(asked) > 1, hand=len(asked) > 2)
            return event.answer
        return None

    window = Window(hand)
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    assert any("no line of the fan" in str(notice.sentence) for notice in window.all(LiveNotice))
    assert len(asked) == 3
    assert ended.recorded > 0


def test_a_reference_is_not_taken_while_the_laser_is_swept(monkeypatch, tmp_path, stage):
    source = ScriptedSource(lambda lasers, number: stage.frames[number % FRAMES], 12, pace_s=0.01)
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    assert any("Something moves" in str(notice.sentence) for notice in window.all(LiveNotice))
    assert ended.recorded == 0
    assert not (tmp_path / "scan").exists()


def test_asked_twice_the_reference_is_taken_as_it_is(monkeypatch, tmp_path, stage):
    source = ScriptedSource(lambda lasers, number: stage.frames[number % FRAMES], 80, pace_s=0.01)
    window = Window(after(1, LiveNotice, TakeReference()))
    scan(monkeypatch, tmp_path, stage, source, window)
    assert [taken.name for taken in window.all(LiveTaken)] == ["reference"]


def test_a_pause_records_nothing_and_shows_on(monkeypatch, tmp_path, stage):
    scanning = [0]

    def hand(event):
        if isinstance(event, LiveView) and event.detail is not None and event.detail.stage == "scanning":
            scanning[0] += 1
            return Pause() if scanning[0] == 2 else None
        return None

    window = Window(hand)
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 60, pace_s=0.01), window)
    paused = [view for view in window.all(LiveView) if view.detail is not None and view.detail.stage == "paused"]
    assert len(paused) > 5
    assert len({view.recorded for view in paused}) == 1
    assert ended.recorded == paused[-1].recorded


def test_a_mark_is_kept_beside_the_frame_that_is_recorded_then(monkeypatch, tmp_path, stage):
    told = []

    def hand(event):
        if isinstance(event, LiveView) and event.recorded >= 3 and not told:
            told.append(event.recorded)
            return Mark()
        return Stop() if isinstance(event, LiveNotice) and event.sentence.code == "live.marked" else None

    scan(monkeypatch, tmp_path, stage, swept(stage, 10**6, pace_s=0.005), Window(hand))
    (marked,) = marked_frames(tmp_path / "scan")
    assert int(marked.removeprefix("frame").removesuffix(".png")) >= told[0] - 1
    assert marked in names(tmp_path)


def test_a_mark_that_cannot_be_written_ends_no_recording(monkeypatch, tmp_path, stage):
    pressed = []

    def hand(event):
        if isinstance(event, LiveView) and event.recorded >= 3 and not pressed:
            pressed.append(event.recorded)
            (tmp_path / "scan" / "marks.csv").mkdir()
            return Mark()
        return Stop() if isinstance(event, LiveView) and event.recorded >= 6 else None

    window = Window(hand)
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 10**6, pace_s=0.005), window)
    assert ended.recorded >= 6
    assert any("marks.csv" in str(notice.sentence) for notice in window.all(LiveNotice))


def test_resume_goes_on_counting_names(monkeypatch, tmp_path, stage):
    paused = []

    def hand(event):
        if not isinstance(event, LiveView) or event.detail is None:
            return None
        if event.detail.stage == "paused":
            paused.append(event.recorded)
            return Resume() if len(paused) == 3 else None
        return Pause() if event.recorded > 4 and not paused else None

    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 60, pace_s=0.01), Window(hand))
    assert len(paused) >= 3
    assert ended.recorded > paused[-1]
    assert names(tmp_path)[:-1] == [f"frame{i:05d}.png" for i in range(ended.recorded)]


def test_stop_ends_at_once_with_everything_on_the_disk(monkeypatch, tmp_path, stage):
    told = []

    def hand(event):
        if isinstance(event, LiveView) and event.recorded >= 5:
            told.append(event.recorded)
            return Stop()
        return None

    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 10**6, pace_s=0.005), Window(hand))
    assert ended.recorded == told[0]
    assert len(names(tmp_path)) == ended.recorded + 1


def test_without_calibrations_stripes_are_shown_but_no_points(monkeypatch, tmp_path, stage):
    window = Window()
    scan(monkeypatch, tmp_path, stage, swept(stage, 24, pace_s=0.03), window, camera=None, fan=None)
    previews = [detail.preview for detail in window.details if detail.preview is not None]
    assert any(len(preview.centrelines) for preview in previews)
    assert not any(len(detail.points) for detail in window.details)


def test_no_look_waits_until_the_stripe_s_width_is_found_and_three_frames_tell_it(monkeypatch, stage):
    searched, search = [], live_preview.choose_sweep_stripe
    monkeypatch.setattr(live_preview, "choose_sweep_stripe", lambda *a: (searched.append(a), search(*a))[1])
    previewer = live_preview.ScanPreviewer(stage.camera, stage.fan)
    previewer.read_reference(stage.reference)
    found = []
    for number, picture in enumerate([stage.dark, stage.reference, *stage.frames[:6]]):
        before = len(searched)
        preview = previewer.look(number, "", Frame(picture, number, 0.0, 0)).preview
        assert len(searched) == before
        found.append(sum(map(len, preview.centrelines)))
        while previewer.has_more:
            previewer.go_on()
    again = live_preview.ScanPreviewer(stage.camera, stage.fan, previewer._seen[0])
    again.read_reference(stage.reference)
    known = again.look(0, "", Frame(stage.frames[0], 0, 0.0, 0)).preview
    assert found[:2] == [0, 0]
    assert found[2] == pytest.approx(sum(map(len, known.centrelines)), rel=0.1)
    assert len(searched) == 1 + live_preview.SETTINGS_FROM


def test_a_fault_in_the_preview_never_ends_the_recording(monkeypatch, tmp_path, stage):
    def broken(*args):
        raise ZeroDivisionError("boom")

    monkeypatch.setattr(live_preview.ScanPreviewer, "_shown", broken)
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 40), window)
    assert any("boom" in str(notice.sentence) for notice in window.all(LiveNotice))
    assert ended.recorded > 20
    assert ended.error is None


def test_a_thing_that_was_moved_is_told_while_there_is_time(monkeypatch, tmp_path, stage):
    def moved(lasers, number):
        return np.roll(stage(lasers, number), 2, axis=0) if lasers.hand else stage(lasers, number)

    window = Window()
    scan(monkeypatch, tmp_path, stage, swept(moved, 30, pace_s=0.03), window)
    assert any("during the scan" in str(notice.sentence) for notice in window.all(LiveNotice))


def test_a_full_disk_pauses_and_asks(monkeypatch, tmp_path, stage):
    def full(path, picture):
        raise InputError("cannot be written, because the disk is full", where=path)

    recorder = live.Recorder
    monkeypatch.setattr(live, "Recorder", lambda folder, ending: recorder(folder, put=full))
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 30, pace_s=0.01), window)
    assert "disk is full" in str(window.all(LiveAsk)[0].sentence)
    assert "disk is full" in str(ended.error)
    assert ended.recorded == 0
    assert ended.dropped > 0


def test_frames_that_wait_for_a_slow_disk_are_saved_before_the_end(monkeypatch, tmp_path, stage):
    def slowly(path, picture):
        time.sleep(0.05)
        write_picture(path, picture)

    recorder = live.Recorder
    monkeypatch.setattr(live, "Recorder", lambda folder, ending: recorder(folder, put=slowly))
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 40), window)
    saving = [event.waiting for event in window.all(LiveSaving)]
    assert len(saving) > 2
    assert saving == sorted(saving, reverse=True)
    assert ended.recorded == len(names(tmp_path)) - 1 == 40


class PacedSource(ScriptedSource):
    """A source whose rate can be set; its clock goes on by one frame with each."""

    capabilities = Capabilities(rate_hz=(1.0, 100.0))
    rate_hz, now = 40.0, 0.0

    def configure(self, settings):
        super().configure(settings)
        self.rate_hz = settings.rate_hz or self.rate_hz

    def read(self, timeout_s):
        self.now += 1 / self.rate_hz
        return replace(super().read(timeout_s), time_s=self.now)


class SlowStore:
    """A disk that takes twenty frames a second, by the clock of the source, and has room for three more."""

    written = dropped = waiting = 0
    free_s = 0.0

    def __init__(self, folder, ending):
        folder.mkdir(exist_ok=True)

    def write(self, name, picture, frame, camera=""):
        taken = self.free_s <= frame.time_s + 3 / 20
        self.free_s = max(self.free_s, frame.time_s) + 1 / 20 if taken else self.free_s
        self.written, self.dropped = self.written + taken, self.dropped + (not taken)
        return taken

    def close(self):
        pass


def test_a_camera_that_is_too_fast_for_the_disk_is_slowed_until_no_frame_is_lost(monkeypatch, tmp_path, stage):
    monkeypatch.setattr(live, "Recorder", SlowStore)
    source, window = swept(stage, 600, kind=PacedSource, pace_s=0.0), Window()
    ended = scan(monkeypatch, tmp_path, stage, source, window)
    rates = [call.rate_hz for call in source.calls if isinstance(call, SourceSettings) and call.rate_hz]
    assert rates[0] == pytest.approx(32.0)
    assert 12 < rates[-1] < 20
    assert len(rates) == len([one for one in window.all(LiveNotice) if one.sentence.code == "live.rate_lowered"]) < 6
    assert 0 < ended.dropped < 100
    assert ended.recorded == 600 - ended.dropped


@pytest.mark.parametrize("trigger", ["Line1", None])
def test_a_camera_whose_rate_is_not_its_own_is_left_alone_and_the_loss_told(monkeypatch, tmp_path, stage, trigger):
    monkeypatch.setattr(live, "Recorder", SlowStore)
    source, window = swept(stage, 60, kind=PacedSource, pace_s=0.0), Window()
    source.capabilities = Capabilities(rate_hz=(1.0, 100.0), triggers=("Off", "Line1")) if trigger else Capabilities()
    ended = scan(monkeypatch, tmp_path, stage, source, window, settings=SourceSettings(trigger=trigger))
    assert ended.dropped > 0
    assert "live.disk_too_slow" in [one.sentence.code for one in window.all(LiveNotice)]
    assert source.rate_hz == 40.0


def test_settings_go_to_the_source_and_a_refusal_is_told(monkeypatch, tmp_path, stage):
    wanted = SourceSettings(exposure_ms=5.0)
    window = Window(
        after(2, LiveView, Configure(wanted)),
        after(3, LiveView, Configure(SourceSettings(gain_db=80.0))),
        after(4, LiveView, Switch(Lasers(fan=False, hand=False))),
    )
    source = swept(stage, 30)
    scan(monkeypatch, tmp_path, stage, source, window)
    assert wanted in source.calls
    assert any("no gain" in str(notice.sentence) for notice in window.all(LiveNotice))
    assert Lasers(fan=False, hand=False) in source.calls


def checks(event):
    return {check.name: check.state for check in event.checks}


def test_before_a_scan_what_it_needs_is_looked_at_and_told(monkeypatch, tmp_path, stage):
    window = Window()
    scan(monkeypatch, tmp_path, stage, swept(stage, 5, pace_s=0.05), window, calibrated_s=time.time() - 60)
    before, after_reference = window.all(LiveChecks)
    assert set(checks(before).values()) == {"unknown", "ok"}
    open_ones = {name: state for name, state in checks(after_reference).items() if state != "ok"}
    assert set(open_ones) == {"check", "focus"} and open_ones["focus"] == "unknown"  # no pose of the planes is kept


def focus_of_fan_calibrated_with(stripes, monkeypatch, folder, stage):
    """The check of a scan's focus where these stripes were seen in four poses of the fan's calibration."""
    history = folder / "calibrations"
    history.mkdir(exist_ok=True)
    (history / "planes-f1.json").touch()
    write_poses(history / "planes-f1.npz", "f1", [PoseFeatures(f"pose{k}", None, stripes) for k in range(4)])
    window = Window()
    scan(monkeypatch, folder, stage, swept(stage, 1, pace_s=0.05), window, kept_planes=(folder, "f1"))
    return next(check for check in window.all(LiveChecks)[-1].checks if check.name == "focus")


def test_stripes_that_reach_further_to_one_side_than_at_the_calibration_are_told_before_the_scan(
    monkeypatch, tmp_path, stage
):
    seen = read_reference(stage.reference).fan
    stripes = tuple(replace(piece, skewness=piece.skewness + 0.6 * np.sign(piece.normal[:, 0])) for piece in seen)
    focus = focus_of_fan_calibrated_with(stripes, monkeypatch, tmp_path, stage)
    assert (focus.state, focus.message.code) == ("failed", "scan.section_changed")


@pytest.mark.parametrize("damaged", [False, True])
def test_a_fan_that_is_or_may_be_readjusted_since_is_not_held_to_the_sections_of_its_calibration(
    monkeypatch, tmp_path, stage, damaged
):
    seen = read_reference(stage.reference).fan
    stripes = tuple(replace(piece, skewness=piece.skewness + 0.6 * np.sign(piece.normal[:, 0])) for piece in seen)
    kept = {"kind": "planes", "id": "f1", "kept_at": "2026-11-27T08:00:00+00:00", "used": 4, "total": 4}
    about = {**kept, "settings": {READJUSTED_FROM: "f0"}}
    (tmp_path / "calibrations").mkdir()
    (tmp_path / "calibrations" / "planes-f1.kept.json").write_text("{" if damaged else json.dumps(about))
    assert focus_of_fan_calibrated_with(stripes, monkeypatch, tmp_path, stage).state == "ok"


@pytest.mark.parametrize(("sharper", "state"), [(1.0, "ok"), (2.0, "failed")])
def test_the_focus_is_held_against_the_stripes_the_fan_was_calibrated_with(
    monkeypatch, tmp_path, stage, sharper, state
):
    stripes = tuple(replace(piece, width=piece.width / sharper) for piece in read_reference(stage.reference).fan)
    focus = focus_of_fan_calibrated_with(stripes, monkeypatch, tmp_path, stage)
    assert focus.state == state
    assert "px when the fan was calibrated" in str(focus.message)


def test_a_calibration_whose_poses_are_gone_leaves_it_open_whether_the_focus_is_as_it_was(monkeypatch, tmp_path, stage):
    window = Window()
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 1, pace_s=0.05), window, kept_planes=(tmp_path, "f1"))
    assert ended.error is None
    assert checks(window.all(LiveChecks)[-1])["focus"] == "unknown"


def test_a_reference_that_does_not_hold_any_more_is_told_while_nothing_is_recorded(monkeypatch, tmp_path, stage):
    monkeypatch.setattr(live_checks, "CHECK_EVERY_S", 0.1)
    pushed = np.roll(stage.reference, 12, axis=1)
    window = Window(
        answer_to(LiveAsk, TakeReference()),
        lambda event: Stop() if isinstance(event, LiveChecks) and checks(event)["reference"] == "failed" else None,
    )
    source = ScriptedSource(
        lambda lasers, number: pushed if window.all(LiveTaken) else stage.reference, 3000, switches=False, pace_s=0.01
    )
    scan(monkeypatch, tmp_path, stage, source, window)
    last = window.all(LiveChecks)[-1]
    assert "does not hold any more: " in str(last.checks[0].message)


def test_an_overexposed_stripe_brings_advice_that_can_be_followed(monkeypatch, tmp_path, stage):
    def glaring(lasers, number):
        picture = stage(lasers, number)
        swept_over = picture.astype(int) - stage.reference > 15
        return np.where(swept_over, 255, picture).astype(np.uint8) if lasers.hand else picture

    told = SourceSettings(exposure_ms=8.0)
    window = Window(answer_to(LiveAdvice, Stop()))
    scan(monkeypatch, tmp_path, stage, swept(glaring, 1500, pace_s=0.03), window, settings=told)
    advice = window.all(LiveAdvice)[0]
    assert "overexposed: set the exposure time to" in str(advice.sentence)
    assert advice.settings.exposure_ms in (4.0, 5.6)


def test_a_setting_the_source_does_not_have_is_left_out_and_told(monkeypatch, tmp_path, stage):
    window, source = Window(), swept(stage, 3)
    ended = scan(monkeypatch, tmp_path, stage, source, window, settings=SourceSettings(exposure_ms=5.0, trigger="Off"))
    assert ended.error is None
    assert source.calls[0] == SourceSettings(exposure_ms=5.0)
    assert str(window.all(LiveNotice)[0].sentence) == "Scripted camera has no trigger to set: what it has is used."
    assert window.all(LiveStarted)[0].capabilities.names == ("exposure_ms",)


def test_frames_are_recorded_in_the_format_that_was_chosen(monkeypatch, tmp_path, stage):
    ended = scan(monkeypatch, tmp_path, stage, swept(stage, 10), Window(), ending=".pgm")
    assert names(tmp_path) == [f"frame{i:05d}.pgm" for i in range(ended.recorded)] + ["reference.png"]
    assert [one.name for one in read_log(tmp_path / "scan")] == names(tmp_path)[:-1]
    for path in sorted((tmp_path / "scan").glob("*.pgm")):
        assert any(np.array_equal(read_picture(path), frame) for frame in stage.frames)


def test_a_source_that_cannot_be_opened_is_told_at_the_end(monkeypatch, tmp_path, stage):
    source = ScriptedSource(stage)
    source.missing = 1
    ended = scan(monkeypatch, tmp_path, stage, source, Window())
    assert "no such camera" in str(ended.error)
    assert not (tmp_path / "scan").exists()


def test_a_folder_that_holds_something_is_not_touched(monkeypatch, tmp_path, stage):
    (tmp_path / "scan").mkdir()
    (tmp_path / "scan" / "reference.png").write_bytes(b"older")
    ended = scan(monkeypatch, tmp_path, stage, ScriptedSource(stage), Window())
    assert "something in the folder" in str(ended.error)
    assert (tmp_path / "scan" / "reference.png").read_bytes() == b"older"


def test_pictures_for_the_window_are_reduced_by_a_whole_factor(monkeypatch, tmp_path, stage):
    window = Window()
    scan(monkeypatch, tmp_path, stage, ScriptedSource(stage, 12), window, display_px=300)
    view = window.all(LiveView)[0]
    assert view.scale == 3
    assert view.picture.shape == (550 // 3, 768 // 3)
    assert view.picture.dtype == np.uint8
