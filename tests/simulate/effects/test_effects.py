"""Each effect of a real rig does what its docstring says, and none does anything until it is asked for."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses.plane_pose import measure_plane_pose
from core.errors import InputError
from core.files.pictures import compression_of, decode_colours, read_picture
from core.files.recording.recording_set import open_set
from core.simulate.calibration import CalibrationPictures
from core.simulate.effects.laser import LaserEffects
from core.simulate.effects.lens import LensEffects
from core.simulate.effects.plates import PlateEffects
from core.simulate.effects.room import RoomEffects
from core.simulate.effects.sensor import SensorEffects
from core.simulate.effects.warming import Warming
from core.simulate.rays import ray_map
from core.simulate.recording import changed_rig, scan_of, scenario_rig, simulate_set
from core.simulate.rig import Optics
from core.simulate.scenario import Scenario
from core.simulate.scene.boards import PLATES, printed
from core.simulate.scene.image import Sensor, generator
from core.simulate.scene.laser import laser_light
from core.simulate.scene.mirrors import mirrored_light, mirrors_of
from core.simulate.scene.patterns import draw_pattern
from core.simulate.scene.scene import surface_maps
from core.simulate.scene.wrong_plates import points_on_bowed, rays_to_bowed, scaled

BOWED = {"fan.bow_or_bend", "fan.bowed_target", "fan.bow_beyond_flatness"}
SMALL = Scenario(scale=0.15, frames=4, camera_views=2, plane_poses=2)


def picture(scenario, index=2):
    stage, sheets, _ = scan_of(scenario)
    return stage.frame(index, sheets[index])


def test_without_effects_the_pictures_are_those_of_before_there_were_any():
    """A figure of the pictures as they were rendered then; a few pixels may round otherwise on other machines."""
    frame = picture(SMALL).astype(np.int64)
    weighted = (frame * (np.arange(frame.size) % 251).reshape(frame.shape)).sum()
    assert weighted == pytest.approx(WEIGHTED_BEFORE, rel=1e-7)


WEIGHTED_BEFORE = 801168006


def test_automatic_exposure_changes_every_picture_by_a_factor_of_its_own():
    scenario = replace(SMALL, noise=0.0, sensor=SensorEffects(automatic_exposure=0.3))
    even = [picture(replace(scenario, sensor=SensorEffects()), index).mean() for index in range(4)]
    factors = [picture(scenario, index).mean() / mean for index, mean in enumerate(even)]
    assert np.ptp(factors) > 0.1
    assert all(0.65 < factor < 1.35 for factor in factors)


@pytest.mark.parametrize(
    "effect",
    [
        {"mirror_share": 0.5},
        {"laser": LaserEffects(edge=6.0)},
        {"laser": LaserEffects(halo=0.2)},
        {"laser": LaserEffects(shoulder=0.3)},
        {"lens": LensEffects(k3=1.0)},
        {"lens": LensEffects(coma_px=10.0)},
        {"lens": LensEffects(aperture_mm=8.0)},
        {"sensor": SensorEffects(brightness=3.0)},
        {"sensor": SensorEffects(brightness=6.0, bloom=0.9)},
        {"sensor": SensorEffects(smear=1e-3)},
        {"sensor": SensorEffects(hot_share=1e-3)},
        {"room": RoomEffects(flicker=0.5)},
        {"room": RoomEffects(lamp_frame=1, lamp_change=1.0)},
        {"room": RoomEffects(shadow=0.5)},
        {"warming": Warming(scan_px=1.0)},
        {"warming": Warming(scan_focal_ppm=3000.0)},
        {"warming": Warming(scan_urad=1000.0)},
    ],
)
def test_every_effect_of_a_scan_is_seen(effect):
    assert np.any(picture(replace(SMALL, **effect)) != picture(SMALL))


def test_a_scenario_reads_effects_from_tables():
    read = Scenario.from_toml("scale = 0.2\n[lens]\nk3 = 1\n[sensor]\ncolour = true\n[room]\nflicker = 0.3\n")
    wanted = Scenario(
        scale=0.2, lens=LensEffects(k3=1), sensor=SensorEffects(colour=True), room=RoomEffects(flicker=0.3)
    )
    assert read == wanted
    assert read.key == wanted.key != Scenario(scale=0.2).key


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("[lens]\nk4 = 1.0", "simulate.unknown_field"),
        ("[lens]\nk3 = true", "simulate.wrong_type"),
        ("lens = 3", "simulate.wrong_type"),
        ("[room]\nflicker = 3.0", "simulate.out_of_range"),
        ("bits = 16\n[sensor]\njpeg_quality = 50", "simulate.jpeg_is_8_bit"),
    ],
)
def test_what_no_table_can_hold_is_refused(text, code):
    with pytest.raises(InputError) as refused:
        Scenario.from_toml(text)
    assert refused.value.code == code


def test_a_laser_may_be_flat_or_have_a_halo_or_a_shoulder():
    d = np.linspace(-16, 16, 3201)
    seen = {effect: LaserEffects(**{effect: strength}).across(d) for effect, strength in STRENGTHS.items()}
    fourth = {effect: (light * d**4).sum() * light.sum() / (light * d**2).sum() ** 2 for effect, light in seen.items()}
    assert fourth["edge"] < 2.2 < 2.99 < 3.01 < fourth["halo"], "3 of a Gaussian"
    assert (seen["edge"] * d**2).sum() / seen["edge"].sum() == pytest.approx(1.0, abs=1e-6)
    third = {effect: (light * d**3).sum() / light.sum() for effect, light in seen.items()}
    assert third["shoulder"] > 0.1
    assert [third["edge"], third["halo"]] == pytest.approx([0, 0], abs=1e-9)
    assert np.array_equal(LaserEffects().across(d), np.exp(-0.5 * d**2))


def test_all_light_of_a_laser_with_a_halo_is_rendered():
    """A halo ends where nothing of it is seen, not where a Gaussian's light would."""
    bright = replace(SMALL, speckle=0.0, noise=0.0, texture=0.0, laser=LaserEffects(halo=1.0))
    stage, sheets, _ = scan_of(bright)
    light = laser_light(sheets[0], stage.scene, stage.maps)
    lit = np.abs(sheets[0].off_light(stage.maps.points.reshape(-1, 3), None)).reshape(light.shape)[light > 0]
    assert lit.max() > 4 * 0.22 * 4
    assert np.percentile(light[light > 0], 0.5) < 0.01 * light.max()


