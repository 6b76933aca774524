"""The simulated rig in real time: what it shows, when, and that it counts what it loses."""

import threading
import time
from itertools import pairwise

import numpy as np
import pytest

from core.acquire.source import Lasers, SourceSettings
from core.errors import InputError
from core.image.targets import BlackSquare, Checkerboard
from core.simulate.calibration import CAMERA_GREY
from core.simulate.live.exposure_timer import RATE_HZ, ExposureTimer
from core.simulate.live.motion import CROSSING_S, PASS_S, HandPath
from core.simulate.live.scene import LiveScene, Moment
from core.simulate.live.source import SimulatedSource
from core.simulate.rays import ray_map
from core.simulate.rig import paper_rig
from core.simulate.sample import sample_scenario
from core.simulate.scenario import Scenario
from core.simulate.scene.image import generator
from core.simulate.scene.stage import aim_of, build_scene
from core.simulate.scene.targets import RenderContext, camera_picture, fan_light, room_light
from core.simulate.sweep import sweep_range

DARK, FAN, BOTH = Lasers(fan=False, hand=False), Lasers(fan=True, hand=False), Lasers(fan=True, hand=True)
SMALL = Scenario(scale=0.1)
AS_FAST = SourceSettings(rate_hz=0)


@pytest.fixture(scope="module")
def scene():
    return LiveScene(SMALL)


@pytest.fixture
def source(scene):
    before = threading.active_count()
    source = SimulatedSource(scene)
    yield source
    source.close()
    assert threading.active_count() == before


def pictures(source, count):
    return [source.read(5).picture for _ in range(count)]


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def test_a_camera_at_12_hz_that_is_always_ready_misses_nothing():
    clock = Clock()
    timer = ExposureTimer(clock)
    timer.set_rate(RATE_HZ)
    numbers = []
    for _ in range(30):
        clock.now += max(timer.wait_s(), 0.0) + 1e-9
        numbers.append(timer.expose())
        clock.now += 0.06
    assert numbers == [(n, 0) for n in range(30)]


def test_exposures_that_come_while_the_last_one_is_made_are_missed_and_counted():
    clock = Clock()
    timer = ExposureTimer(clock)
    timer.set_rate(RATE_HZ)
    assert timer.expose() == (0, 0)
    clock.now += 3.5 / 12
    assert timer.wait_s() < 0
    assert timer.expose() == (3, 2)
    assert timer.wait_s() == pytest.approx(0.5 / 12)
    assert timer.time_of(3) == pytest.approx(0.25)


def test_exposures_before_an_order_are_not_missed():
    clock = Clock()
    timer = ExposureTimer(clock)
    timer.set_rate(RATE_HZ)
    timer.expose()
    clock.now += 1.0
    timer.skip()
    clock.now += timer.wait_s() + 1e-9
    assert timer.expose() == (13, 0)


def test_time_goes_on_when_the_rate_is_changed():
    clock = Clock()
    timer = ExposureTimer(clock)
    timer.set_rate(RATE_HZ)
    timer.expose()
    clock.now += 2.0
    timer.set_rate(50.0)
    assert timer.now() == pytest.approx(2.0)
    clock.now += 0.1 + 1e-9
    number, lost = timer.expose()
    assert timer.time_of(number) == pytest.approx(2.1)
    assert lost == 0
    timer.delivered()
    timer.set_rate(0)
    assert timer.now() == pytest.approx(2.1, abs=1e-6)


def test_where_nobody_is_ready_time_waits_and_it_never_runs_faster_than_the_clock():
    clock = Clock()
    timer = ExposureTimer(clock)
    assert timer.expose() == (0, 0)
    timer.delivered()
    assert timer.wait_s() == pytest.approx(1 / 12)
    clock.now += 3.0
    assert timer.wait_s() < 0
    assert timer.expose() == (1, 0)
    assert timer.time_of(1) == pytest.approx(1 / 12)


@pytest.mark.parametrize("rate", [0, 12])
def test_a_pose_is_held_until_a_frame_of_it_was_dealt_with(scene, rate):
    """However long that takes; then the next one is held."""
    source = SimulatedSource(scene, clock=(clock := Clock()))
    source.configure(SourceSettings(rate_hz=rate))
    source.open()
    try:
        source.prepare("camera")
        seen = [rest_of(source, clock) for _ in range(60)]
        assert [rest for _, rest in seen] == [0] * 60
        source.go_on(seen[3][0])
        later = [rest_of(source, clock) for _ in range(60)]
        assert later[-1][1] == 1
        assert None in [rest for _, rest in later]
        source.go_on(seen[5][0])  # said of the pose before: it does not count for this one
        assert [rest_of(source, clock)[1] for _ in range(60)] == [1] * 60
    finally:
        source.close()


