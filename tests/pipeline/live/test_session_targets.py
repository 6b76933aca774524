import time
from dataclasses import replace

import numpy as np
import pytest

from core.acquire.source import Lasers
from core.files.pictures import read_picture
from core.files.recording.rig import Rig
from core.image.stripes.stripe import StripeSettings
from core.image.targets import BlackSquare, Checkerboard, detect
from core.pipeline.live import camera as live_camera
from core.pipeline.live import planes as live_planes
from core.pipeline.live import session as live
from core.pipeline.live.commands import Auto, Capture, Discard, LookFor, Stop
from core.pipeline.live.events import LiveAnswered, LiveAsk, LiveNotice, LiveStarted, LiveTaken, LiveView
from core.pipeline.live.pose import find_pose
from core.settings.options import Options
from core.simulate.calibration import CalibrationPictures
from core.simulate.rays import ray_map
from core.simulate.recording import scenario_rig
from core.simulate.scenario import Scenario
from tests.pipeline.live_bench import ScriptedSource, Window, after, answer_to, record

RIG = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, np.radians(5.0))
SCENARIO = Scenario(scale=0.2, camera_views=4, plane_poses=3)
UNTIL_STOPPED = 2900
"""So many frames are more than a looker needs that gets little of a busy machine; a rule of the window stops before."""


class Plates:
    """Views of the camera's target, and poses of the plane target with the fan on and off."""

    def __init__(self):
        rig = scenario_rig(SCENARIO)
        self.camera = rig.camera
        pictures = CalibrationPictures(SCENARIO, rig, ray_map(rig.camera))
        self.views = [next(iter(pictures.render(name)))[1] for name in pictures.camera_poses]
        self.poses = [[picture for _, picture in pictures.render(name)] for name in pictures.plane_poses]
        self.nothing = np.random.default_rng(0).normal(60, 2, self.views[0].shape).astype(np.uint8)


@pytest.fixture(scope="module")
def plates():
    return Plates()


class OneAfterAnother:
    """Shows the next picture when the one before has been taken, or has been shown long enough."""

    def __init__(self, pictures, longest=1000):
        self.pictures, self.at, self.since, self.longest = pictures, 0, 0, longest

    def __call__(self, lasers, number):
        self.since += 1
        if self.since > self.longest:
            self.next()
        shown = self.pictures[min(self.at, len(self.pictures) - 1)]
        return shown if isinstance(shown, np.ndarray) else shown[0 if lasers.fan else 1]

    def next(self):
        self.at, self.since = self.at + 1, 0


def views_taken(monkeypatch, folder, plates, window, pictures, step="camera", frames=400, **choices):
    source = ScriptedSource(pictures, frames, pace_s=0.01, **{k: choices.pop(k) for k in ("switches",) if k in choices})
    return record(monkeypatch, source, window, step, RIG, folder / step, **choices)


def advance(pictures):
    """A rule: the next picture comes when one was taken; stop after the last."""

    def rule(event):
        if isinstance(event, LiveTaken):
            pictures.next()
            if pictures.at >= len(pictures.pictures):
                return Stop()
        return None

    return rule


def seen_often(sentence, times=5):
    """A rule: stop once pictures have been judged so this many times."""
    seen = [0]

    def rule(event):
        if isinstance(event, LiveView) and event.detail is not None:
            seen[0] += str(event.detail.sentence) == sentence
        return Stop() if seen[0] >= times else None

    return rule


def test_views_that_add_something_are_taken_by_themselves(monkeypatch, tmp_path, plates):
    pictures = OneAfterAnother(plates.views)
    window = Window(advance(pictures))
    ended = views_taken(monkeypatch, tmp_path, plates, window, pictures, frames=UNTIL_STOPPED)
    assert ended.recorded == 4
    assert [taken.name for taken in window.all(LiveTaken)] == ["view00", "view01", "view02", "view03"]
    assert all(taken.thumbnail.shape[1] <= 240 for taken in window.all(LiveTaken))
    for index, view in enumerate(plates.views):
        assert np.array_equal(read_picture(tmp_path / "camera" / f"view{index:02d}.png"), view)
    seen = [detail for detail in window.details if detail.uv is not None]
    assert seen[-1].uv.shape == (17 * 12, 2)
    assert seen[-1].views >= 3
    assert seen[-1].cells.any()
    assert [str(one) for one in seen[0].missing] == ["Record at least 10 views; there is none."]