STRENGTHS = {"edge": 6.0, "halo": 0.2, "shoulder": 0.3}


def spot(depth_mm, lens, at=(100, 100), shape=(201, 201)):
    """The picture of a point at `at` (row, column), a camera's centre at (100, 100)."""
    camera = scenario_rig(Scenario(scale=0.15)).camera
    matrix = camera.matrix.copy()
    matrix[:2, 2] = 100.0
    light = np.zeros(shape, np.float32)
    light[at] = 1000.0
    depth = np.full(shape, depth_mm, np.float32)
    return lens.image(light, 1.0, replace(camera, matrix=matrix), depth, 1.0)


def moments(light):
    v, u = np.mgrid[: light.shape[0], : light.shape[1]]
    total = light.sum()
    mean = np.array([(light * u).sum(), (light * v).sum()]) / total
    second = np.array([(light * (u - mean[0]) ** 2).sum(), (light * (v - mean[1]) ** 2).sum()]) / total
    third = np.array([(light * (u - mean[0]) ** 3).sum(), (light * (v - mean[1]) ** 3).sum()]) / total
    return mean, second, third


def test_a_point_out_of_focus_is_blurred_by_the_thin_lens():
    lens = LensEffects(aperture_mm=6.0, focus_mm=500.0)
    focal = scenario_rig(Scenario(scale=0.15)).camera.matrix[0, 0]
    for depth in (450.0, 500.0, 600.0):
        _, second, _ = moments(spot(depth, lens))
        disk = focal * 6.0 * abs(1 / depth - 1 / 500.0)
        assert second == pytest.approx(1 + 1 / 12 + (disk / 4) ** 2, rel=0.02)


def test_coma_draws_points_out_away_from_the_centre_and_leaves_their_middle():
    mean, _, third = moments(spot(500.0, LensEffects(coma_px=12.0), at=(100, 180)))
    assert mean == pytest.approx([180, 100], abs=0.15)  # tails grow along themselves, too
    assert third[0] > 0.5
    assert abs(third[1]) < 0.05
    _, _, at_centre = moments(spot(500.0, LensEffects(coma_px=12.0)))
    assert np.abs(at_centre).max() < 0.05


