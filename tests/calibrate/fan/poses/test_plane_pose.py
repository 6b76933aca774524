import re
from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest
from scipy.special import expit

from core.acquire.grey import to_grey
from core.calibrate.fan.calibration import FanOptions, fit_fan
from core.calibrate.fan.poses import plane_pose
from core.calibrate.fan.poses.located_pose import shows_no_stripe
from core.calibrate.fan.poses.plane_pose import ExtraPictures, measure_plane_pose
from core.calibrate.fan.poses.pose_features import PoseFeatures, usual_stripe
from core.image.stripes.noise import UNCOMPRESSED, Compression
from core.image.stripes.stripe import StripeSettings
from core.image.targets import BlackSquare, CircleGrid, TargetNotFound, detect
from core.model import Pose
from tests.calibrate import fan_scenes
from tests.calibrate.fan.test_calibration import worst_mm
from tests.calibrate.fan_scenes import ALPHA, PAPER
from tests.image import rendered_targets

CAMERA = fan_scenes.CAMERA.scaled(0.5)
SIDE = 60.0
TARGET = BlackSquare(SIDE)
STRIPE_MM = 0.7
HEIGHT = 120.0


@dataclass(frozen=True)
class Pair:
    on: np.ndarray
    off: np.ndarray


U, V = np.meshgrid(np.arange(CAMERA.image_size[0]), np.arange(CAMERA.image_size[1]))
RAYS = CAMERA.rays(np.column_stack([U.ravel(), V.ravel()]))