def test_views_that_are_there_already_count_for_what_is_missing_and_are_not_taken_again(monkeypatch, tmp_path, plates):
    there = tuple(detect(RIG.camera_target, view, f"camera/view{n:02d}.png") for n, view in enumerate(plates.views[:3]))
    window = Window(seen_often("Turn the board: this tilt is already there."))
    shown = OneAfterAnother(plates.views[:1])
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, frames=UNTIL_STOPPED, there=there)
    assert ended.recorded == 0
    seen = [detail for detail in window.details if detail.uv is not None]
    assert str(seen[0].missing[0]) == "Record at least 10 views; there are 3."
    assert seen[0].cells.any()
    assert "Turn the board: this tilt is already there." in {str(detail.sentence) for detail in seen}


def test_a_board_counted_wrongly_is_counted_and_found_once_it_is_stated_right(monkeypatch, tmp_path, plates):
    def right(event):
        if isinstance(event, LiveView) and event.detail is not None and event.detail.counted is not None:
            return LookFor(replace(wrong.camera_target, columns=event.detail.counted[0]))
        return Stop() if isinstance(event, LiveTaken) else None

    wrong = replace(RIG, camera_target=Checkerboard(18, 12, 10.0))
    window, shown = Window(right), OneAfterAnother(plates.views[:1])
    source = ScriptedSource(shown, UNTIL_STOPPED, pace_s=0.01)
    ended = record(monkeypatch, source, window, "camera", wrong, tmp_path / "camera")
    assert ended.recorded == 1
    assert {detail.counted for detail in window.details} == {None, (17, 12)}
    assert "The board shows 17 × 12 inner corners, not 18 × 12." in {str(one.sentence) for one in window.details}


def test_the_same_view_is_taken_once(monkeypatch, tmp_path, plates):
    window = Window(seen_often("Turn the board: this tilt is already there."))
    shown = OneAfterAnother(plates.views[:1])
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, frames=UNTIL_STOPPED)
    assert ended.recorded == 1
    assert "Turn the board: this tilt is already there." in {str(detail.sentence) for detail in window.details}


def test_by_hand_a_view_is_taken_when_told_even_if_it_adds_nothing(monkeypatch, tmp_path, plates):
    pressed = []

    def hand(event):
        sentence = str(event.detail.sentence) if isinstance(event, LiveView) and event.detail is not None else ""
        for wanted in ("Press Take picture to take this view.", "Turn the board: this tilt is already there."):
            if sentence == wanted and wanted not in pressed:
                pressed.append(wanted)
                return Capture()
        return None

    window = Window(hand, after(2, LiveTaken, Stop()))
    pictures = OneAfterAnother(plates.views[:1])
    ended = views_taken(monkeypatch, tmp_path, plates, window, pictures, frames=1000, auto=False)
    assert ended.recorded == 2
    assert len(pressed) == 2


def test_auto_can_be_switched_off_and_on(monkeypatch, tmp_path, plates):
    def hand(event):
        sentence = str(event.detail.sentence) if isinstance(event, LiveView) and event.detail is not None else ""
        return Auto(True) if sentence.startswith("Press Take picture") else None

    window = Window(hand, answer_to(LiveStarted, Auto(False)), answer_to(LiveTaken, Stop()))
    pictures = OneAfterAnother(plates.views[:1])
    ended = views_taken(monkeypatch, tmp_path, plates, window, pictures, frames=1000)
    assert ended.recorded == 1
    assert any(not detail.auto for detail in window.details)


def test_capture_without_a_target_says_why(monkeypatch, tmp_path, plates):
    window = Window(after(3, LiveView, Capture()), answer_to(LiveNotice, Stop()))
    shown = OneAfterAnother([plates.nothing])
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, frames=UNTIL_STOPPED)
    assert ended.recorded == 0
    refused = window.all(LiveNotice)[-1]
    assert "No checkerboard is seen in the picture." in str(refused.sentence) and refused.refused