def test_a_full_pixel_passes_light_on_downwards_and_a_column_smears():
    light = np.full((60, 20), 10.0, np.float32)
    light[20, 7] = 1250.0
    sensor = Sensor(Optics(), noise=0.0, effects=SensorEffects(bloom=0.5))
    seen = sensor.expose(light, generator(1, "x"))
    assert seen[20, 7] == 255
    assert seen[21, 7] == 255  # half of the 1000 beyond full, and the half of what it has beyond that
    assert seen[19, 7] == 15
    smeared = Sensor(Optics(), noise=0.0, effects=SensorEffects(smear=0.01)).expose(light, generator(1, "x"))
    assert smeared[50, 7] - smeared[50, 3] == pytest.approx(12.4, abs=1)


def test_hot_pixels_are_the_same_in_every_picture():
    light = np.full((300, 300), 10.0, np.float32)
    sensor = Sensor(Optics(), noise=0.0, effects=SensorEffects(hot_share=1e-3), seed=4)
    one, two = (sensor.expose(light, generator(1, "x", i)) for i in (1, 2))
    assert np.array_equal(one, two)
    assert 50 < np.count_nonzero(one > 15) < 130


def test_raw_pictures_of_a_mosaic_are_grey_and_rig_toml_says_which_it_is(tmp_path):
    scenario = replace(SMALL, frames=1, sensor=SensorEffects(colour=True, raw=True))
    simulate_set(scenario, tmp_path / "set")
    recording_set = open_set(tmp_path / "set")
    assert recording_set.rig.mosaic == "RGGB"
    seen = read_picture(recording_set.frames[0]).astype(float)
    rest = read_picture(recording_set.reference).astype(float)
    by_site = [np.quantile((seen - rest)[v::2, u::2], 0.999) for v in (0, 1) for u in (0, 1)]
    assert by_site[0] > 4 * max(by_site[1:])


def test_pictures_of_a_mosaic_are_coloured_and_jpeg_files_hold_half_the_colours(tmp_path):
    scenario = replace(SMALL, frames=1, sensor=SensorEffects(colour=True, jpeg_quality=80))
    simulate_set(scenario, tmp_path / "set")
    (frame,) = open_set(tmp_path / "set").frames
    assert frame.suffix == ".jpg"
    stage, sheets, _ = scan_of(scenario)
    blue, green, red = np.moveaxis(decode_colours(frame.read_bytes(), frame).astype(float), -1, 0)
    lit = stage.lit_by(sheets[0], rng=generator(1, "x")) - stage.room_light > 40
    assert (red - green)[lit].mean() > 20
    assert abs((red - green)[~lit].mean()) < 2
    assert abs((blue - green)[~lit].mean()) < 2
    in_grey, in_red = compression_of(frame).grey, compression_of(frame, "red").grey
    assert in_red > in_grey > 0


def test_a_lamp_a_flicker_and_a_shadow_change_the_room_and_leave_the_lasers():
    rng = generator(1, "room")
    assert RoomEffects().added(3, (10, 20), 0.0, rng) is None
    lamp = RoomEffects(lamp_frame=2, lamp_change=0.5)
    assert lamp.added(1, (10, 20), 0.0, rng) is None
    assert lamp.added(2, (10, 20), 0.0, rng) == pytest.approx(0.5)
    phases = [RoomEffects(flicker=0.3).added(i, (10, 20), 0.0, generator(1, "r", i)).item() for i in range(50)]
    assert np.std(phases) == pytest.approx(0.3 / np.sqrt(2), rel=0.2)
    bands = RoomEffects(flicker=0.3).added(0, (1000, 20), 0.04, rng)[:, 0]
    assert np.count_nonzero(np.diff(np.sign(bands))) == 8, "four periods in 40 ms"
    shade = RoomEffects(shadow=0.6).added(8, (10, 400), 0.0, rng)
    assert shade.min() == pytest.approx(-0.6, abs=0.01)
    assert shade.max() == pytest.approx(0.0, abs=0.01)
    dark = picture(replace(SMALL, noise=0.0, room=RoomEffects(lamp_frame=0, lamp_change=-1.0))).astype(float)
    still = picture(replace(SMALL, noise=0.0)).astype(float)
    stage, _, _ = scan_of(SMALL)
    unsaturated = still < 250
    assert np.abs(still - dark - stage.room_light)[unsaturated].max() <= 1.01