def test_a_slow_machine_need_not_draw_every_picture_of_a_plate_being_moved(scene):
    source = SimulatedSource(scene, clock=(clock := Clock()))
    source.open()
    try:
        source.prepare("camera")
        first, rest = rest_of(source, clock, 1.0)
        source.go_on(first)
        rests = [rest, *(rest_of(source, clock, 1.0)[1] for _ in range(8))]
        assert rests[-1] == 1
        assert 2 <= rests.count(None) <= 4
    finally:
        source.close()


def rest_of(source, clock, later_s=0.1):
    """The next frame, `later_s` later, and the pose that is held in it, None in a move."""
    clock.now += later_s
    frame = None
    while frame is None:
        frame = source.read(0.01)
        clock.now += 0.0 if frame is not None else 0.01
    return frame, source._hand.seen[frame.index]


def test_the_plate_rests_and_moves_without_a_jump(scene):
    motion = scene._motions["camera"]
    outline = scene._plates["camera"].outline
    times = np.arange(0, 2 * (motion.rest_s + motion.move_s), 0.01)
    corners = np.array([motion.at(t)[0].apply(outline) for t in times])
    rests = np.array([motion.at(t)[1] is not None for t in times])
    steps = np.abs(np.diff(corners, axis=0)).max(axis=(1, 2))
    assert steps.max() < 12.0
    assert steps[rests[1:] & rests[:-1]].max() == 0
    assert rests.mean() == pytest.approx(1.2 / 2.5, abs=0.02)
    assert motion.at(0)[1] == 0
    assert motion.at(16 * (motion.rest_s + motion.move_s) + 0.1)[1] == 0


def test_the_hand_moves_on_steadily_and_its_light_is_always_a_sheet_the_camera_can_measure_with():
    rig = paper_rig(0.1)
    stage, _ = build_scene(SMALL)
    path = HandPath(rig, sweep_range(stage, aim_of(stage)), generator(1, "hand"))
    times = np.arange(0, 2 * path._period, 0.05)
    sheets = [path.sheet(t) for t in times]
    assert min(sheet.plane.d_mm for sheet in sheets) > 120
    assert all(abs(sheet.plane.distances(sheet.emitter[None])[0]) < 1e-9 for sheet in sheets)
    emitters = np.array([sheet.emitter for sheet in sheets])
    assert np.linalg.norm(np.diff(emitters, axis=0), axis=1).max() / 0.05 < 2.5 * 1000 / CROSSING_S
    turned = [abs(a.plane.normal @ b.plane.normal) for a, b in pairwise(sheets)]
    assert np.degrees(np.arccos(np.clip(turned, -1, 1))).max() < 20
    half = len(times) // 2
    assert np.allclose(emitters[:20], emitters[half : half + 20], atol=20)


def test_pictures_are_the_twins_own_whatever_part_of_them_is_drawn(scene):
    quiet = LiveScene(Scenario(scale=0.25, noise=0.0, speckle=0.0))
    rays = ray_map(quiet.rig.camera)
    context = RenderContext(quiet.rig, rays, quiet._sensor)
    for time_s in (0.5, 2.0, 4.4):
        pose, _ = quiet._motions["camera"].at(time_s)
        plate = quiet._plates["camera"]
        whole = camera_picture(context, plate, pose, CAMERA_GREY, generator(1, "none"))
        drawn = quiet.picture(Moment("camera", DARK, time_s, 0.0, 3))
        assert np.array_equal(drawn, whole)
    pose, _ = quiet._motions["planes"].at(0.5)
    points, light = room_light(quiet._plates["planes"], pose, rays, 1.0)
    whole = fan_light(quiet.rig, points, light / light.max() * 0.8, pose)
    lit = quiet.picture(Moment("planes", FAN, 0.5, 0.0, 3)).astype(float)
    dark = quiet.picture(Moment("planes", DARK, 0.5, 0.0, 3)).astype(float)
    unsaturated = lit < 255
    assert np.abs((lit - dark) - whole)[unsaturated].max() < 1.5
    assert (lit - dark).max() > 60


def test_the_same_orders_give_the_same_pictures_in_the_simulations_own_time(scene):
    runs = []
    for _ in range(2):
        source = SimulatedSource(scene)
        source.configure(AS_FAST)
        source.open()
        try:
            source.prepare("planes")
            source.lasers(FAN)
            taken = pictures(source, 5)
            source.lasers(DARK)
            taken += pictures(source, 3)
            source.prepare("scan")
            source.lasers(BOTH)
            time.sleep(0.03)  # whatever was made meanwhile
            runs.append(taken + pictures(source, 5))
        finally:
            source.close()
    assert all(np.array_equal(a, b) for a, b in zip(*runs, strict=True))