def test_a_discarded_view_is_put_aside_and_may_be_taken_again(monkeypatch, tmp_path, plates):
    window = Window(after(1, LiveTaken, Discard("view00")), after(2, LiveTaken, Stop()))
    shown = OneAfterAnother(plates.views[:1])
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, frames=UNTIL_STOPPED)
    assert ended.recorded == 1
    assert (tmp_path / "camera" / "discarded" / "view00.png").exists()
    assert [path.name for path in (tmp_path / "camera").glob("*.png")] == ["view01.png"]


def test_poses_are_taken_with_the_fan_on_and_off(monkeypatch, tmp_path, plates):
    pictures = OneAfterAnother(plates.poses)
    window = Window(advance(pictures))
    choices = {"frames": UNTIL_STOPPED, "camera": plates.camera}
    ended = views_taken(monkeypatch, tmp_path, plates, window, pictures, "planes", **choices)
    assert ended.recorded == 3
    assert sorted(path.name for path in (tmp_path / "planes").glob("*.png")) == [
        f"pose0{i}{end}.png" for i in range(3) for end in ("", "_off")
    ]
    for index, (on, off) in enumerate(plates.poses):
        assert np.array_equal(read_picture(tmp_path / "planes" / f"pose0{index}.png"), on)
        assert np.array_equal(read_picture(tmp_path / "planes" / f"pose0{index}_off.png"), off)
    seen = [detail for detail in window.details if detail.uv is not None and len(detail.stripes)]
    assert seen[-1].line == (0, 1, 2)
    assert len(seen[-1].stripes) == 3


def test_a_pose_whose_target_moved_between_the_pictures_is_not_kept(monkeypatch, tmp_path, plates):
    moved = [plates.poses[0][0], np.roll(plates.poses[0][1], 3, axis=1)]
    window = Window(answer_to(LiveNotice, Stop()))
    choices = {"frames": UNTIL_STOPPED, "camera": plates.camera}
    ended = views_taken(monkeypatch, tmp_path, plates, window, OneAfterAnother([moved]), "planes", **choices)
    assert ended.recorded == 0
    (refused,) = [notice for notice in window.all(LiveNotice) if notice.refused]
    assert "moved by" in str(refused.sentence)


class Late:
    """A camera whose pictures show the lasers as they were some frames ago, and a plate that is moved meanwhile."""

    def __init__(self, pose, frames, moved_after=None, by=3):
        self.pose, self.frames, self.moved_after, self.by = pose, frames, moved_after, by
        self.lit, self.on_since_off = [], 0

    def __call__(self, lasers, number):
        self.lit.append(lasers.fan)
        self.on_since_off = 0 if lasers.fan else self.on_since_off + 1
        fan = self.lit[max(0, len(self.lit) - 1 - self.frames)]
        picture = self.pose[0 if fan else 1]
        moved = self.moved_after is not None and self.on_since_off > self.moved_after
        return np.roll(picture, self.by, axis=1) if moved else picture


def test_a_picture_still_exposed_with_the_fan_on_is_not_taken_for_the_one_without(monkeypatch, tmp_path, plates):
    measured = []
    real = live_planes.measure_pair
    monkeypatch.setattr(live_planes, "measure_pair", lambda *args: measured.append(args[0]) or real(*args))
    window = Window(answer_to(LiveTaken, Stop()))
    shown, choices = Late(plates.poses[0], 8), {"frames": UNTIL_STOPPED, "camera": plates.camera}
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, "planes", **choices)
    assert ended.recorded == 1
    assert np.array_equal(read_picture(tmp_path / "planes" / "pose00_off.png"), plates.poses[0][1])
    assert measured == ["pose00"], "pictures with the fan still on are seen to be that before anything is measured"