def test_a_bowed_plate_is_seen_where_its_points_are():
    scenario = replace(SMALL, scale=0.3)
    rig = scenario_rig(scenario)
    pattern = printed(PLATES["checkerboard"])
    pose = CalibrationPictures(scenario, rig, ray_map(rig.camera)).camera_poses["view00"]
    rays = rays_to_bowed(pattern, pose, ray_map(rig.camera), 3.0)
    x0, x1 = pattern.x_edges[[0, -1]]
    middle, half = (x0 + x1) / 2, (x1 - x0) / 2
    for x, y in ((10.0, 20.0), (150.0, 90.0), (80.0, 0.0)):
        point = np.array([x, y, -3.0 * ((x - middle) / half) ** 2])
        u, v = rig.camera.project(pose.apply(point[None]))[0]
        flat = pose.apply(np.array([[x, y, 0.0]]))[0]
        at = [map_coordinates(rays[..., k], [[v], [u]], order=1)[0] for k in range(2)]
        assert at == pytest.approx(flat[:2] / flat[2], abs=2e-6)


def test_the_fans_light_falls_on_the_bowed_plate_where_the_camera_sees_it():
    scenario = replace(SMALL, scale=0.3)
    rig = scenario_rig(scenario)
    pattern, pose = printed(PLATES["black_square"]), _first_plane_pose(scenario, rig)
    rays = ray_map(rig.camera)
    flat = draw_pattern(pattern, pose, rays)[0]
    assert points_on_bowed(pattern, pose, rays, flat, 0.0) is flat
    points = points_on_bowed(pattern, pose, rays, flat, 3.0).reshape(-1, 3).astype(np.float64)
    x, y, height = ((points - pose.translation) @ pose.rotation).T
    x0, x1 = pattern.x_edges[[0, -1]]
    inside = (x0 <= x) & (x <= x1) & (pattern.y_edges[0] <= y) & (y <= pattern.y_edges[-1])
    wanted = -3.0 * ((x - (x0 + x1) / 2) / ((x1 - x0) / 2)) ** 2
    assert inside.any() and np.abs(height - wanted)[inside].max() < 1e-3
    seen = rig.camera.project(points[inside])
    at = np.stack(np.meshgrid(*map(np.arange, rays.shape[1::-1])), axis=-1).reshape(-1, 2)[inside]
    assert np.abs(seen - at).max() < 1e-2


def _first_plane_pose(scenario, rig):
    return CalibrationPictures(scenario, rig, ray_map(rig.camera)).plane_poses["pose00"]


@pytest.mark.accuracy
def test_the_calibration_of_the_planes_sees_that_their_target_is_bowed():
    """Nothing is stated of it, so that 0.2 mm are assumed: 0.8 mm are found or refused, and a flat one is neither."""
    told = {}
    for mm in (0.0, 0.8):
        scenario = Scenario(scale=0.2, plane_poses=7, seed=5, plates=PlateEffects(plane_bow_mm=mm))
        rig = scenario_rig(scenario)
        pictures, seen = CalibrationPictures(scenario, rig, ray_map(rig.camera)), []
        for name in pictures.plane_poses:
            on, off = (picture for _, picture in pictures.render(name))
            seen.append(measure_plane_pose(name, on, off, PLATES[scenario.plane_target], rig.camera))
        try:
            fan = fit_fan(seen, rig.camera, FanOptions(3, np.radians(5.0), "auto", target=BoardTolerance(None, 0.0)))
            told[mm] = {note.code for note in fan.notes}
        except InputError as error:
            told[mm] = {error.what.code}
    assert not BOWED & told[0.0]
    assert BOWED & told[0.8], told


def test_a_larger_plate_is_larger():
    pattern = printed(PLATES["circle_grid"])
    larger = scaled(pattern, 0.01)
    assert np.ptp(larger.outline, axis=0) == pytest.approx(1.01 * np.ptp(pattern.outline, axis=0))
    assert larger.dot_radius == pytest.approx(1.01 * pattern.dot_radius)
    assert scaled(pattern, 0.0) is pattern


