import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.calibrate.camera.capture import CaptureJudge, what_is_missing
from core.image.targets.target_view import TargetView
from core.messages import plain
from core.model import Pose
from tests.calibrate.camera_views import TRUTH, board, synthetic_views

SIZE = TRUTH.image_size
SHARP = 1.1


def view(tilt_deg=(0.0, 0.0), pixel=(960.0, 687.0), depth=550.0, name="", moved_px=0.0) -> TargetView:
    points = board()
    rotation = Rotation.from_euler("xy", tilt_deg, degrees=True).as_matrix()
    centre = TRUTH.rays(np.array([pixel]))[0] * depth
    uv = TRUTH.project_pose(Pose(rotation, centre - rotation @ points.mean(axis=0)), points)
    return TargetView(points, uv + [moved_px, 0.0], np.full(len(points), 0.03), name)


class Bench:
    """A judge that sees three frames of each view, 0.1 s apart."""

    def __init__(self, camera=TRUTH):
        self.judge = CaptureJudge(SIZE, camera)
        self.now = 0.0

    def sees(self, *args, blur=SHARP, drift_px=0.0, **kwargs):
        verdict = None
        for step in range(4):
            self.now += 0.1
            verdict = self.judge.judge(view(*args, moved_px=step * drift_px, **kwargs), blur, self.now)
        return verdict

    def takes(self, *args, **kwargs):
        self.judge.record_taken(view(*args, **kwargs), self.now)
        self.now += 2.0


def test_a_still_and_sharp_first_view_is_taken():
    assert Bench().sees().take


def test_no_view_is_taken_before_the_board_has_rested():
    judge = CaptureJudge(SIZE, TRUTH)
    assert str(judge.judge(view(), SHARP, 0.0).sentence) == "Hold still."
    assert str(judge.judge(view(), SHARP, 0.1).sentence) == "Hold still."
    assert judge.judge(view(), SHARP, 0.25).take


def test_a_moving_board_is_told_to_hold_still():
    verdict = Bench().sees(drift_px=3.0)
    assert not verdict.take
    assert str(verdict.sentence) == "Hold still."


@pytest.mark.parametrize("blur", [4.0, float("nan")])
def test_a_blurred_view_is_left(blur):
    verdict = Bench().sees(blur=blur)
    assert not verdict.take
    assert "Too blurred" in str(verdict.sentence)


def test_smear_is_told_by_the_sharpest_view_seen_so_far():
    bench = Bench()
    assert bench.sees(blur=1.0).take
    assert not bench.sees(blur=2.0).take


def test_a_tilt_that_is_there_already_is_not_taken_again():
    bench = Bench()
    bench.takes()
    verdict = bench.sees(tilt_deg=(4.0, 2.0))
    assert not verdict.take
    assert str(verdict.sentence) == "Turn the board: this tilt is already there."


def test_another_tilt_another_place_and_another_distance_each_add_something():
    bench = Bench()
    bench.takes()
    assert bench.sees(tilt_deg=(20.0, 0.0)).take
    assert bench.sees(pixel=(500.0, 687.0)).take
    assert bench.sees(depth=700.0).take


def test_tilts_are_told_apart_without_a_calibrated_camera():
    bench = Bench(camera=None)
    bench.takes()
    assert not bench.sees(tilt_deg=(3.0, 0.0)).take
    assert bench.sees(tilt_deg=(25.0, 0.0)).take


def test_a_view_just_taken_is_said_for_a_second():
    bench = Bench()
    assert bench.sees().take
    bench.judge.record_taken(view(), bench.now)
    assert str(bench.sees(tilt_deg=(25.0, 0.0)).sentence) == "Taken."


def test_a_view_thrown_away_can_be_taken_again():
    bench = Bench()
    bench.takes(name="view00")
    assert not bench.sees().take
    bench.judge.forget("view00")
    assert bench.judge.views == ()
    assert not bench.judge.cells.any()
    assert bench.sees().take


def test_without_a_target_the_reason_is_said():
    judge = CaptureJudge(SIZE)
    unseen = plain("No checkerboard is seen in the picture.")
    assert judge.judge(None, float("nan"), 0.0, unseen).sentence == unseen
    assert str(judge.judge(None, float("nan"), 0.1).sentence) == "The target is not seen."


def test_a_board_that_is_seen_in_part_is_still_by_the_points_both_frames_show():
    judge = CaptureJudge(SIZE, TRUTH)
    whole = view()
    for step in range(4):
        part = slice(step, None)
        seen = TargetView(whole.points[part], whole.uv[part], whole.sigma[part])
        verdict = judge.judge(seen, SHARP, 0.1 * step)
    assert verdict.take


def test_with_no_view_only_their_number_is_missing():
    assert [str(one) for one in what_is_missing([], SIZE)] == ["Record at least 10 views; there is none."]


def test_few_views_of_one_tilt_in_one_place_lack_all_there_is():
    views = [view(tilt_deg=(x, 0.0), depth=620.0, pixel=(1100.0, 850.0)) for x in (0.0, 5.0, 10.0)]
    sentences = [str(one) for one in what_is_missing(views, SIZE, TRUTH)]
    assert sentences[0] == "Record at least 10 views; there are 3."
    assert "upper left corner" in sentences[1]
    assert sentences[2] == "Tilt the board more: the largest angle between two views is 10°, 30° is good."
    assert "nearer and farther" in sentences[3]
    assert len(sentences) == 4


def test_tilts_about_one_axis_only_are_noticed():
    views = [view(tilt_deg=(x, 0.0)) for x in (-25.0, -10.0, 10.0, 25.0)]
    assert any("about the same axis" in str(sentence) for sentence in what_is_missing(views, SIZE, TRUTH))


def test_nothing_is_missing_in_a_good_set():
    corners = [
        view(tilt_deg=(10, 10), pixel=p, depth=700.0) for p in ((480, 380), (1440, 380), (480, 1000), (1440, 1000))
    ]
    assert what_is_missing(synthetic_views(3) + corners, SIZE, TRUTH) == ()