@pytest.mark.parametrize("step", ["planes", "check"])
def test_stripes_on_the_plane_target_are_looked_for_as_its_own_page_says(monkeypatch, tmp_path, plates, step):
    looked = []
    real = live_planes.measure_pair
    monkeypatch.setattr(live_planes, "measure_pair", lambda *args: looked.append(args[5]) or real(*args))
    on_plate, in_scan = StripeSettings(4.0, 20.0), StripeSettings(9.0, 100.0)
    window = Window(answer_to(LiveTaken, Stop()))
    choices = {"frames": UNTIL_STOPPED, "options": Options(stripe=in_scan, plane_stripe=on_plate)}
    shown = Late(plates.poses[0], 0)
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, step, camera=plates.camera, **choices)
    assert ended.recorded == 1
    assert looked == [on_plate]


def test_both_pictures_of_a_pose_are_exposed_one_after_the_other(monkeypatch, tmp_path, plates):
    """However long the pose was looked at: a hand is not still for that long."""
    real = live_planes.find_pose
    monkeypatch.setattr(live_planes, "find_pose", lambda *args: time.sleep(0.3) or real(*args))
    numbered = [number % 250 for number in range(4000)]

    def shown(lasers, number):
        picture = plates.poses[0][0 if lasers.fan else 1].copy()
        picture[0, 0] = numbered[number]
        return picture

    window = Window(answer_to(LiveTaken, Stop()))
    choices = {"frames": UNTIL_STOPPED, "camera": plates.camera}
    ended = views_taken(monkeypatch, tmp_path, plates, window, shown, "planes", **choices)
    assert ended.recorded == 1
    on, off = (int(read_picture(tmp_path / "planes" / f"pose00{end}.png")[0, 0]) for end in ("", "_off"))
    assert (off - on) % 250 <= 2


def test_a_target_that_was_moved_is_told_from_pictures_that_came_late(monkeypatch, tmp_path, plates):
    def told(frames, moved_after):
        window = Window(answer_to(LiveNotice, Stop()))
        shown = Late(plates.poses[0], frames, moved_after)
        choices = {"frames": UNTIL_STOPPED, "camera": plates.camera}
        views_taken(monkeypatch, tmp_path, plates, window, shown, "planes", **choices)
        return window.all(LiveNotice)[-1].sentence

    moved, late = told(0, 0), told(12, 6)
    assert moved.code == "live.pose_moved"
    assert "hold it still" in str(moved)
    assert late.code == "live.pose_late"
    assert "1.3 s apart" in str(late)


def test_a_person_switches_the_fan_off_when_the_source_cannot(monkeypatch, tmp_path, plates):
    lit = [True]

    def hand(event):
        if isinstance(event, LiveAsk):
            lit[0] = False
            return event.answer
        return None

    window = Window(hand, answer_to(LiveTaken, Stop()))
    on, off = plates.poses[0]
    ended = views_taken(
        monkeypatch,
        tmp_path,
        plates,
        window,
        lambda lasers, number: on if lit[0] else off,
        "planes",
        switches=False,
        camera=plates.camera,
    )
    assert ended.recorded == 1
    assert window.all(LiveAsk)[0].button == "Continue"
    assert len(window.all(LiveAnswered)) == 1
    assert np.array_equal(read_picture(tmp_path / "planes" / "pose00_off.png"), off)


def test_poses_can_be_taken_without_a_second_picture(monkeypatch, tmp_path, plates):
    window = Window(answer_to(LiveTaken, Stop()))
    ended = views_taken(
        monkeypatch,
        tmp_path,
        plates,
        window,
        OneAfterAnother(plates.poses[:1]),
        "planes",
        camera=plates.camera,
        pairs=False,
    )
    assert ended.recorded == 1
    assert [path.name for path in (tmp_path / "planes").glob("*.png")] == ["pose00.png"]


def test_a_plate_without_the_fan_s_light_is_not_taken(monkeypatch, tmp_path, plates):
    def told(event):
        return isinstance(event, LiveView) and event.detail is not None and "is not seen" in str(event.detail.sentence)

    window = Window(lambda event: Stop() if told(event) else None)
    off, choices = plates.poses[0][1], {"frames": UNTIL_STOPPED, "camera": plates.camera}
    ended = views_taken(monkeypatch, tmp_path, plates, window, OneAfterAnother([off]), "planes", **choices)
    assert ended.recorded == 0
    assert any(map(told, window.events))


