"""The paper's black square against the analytic truth of rendered pictures."""

import numpy as np
import pytest

from core.image.targets import BlackSquare, TargetNotFound, detect
from tests.image.rendered_targets import Noise, checkers, circles, pose, render, rig, square

SQUARE = BlackSquare(60.0)
CAMERA = rig(1 / 6)
POSES = {
    "frontal": pose(0, 0, 3, (30, 30), 400),
    "tilted": pose(30, -12, 12, (30, 30), 380, (20, -15)),
    "steep": pose(-20, 40, -30, (30, 30), 400),
}
STRIPES = [(0.15, 1, c, 1.5, 150) for c in (225, 250, 275)]


def corners(where):
    """True corners, clockwise from the one nearest to the top left of the picture."""
    true = CAMERA.project_pose(where, SQUARE.points)
    return np.roll(true, -int(np.argmin(true.sum(axis=1))), axis=0)


@pytest.mark.parametrize("name", POSES)
def test_corners_of_a_noise_free_square_are_true_to_two_hundredths_of_a_pixel(name):
    picture = render(CAMERA, POSES[name], square(60.0), blur=0.9, samples=8)
    view = detect(SQUARE, picture, camera=CAMERA)
    assert np.abs(view.uv - corners(POSES[name])).max() < 0.02
    assert view.sigma.max() < 0.03


def test_corners_are_unbiased_under_noise_and_sigma_is_the_size_of_the_errors():
    errors, sigmas = [], []
    for seed in range(8):
        picture = render(CAMERA, POSES["tilted"], square(60.0), blur=0.9, noise=Noise(4, seed), samples=3)
        view = detect(SQUARE, picture, camera=CAMERA)
        errors.append(view.uv - corners(POSES["tilted"]))
        sigmas.append(view.sigma)
    errors, sigmas = np.array(errors), np.array(sigmas)
    assert np.abs(errors.mean(axis=(0, 1))).max() < 0.01
    assert 0.5 < np.sqrt(np.mean(errors**2) / np.mean(sigmas**2)) < 1.5


def test_covariance_knows_the_middles_of_the_edges_better_than_their_ends():
    """A straight edge fitted to points all along it: its turn moves the two corners against each other."""
    middles, turns = [], []
    for seed in range(8):
        picture = render(CAMERA, POSES["tilted"], square(60.0), blur=0.9, noise=Noise(4, seed), samples=3)
        view = detect(SQUARE, picture, camera=CAMERA)
        errors, blocks = view.uv - corners(POSES["tilted"]), view.covariance.reshape(4, 2, 4, 2)
        for a, b in ((k, (k + 1) % 4) for k in range(4)):
            along = view.uv[b] - view.uv[a]
            across = np.array([along[1], -along[0]]) / np.linalg.norm(along)
            own = np.einsum("i,aibj,j->ab", across, blocks[[a, b]][:, :, [a, b]], across)
            middles.append((np.sum(errors[[a, b]] @ across) / 2, own.sum() / 4))
            turns.append((np.diff(errors[[a, b]] @ across)[0] / 2, (own[0, 0] + own[1, 1] - 2 * own[0, 1]) / 4))
        assert np.linalg.eigvalsh(view.covariance).min() > 0
        assert np.diag(view.covariance).reshape(4, 2).mean(axis=1) == pytest.approx(view.sigma**2)
    (middle, stated_middle), (turn, stated_turn) = np.array(middles).T, np.array(turns).T
    assert stated_middle.mean() < 0.5 * stated_turn.mean()
    assert 0.6 < np.mean(middle**2) / stated_middle.mean() < 1.6
    assert 0.6 < np.mean(turn**2) / stated_turn.mean() < 1.6


def test_laser_stripes_across_the_square_hardly_move_its_corners():
    picture = render(CAMERA, POSES["tilted"], square(60.0), blur=0.9, stripes=STRIPES, noise=Noise(1))
    view = detect(SQUARE, picture, camera=CAMERA)
    assert np.abs(view.uv - corners(POSES["tilted"])).max() < 0.05