def test_in_its_own_time_no_frame_is_lost_and_each_is_a_twelfth_of_a_second_later(source):
    source.configure(AS_FAST)
    source.open()
    frames = []
    for _ in range(6):
        frames.append(source.read(5))
        time.sleep(0.005)
    assert [frame.index for frame in frames] == list(range(6))
    assert frames[-1].dropped == 0
    assert np.diff([frame.time_s for frame in frames]) == pytest.approx(1 / 12)


def test_a_slow_reader_loses_frames_and_is_told_how_many(source):
    source.configure(SourceSettings(rate_hz=200))
    source.open()
    first = source.read(5)
    time.sleep(0.1)
    source.read(5)
    last = source.read(5)
    assert last.dropped >= 10
    assert last.index == first.index + 2 + last.dropped - first.dropped
    assert last.time_s - first.time_s > 0.09


def test_a_frame_read_after_an_order_shows_it(source):
    source.configure(AS_FAST)
    source.open()
    source.prepare("planes")
    source.lasers(FAN)
    for _ in range(3):
        on = source.read(5).picture
        assert source.lasers(DARK) is True
        off = source.read(5).picture
        source.lasers(FAN)
        assert (on.astype(int) - off > 50).sum() > 30


def test_the_scan_shows_the_fan_alone_until_the_hand_begins_and_goes_on_where_it_stopped(source, scene):
    source.configure(AS_FAST)
    source.open()
    source.prepare("scan")
    source.lasers(FAN)
    reference = source.read(5).picture.astype(int)
    source.lasers(BOTH)
    swept = [source.read(5).picture.astype(int) for _ in range(12)]
    assert all((frame - reference > 15).sum() > 60 for frame in swept)
    source.lasers(FAN)
    assert (source.read(5).picture.astype(int) - reference > 15).sum() < 60
    source.lasers(BOTH)
    again = source.read(5).picture.astype(int)
    middle = [np.median(np.nonzero(frame - reference > 15)[1]) for frame in (swept[-1], again)]
    assert abs(middle[0] - middle[1]) < 0.2 / PASS_S * reference.shape[1]


def test_exposure_and_gain_make_pictures_brighter(source):
    source.configure(AS_FAST)
    source.open()
    usual = source.read(5).picture.mean()
    source.configure(SourceSettings(exposure_ms=4.0))
    dark = source.read(5).picture.mean()
    source.configure(SourceSettings(gain_db=6.02))
    assert dark < 0.65 * usual
    assert source.read(5).picture.mean() == pytest.approx(usual, rel=0.02)


def test_nothing_within_the_time_gives_none(source):
    source.configure(SourceSettings(rate_hz=5))
    source.open()
    source.read(5)
    assert source.read(0.01) is None


def test_it_can_be_closed_twice_and_opened_again(source):
    source.open()
    source.read(5)
    source.close()
    source.close()
    source.open()
    assert source.read(5).index == 0


def test_what_fails_while_drawing_reaches_the_reader(source, scene, monkeypatch):
    def broken(*_):
        raise InputError("no light")

    monkeypatch.setattr(scene, "picture", broken)
    source.open()
    with pytest.raises(InputError, match="no light"):
        source.read(5)


def test_the_projects_targets_are_shown():
    shown = LiveScene(Scenario(scale=0.1), Checkerboard(9, 6, 20.0), BlackSquare(40.0))
    assert shown._plates["camera"].outline[:, 0].max() == pytest.approx(9 * 20 + 10)
    with pytest.raises(InputError, match="too large"):
        LiveScene(Scenario(scale=0.1), Checkerboard(17, 12, 300.0))


def test_the_truth_is_there_for_proofs(source):
    assert source.truth.thickness_mm == 50.0
    assert source.truth.camera.image_size == (384, 275)
    assert LiveScene(Scenario(scale=0.1, object="sphere")).truth.thickness_mm is None


@pytest.mark.accuracy
def test_frames_are_drawn_quickly_enough_for_real_time():
    scene = LiveScene(sample_scenario())
    for step, lasers in (("camera", DARK), ("planes", FAN), ("scan", BOTH)):
        scene.picture(Moment(step, lasers, 0.0, 0.0, 0))
        spent = []
        for number in range(24):
            begun = time.thread_time()
            scene.picture(Moment(step, lasers, 1.0 + number / 12, number / 12, number))
            spent.append(time.thread_time() - begun)
        assert np.median(spent) < 0.07