def test_a_pose_that_was_refused_is_not_tried_over_and_over(monkeypatch, tmp_path, plates):
    moved = [plates.poses[0][0], np.roll(plates.poses[0][1], 3, axis=1)]
    refused = [0]

    def later(event):
        if isinstance(event, LiveView) and event.detail is not None:
            refused[0] += refused[0] > 0 or "moved by" in str(event.detail.sentence)
        return Stop() if refused[0] > 40 else None

    window = Window(later)
    source = ScriptedSource(OneAfterAnother([moved]), UNTIL_STOPPED, pace_s=0.01)
    record(monkeypatch, source, window, "planes", RIG, tmp_path / "planes", camera=plates.camera)
    assert sum(call == Lasers(fan=False, hand=False) for call in source.calls) == 1
    assert refused[0] > 40


def test_a_check_does_without_pictures_with_the_fan_off_where_a_person_switches_it(monkeypatch, tmp_path, plates):
    window = Window(after(1, LiveTaken, Stop()))
    shown = OneAfterAnother([plates.poses[0][0]])
    ended = views_taken(
        monkeypatch, tmp_path, plates, window, shown, "check", frames=UNTIL_STOPPED, switches=False,
        camera=plates.camera,
    )  # fmt: skip
    assert ended.recorded == 1
    assert [path.name for path in ended.folder.glob("*.png")] == ["pose00.png"]
    assert not window.all(LiveAsk), "nobody is asked to switch the laser for it"


def corners_shown(times):
    """A rule: stop once this many pictures with corners have been shown."""
    seen = [0]

    def rule(event):
        seen[0] += isinstance(event, LiveView) and event.detail is not None and event.detail.uv is not None
        return Stop() if seen[0] >= times else None

    return rule


@pytest.mark.parametrize("look_s", [0.02, 0.4])
def test_corners_come_with_the_picture_they_were_found_in_however_long_that_took(monkeypatch, tmp_path, plates, look_s):
    """A look of 0.02 s keeps up with the pictures; one of 0.4 s does not, and newer ones are shown meanwhile."""
    found = detect(RIG.camera_target, plates.views[0], "")

    def find(frame, target, camera):
        time.sleep(look_s)
        return live_camera.FoundView(frame, found, blur_px=1.0)

    monkeypatch.setattr(live_camera, "find_view", find)
    window = Window(corners_shown(4))
    source = ScriptedSource(lambda lasers, number: np.roll(plates.views[0], number, axis=1), pace_s=0.01)
    record(monkeypatch, source, window, "camera", RIG, tmp_path / "camera", auto=False)
    shown = [view for view in window.all(LiveView) if view.detail is not None]
    with_corners = [view for view in shown if view.detail.uv is not None]
    assert len(with_corners) == 4
    assert all(view.detail.index == view.index for view in with_corners)
    if look_s > live.PATIENCE_S:
        assert len(shown) > 3 * len(with_corners), "the picture is to stay fluent"


def test_the_target_and_the_stripes_come_with_the_picture_they_were_found_in(monkeypatch, tmp_path, plates):
    on = plates.poses[0][0]
    looked_at = []

    def find(frame, *known):
        looked_at[:] = looked_at or [find_pose(frame, *known)]
        time.sleep(0.4)
        return replace(looked_at[0], frame=frame)

    monkeypatch.setattr(live_planes, "find_pose", find)
    window = Window(corners_shown(4))
    source = ScriptedSource(lambda lasers, number: np.roll(on, number, axis=1), pace_s=0.01)
    record(monkeypatch, source, window, "planes", RIG, tmp_path / "planes", auto=False)
    shown = [view for view in window.all(LiveView) if view.detail is not None]
    with_target = [view for view in shown if view.detail.uv is not None]
    assert with_target and all(view.detail.stripes and view.detail.index == view.index for view in with_target)
    assert [view for view in shown if view.detail.index != view.index]
    assert not any(view.detail.stripes or view.detail.line for view in shown if view.detail.uv is None)