def test_plates_that_are_not_as_stated_change_their_pictures_alone(tmp_path):
    simulate_set(SMALL, tmp_path / "true")
    simulate_set(
        replace(SMALL, plates=PlateEffects(camera_bow_mm=2.0, plane_scale=0.02, plane_bow_mm=1.0)), tmp_path / "wrong"
    )
    for name, same in (("camera/view00.png", False), ("planes/pose00_off.png", False), ("scan/frame0001.png", True)):
        one, two = (read_picture(tmp_path / each / name) for each in ("true", "wrong"))
        assert np.array_equal(one, two) == same, name


def test_a_warm_camera_moves_its_picture():
    light = np.zeros((80, 100), np.float32)
    light[40, 50] = 1000.0
    light = cv2.GaussianBlur(light, (0, 0), 2.0)
    camera = scenario_rig(SMALL).camera
    mean, _, _ = moments(Warming(scan_px=2.0).at(0.5, light, camera))
    assert mean == pytest.approx([51.0, 40.6], abs=0.02)
    mean, _, _ = moments(Warming(scan_px=0.1).at(0.1, light, camera))
    assert mean == pytest.approx([50.01, 40.006], abs=5e-4), "no step is rounded"
    centre = camera.matrix[:2, 2]
    mean, _, _ = moments(Warming(scan_focal_ppm=20_000.0).at(1.0, light, camera))
    assert mean == pytest.approx(centre + 1.02 * (np.array([50, 40]) - centre), abs=0.02)
    rig = changed_rig(replace(SMALL, warming=Warming(focal_ppm=1000.0)), scenario_rig(SMALL))
    ratio = rig.camera.matrix / np.where(camera.matrix == 0, 1, camera.matrix)
    assert ratio[[0, 1, 0, 1], [0, 1, 2, 2]] == pytest.approx([1.001, 1.001, 1.0, 1.0])


def test_mirrored_light_obeys_the_law_of_reflection():
    """From the emitter to a lit point by way of the mirror, the angles to its normal are the same."""
    scenario = replace(SMALL, scale=0.3, frames=12)
    stage, sheets, _ = scan_of(scenario)
    lit = 0
    for sheet in sheets:
        light = np.zeros(stage.maps.albedo.shape, np.float32)
        mirrored_light(sheet, stage.scene, stage.maps, 1.0, light)
        points = stage.maps.points[light > 0.3 * max(light.max(), 1.0)].astype(float)
        found = np.zeros(len(points), bool)
        for mirror in mirrors_of(stage.scene):
            before = points @ mirror.normal - mirror.distance
            image = points - 2 * before[:, None] * mirror.normal  # the mirror's image of the point, seen by the laser
            off = sheet.plane.distances(image)
            found |= (before > 0) & (np.abs(off) < 3 * sheet.beam.sigma_mm)
        assert found.all()
        lit += len(points)
    assert lit > 100, "the block's sides mirror some of the sweeps"


def test_a_mirror_turned_away_shows_nothing():
    stage, sheets, _ = scan_of(SMALL)
    up = stage.scene.pose_cam_table.rotation[:, 2]
    for mirror in mirrors_of(stage.scene):
        image = mirror.image(sheets[0])
        behind = mirror.normal @ sheets[0].emitter < mirror.distance
        assert (image is None) == behind
        if image is not None:
            assert image.plane.distances(image.emitter[None])[0] == pytest.approx(0, abs=1e-9)
    assert any(mirror.normal @ up > 0.99 for mirror in mirrors_of(stage.scene)), "the upper face is one, too"


def test_rig_toml_of_an_unstated_rig_states_neither_stability_nor_plates(tmp_path):
    simulate_set(replace(SMALL, frames=0, stated=False), tmp_path / "set")
    rig = open_set(tmp_path / "set").rig
    assert rig.stability is None
    assert rig.camera_board.scale_sd is None
    assert rig.plane_board.flatness_mm is None


def test_the_maps_of_a_lens_with_k3_are_those_of_its_camera():
    rig = scenario_rig(replace(SMALL, lens=LensEffects(k3=2.0)))
    assert rig.camera.distortion[4] == 2.0
    stage, _, _ = scan_of(replace(SMALL, lens=LensEffects(k3=2.0)))
    there = surface_maps(stage.scene, rig.camera).points[3, 5]
    assert rig.camera.project(there[None].astype(float))[0] == pytest.approx([5, 3], abs=1e-3)