def test_edges_are_straight_in_rays_not_in_pixels():
    camera = type(CAMERA)(CAMERA.image_size, CAMERA.matrix, [-0.9, 0, 0, 0])
    where = pose(5, 5, 2, (30, 30), 300, (35, 15))
    true = camera.project_pose(where, SQUARE.points)
    picture = render(camera, where, square(60.0), blur=0.9)
    with_camera = np.abs(detect(SQUARE, picture, camera=camera).uv - true).max()
    without = np.abs(detect(SQUARE, picture).uv - true).max()
    assert with_camera < 0.03 < 0.2 < without


def test_corners_run_clockwise_from_the_top_left_however_the_square_is_turned():
    for roll in range(0, 360, 80):
        where = pose(15, 10, roll, (30, 30), 400)
        view = detect(SQUARE, render(CAMERA, where, square(60.0), samples=2), camera=CAMERA)
        assert np.abs(view.uv - corners(where)).max() < 0.2


def test_sixteen_bit_and_dim_pictures_are_measured_alike():
    picture = render(CAMERA, POSES["tilted"], square(60.0), noise=Noise(1))
    uv = detect(SQUARE, picture, camera=CAMERA).uv
    assert np.abs(detect(SQUARE, picture.astype(np.uint16) * 16, camera=CAMERA).uv - uv).max() < 0.002
    assert np.abs(detect(SQUARE, picture // 8, camera=CAMERA).uv - uv).max() < 0.05


def test_an_over_exposed_plate_raises_sigma_by_the_shift_it_may_cause():
    good = detect(SQUARE, render(CAMERA, POSES["tilted"], square(60.0), blur=1.5), camera=CAMERA)
    picture = render(CAMERA, POSES["tilted"], square(60.0), blur=1.5, grey=(30, 340))
    view = detect(SQUARE, picture, camera=CAMERA)
    errors = np.linalg.norm(view.uv - corners(POSES["tilted"]), axis=1)
    assert view.sigma.min() > 5 * good.sigma.max()
    assert (errors < 3 * view.sigma).all()


def test_an_edge_under_a_stripe_along_it_is_refused_not_measured_wrong():
    where = POSES["frontal"]
    top = corners(where)[:2]
    normal = np.array([top[0, 1] - top[1, 1], top[1, 0] - top[0, 0]]) / np.linalg.norm(top[1] - top[0])
    stripe = (*normal, float(normal @ top.mean(axis=0)), 4.0, 200)
    picture = render(CAMERA, where, square(60.0), stripes=[stripe, (0.03, 1, float(top[0, 1]) + 4, 3.0, 150)])
    try:
        view = detect(SQUARE, picture, camera=CAMERA)
    except TargetNotFound as failure:
        assert "upper edge cannot be followed" in str(failure)
    else:
        errors = np.linalg.norm(view.uv - corners(where), axis=1)
        assert (errors < 5 * view.sigma + 0.05).all()


@pytest.mark.parametrize(
    ("pattern", "sentence"),
    [
        (checkers(4, 4, 18.0), "dark squares of like size are seen in the picture, not one"),
        (circles(np.array([[x, y, 0] for x in range(0, 70, 12) for y in range(0, 70, 12)]), 4.0), "no black square"),
    ],
)
def test_another_target_is_not_taken_for_a_square(pattern, sentence):
    picture = render(CAMERA, POSES["tilted"], pattern, samples=3, noise=Noise(1))
    with pytest.raises(TargetNotFound, match=sentence):
        detect(SQUARE, picture, "pose3.png")


def test_a_square_cut_off_by_the_picture_is_told_from_no_square():
    picture = render(CAMERA, POSES["tilted"], square(60.0), samples=3, noise=Noise(1))
    middle = int(corners(POSES["tilted"])[:, 0].mean())
    with pytest.raises(TargetNotFound, match="only a part of the black square is in the picture"):
        detect(SQUARE, np.ascontiguousarray(picture[:, :middle]))