def plate(pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    """Albedo (H, W) of a plate of 160 mm with the square in its middle, and the points (H·W, 3) of all pixels."""
    normal = pose.rotation[:, 2]
    points = RAYS * (normal @ pose.translation / (RAYS @ normal))[:, None]
    x, y = ((points - pose.translation) @ pose.rotation[:, :2]).T
    off_centre = np.maximum(np.abs(x - SIDE / 2), np.abs(y - SIDE / 2))
    pixels = CAMERA.focal / points[:, 2]
    in_square, in_plate = (expit(2.5 * pixels * (half - off_centre)) for half in (SIDE / 2, 80))
    return (0.25 + 0.65 * in_plate - 0.82 * in_square).reshape(U.shape), points


def render(pose: Pose, *, seed: int, moved: Pose | None = None, gain: float = 1.0, exposure: float = 1.0) -> Pair:
    """8-bit pictures of the target, fan on (at `moved`, if given) and off."""
    rng = np.random.default_rng(seed)
    without = plate(pose)
    albedo, points = without if moved is None else plate(moved)
    light = np.full(albedo.size, 110.0)
    for pi in PAPER:
        distance = (points @ pi - 1) / np.linalg.norm(pi)
        near = np.abs(distance) < 5 * STRIPE_MM
        light[near] += HEIGHT * gain * np.exp(-0.5 * (distance[near] / STRIPE_MM) ** 2)
    pictures = [light.reshape(albedo.shape) * albedo, 110.0 * without[0]]
    on, off = (np.clip(np.round(exposure * p + rng.normal(0, 1.0, p.shape)), 0, 255).astype(np.uint8) for p in pictures)
    return Pair(on, off)


POSE = fan_scenes.poses(7, 1)[3]


def misses_px(features: PoseFeatures, pose: Pose = POSE) -> np.ndarray:
    """How far each point found is off the nearest true stripe, in pixels."""
    uv = np.vstack([line.uv for line in features.centrelines])
    rays = CAMERA.rays(uv)
    normal = pose.rotation[:, 2]
    target = normal / (normal @ pose.translation)
    misses = []
    for pi in PAPER:
        across = (pi - target)[:2]
        misses.append((rays @ (pi - target)) / np.linalg.norm(across) * CAMERA.focal)
    return np.abs(misses).min(axis=0)


@pytest.fixture(scope="module")
def pair() -> Pair:
    return render(POSE, seed=1)


@pytest.fixture(scope="module")
def measured(pair) -> PoseFeatures:
    return measure_plane_pose("p", pair.on, pair.off, TARGET, CAMERA)


def test_target_and_stripes_are_found_where_they_are(measured):
    assert measured.reason is None
    corners = CAMERA.project_pose(POSE, TARGET.points)
    nearest = np.linalg.norm(measured.view.uv[:, None] - corners, axis=2).min(axis=1)
    assert nearest.max() < 0.1
    misses = misses_px(measured)
    assert len(misses) > 600
    assert np.sqrt(np.mean(misses**2)) < 0.1
    assert np.quantile(misses, 0.99) < 0.25


def test_without_an_off_picture_the_light_plate_still_serves(pair):
    alone = measure_plane_pose("p", pair.on, None, TARGET, CAMERA)
    assert alone.reason is None
    on_stripe = misses_px(alone) < 1.5
    assert on_stripe.sum() > 300
    assert np.sqrt(np.mean(misses_px(alone)[on_stripe] ** 2)) < 0.1


@pytest.mark.parametrize("longer", [0.7, 1.3])
def test_pictures_that_are_not_exposed_alike_are_brought_to_one_exposure(pair, measured, longer):
    off = np.round(longer * pair.off).astype(np.uint8)
    features = measure_plane_pose("p", pair.on, off, TARGET, CAMERA)
    assert features.gain == pytest.approx(1 / longer, abs=0.01)
    misses = misses_px(features)
    assert len(misses) > 0.95 * len(misses_px(measured))
    assert np.sqrt(np.mean(misses**2)) < 0.1
    assert measured.gain == 1


def in_colour(pair: Pair) -> tuple[np.ndarray, np.ndarray]:
    """The pair as a colour camera sees it, in the order blue, green, red: the fan is red, all else grey."""
    grain = np.random.default_rng(5).normal(0, 1.0, (2, *pair.on.shape, 3))
    on = np.stack([pair.off, pair.off, pair.on], axis=-1) + grain[0]
    off = np.stack([pair.off] * 3, axis=-1) + grain[1]
    return tuple(np.clip(np.round(picture), 0, 255).astype(np.uint8) for picture in (on, off))


@pytest.mark.parametrize("with_off", [True, False])
def test_the_fan_is_seen_in_its_colour_and_the_target_in_grey(pair, with_off):
    on, off = in_colour(pair)
    grey = to_grey(on), to_grey(off) if with_off else None
    light = to_grey(on, "red-green"), to_grey(off, "red-green") if with_off else None
    features = measure_plane_pose("p", *light, TARGET, CAMERA, beside=ExtraPictures(grey))
    assert features.reason is None
    misses = misses_px(features)
    assert len(misses) > 600
    assert np.quantile(misses, 0.99) < 0.3
    sigma = np.concatenate([line.sigma for line in features.centrelines])
    assert np.sqrt(np.mean((misses / sigma) ** 2)) < 1.25


def test_stripes_are_found_in_other_channels_that_are_not_mere_crosstalk(pair, measured):
    def with_light(share: float, aside_px: float) -> tuple[np.ndarray, np.ndarray, Compression]:
        light = share * (pair.on.astype(np.float32) - pair.off)
        light = cv2.warpAffine(light, np.array([[1, 0, 0], [0, 1, aside_px]], np.float32), light.shape[::-1])
        return np.clip(np.round(pair.off + light), 0, 255).astype(np.uint8), pair.off, UNCOMPRESSED

    beside = ExtraPictures(others={"green": with_light(0.6, 0.5), "blue": with_light(0.1, 0.0)})
    features = measure_plane_pose("p", pair.on, pair.off, TARGET, CAMERA, beside=beside)
    assert np.array_equal(features.centrelines[0].uv, measured.centrelines[0].uv)
    assert features.others.keys() == {"green"}
    green = replace(features, centrelines=features.others["green"])
    assert np.median(misses_px(green)) == pytest.approx(0.5, abs=0.1)
    assert len(misses_px(green)) > 0.9 * len(misses_px(measured))
    assert measured.others == {}


def test_points_at_the_edges_of_the_square_are_left_out(measured):
    uv = np.vstack([line.uv for line in measured.centrelines])
    rays = CAMERA.rays(uv)
    normal = POSE.rotation[:, 2]
    points = rays * (normal @ POSE.translation / (rays @ normal))[:, None]
    x, y = ((points - POSE.translation) @ POSE.rotation)[:, :2].T
    inside = np.maximum(np.abs(x - SIDE / 2), np.abs(y - SIDE / 2)) < SIDE / 2 - 1
    assert not inside.any()


def test_a_target_that_moved_between_the_pictures_is_left_out():
    moved = Pose(POSE.rotation, POSE.translation + [0.6, 0.3, 0.0])
    spoilt = render(POSE, seed=2, moved=moved)
    features = measure_plane_pose("p", spoilt.on, spoilt.off, TARGET, CAMERA)
    assert "moved by" in str(features.reason)
    assert features.target_moved
    assert not shows_no_stripe(features, CAMERA)


GRID = CircleGrid(7, 7, 12.0)


@pytest.mark.parametrize(("moved_px", "searches", "told"), [(0.1, 1, None), (0.4, 2, None), (1.0, 2, "moved by 1.00")])
def test_a_grid_of_circles_is_found_again_only_where_it_may_have_moved(monkeypatch, moved_px, searches, told):
    """A line of light falls on the middle of the grid in the second picture."""
    off = rendered_targets.render(CAMERA, POSE, rendered_targets.circles(GRID.points, 3.5), grey=(30, 150))
    on = cv2.warpAffine(
        off,
        np.array([[1.0, 0.0, moved_px], [0.0, 1.0, 0.0]]),
        off.shape[::-1],
        flags=cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    ).astype(float)
    middle = CAMERA.project_pose(POSE, GRID.points).mean(axis=0)
    on += 80 * np.exp(-0.5 * ((np.arange(len(on))[:, None] - middle[1]) / 2) ** 2)
    found = []

    def counted(*args, **kwargs):
        found.append(detect(*args, **kwargs))
        return found[-1]

    monkeypatch.setattr(plane_pose, "detect", counted)
    features = measure_plane_pose("p", np.clip(on, 0, 255).astype(np.uint8), off, GRID, CAMERA)
    assert len(found) == searches
    if told is None:
        assert features.reason is None
    else:
        assert told in str(features.reason)


def with_a_line_along_the_upper_edge(picture: np.ndarray, pose: Pose) -> np.ndarray:
    """`picture` with so bright a stripe along the upper edge of the square at `pose` that the square is not found."""
    uv = CAMERA.project_pose(pose, TARGET.points)
    start, end = uv[np.argsort(uv[:, 1])[:2]]
    along = (end - start) / np.linalg.norm(end - start)
    across = (np.stack([U, V], axis=-1) - start) @ [-along[1], along[0]]
    return np.clip(picture + 160 * np.exp(-0.5 * (across / 2.0) ** 2), 0, 255).astype(np.uint8)


@pytest.mark.parametrize(
    ("moved_mm", "told"), [(0.0, "$"), (0.6, "the target moved by 1.6"), (20.0, "p: .* not checked whether it moved")]
)
def test_a_line_of_the_fan_along_an_edge_does_not_hide_a_movement(moved_mm, told):
    there = Pose(POSE.rotation, POSE.translation + [moved_mm, moved_mm / 2, 0.0])
    pair = render(POSE, seed=4, moved=there)
    on = with_a_line_along_the_upper_edge(pair.on, there)
    with pytest.raises(TargetNotFound, match="edge cannot be followed"):
        detect(TARGET, on, camera=CAMERA)
    features = measure_plane_pose("p", on, pair.off, TARGET, CAMERA)
    assert re.match(told, str(features.reason or " ".join(map(str, features.notes))))


def test_no_target_and_no_stripe_are_reasons_not_errors(pair):
    black = np.zeros_like(pair.on)
    assert "all black" in str(measure_plane_pose("p", black, None, TARGET, CAMERA).reason)
    dark_fan = measure_plane_pose("p", pair.off, pair.off, TARGET, CAMERA)
    assert "no stripe" in str(dark_fan.reason)
    assert dark_fan.reason is not None
    assert dark_fan.reason.values["grey"] < 3.0
    too_faint = measure_plane_pose("p", pair.on, pair.off, TARGET, CAMERA, StripeSettings(8.0, 1000.0))
    assert too_faint.reason is not None
    assert too_faint.reason.code == "fan.other_stripes"
    assert shows_no_stripe(too_faint, CAMERA)
    usual = usual_stripe([measure_plane_pose("p", pair.on, pair.off, TARGET, CAMERA)])
    assert usual is not None
    assert too_faint.reason.values["seen_px"] == pytest.approx(usual.width_px, rel=0.1)
    assert 20 < too_faint.reason.values["seen_grey"] < 1.2 * usual.contrast
    dark_and_told = measure_plane_pose("p", pair.off, pair.off, TARGET, CAMERA, StripeSettings(8.0, 1000.0))
    assert dark_and_told.reason is not None
    assert dark_and_told.reason.code == "fan.no_stripe"
    assert shows_no_stripe(dark_and_told, CAMERA)


def test_the_stripes_of_poses_tell_their_usual_width(pair):
    assert usual_stripe([]) is None
    found = measure_plane_pose("p", pair.on, pair.off, TARGET, CAMERA)
    usual = usual_stripe([found])
    assert usual is not None
    assert usual.width_px == pytest.approx(4 * np.median(np.concatenate([line.width for line in found.centrelines])))


def test_saturated_points_are_flagged():
    bright = render(POSE, seed=3, gain=3.0)
    features = measure_plane_pose("p", bright.on, bright.off, TARGET, CAMERA)
    assert np.concatenate([line.saturated for line in features.centrelines]).mean() > 0.8


def test_of_several_exposures_stripes_are_from_the_longest_that_is_not_saturated():
    first, shorter = (render(POSE, seed=3, gain=3.0, exposure=exposure) for exposure in (1.0, 0.25))
    dark, longer = (render(POSE, seed=4, gain=0.25, exposure=exposure) for exposure in (0.4, 1.6))
    for one, other in ((first, shorter), (dark, longer)):
        bracket = ExtraPictures(further=[(other.on, other.off)])
        both = measure_plane_pose("p", one.on, one.off, TARGET, CAMERA, beside=bracket)
        misses = misses_px(both)
        assert np.sqrt(np.mean(misses**2)) < 0.1
        assert np.concatenate([line.saturated for line in both.centrelines]).mean() < 0.1
    alone = measure_plane_pose("p", dark.on, dark.off, TARGET, CAMERA)
    sigma, worse = (np.median(np.concatenate([line.sigma for line in each.centrelines])) for each in (both, alone))
    assert sigma < 0.7 * worse


def test_pictures_of_different_size_are_refused(pair):
    with pytest.raises(ValueError, match="differ"):
        measure_plane_pose("p", pair.on, pair.off[:-1], TARGET, CAMERA)


@pytest.mark.parametrize("with_off", [True, pytest.param(False, marks=pytest.mark.accuracy)])
def test_pictures_to_fan(with_off):
    features = []
    for number, pose in enumerate(fan_scenes.poses(4, 3)):
        pair = render(pose, seed=10 + number)
        features.append(measure_plane_pose(f"p{number}", pair.on, pair.off if with_off else None, TARGET, CAMERA))
    result = fit_fan(features, CAMERA, FanOptions(3, ALPHA))
    error = (result.fan.pis - PAPER).ravel()
    assert worst_mm(result.fan.pis, PAPER) < 0.15
    assert error @ np.linalg.pinv(result.fan.covariance, rcond=1e-9, hermitian=True) @ error < 30
