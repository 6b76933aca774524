"""What is told of a pose of the light planes, in every language by the same code."""

import math
from dataclasses import replace

import numpy as np

from core.calibrate.results import FanCalibration, PlanePose
from core.image.exclusion import Exclusion
from core.model import Fan, LightPlane, Pose
from core.report.facts.of_planes import plane_cells, sentence_on_pose
from core.report.wording import Words
from core.translations import language

NONE, SEEN = np.empty((0, 3)), np.ones((4, 3))
USED = PlanePose("pose00", Pose.identity(), 0.0312, (SEEN, NONE), (np.ones(4), np.empty(0)), 0.0421, used=True)


def test_a_pose_that_counts_tells_its_fit_and_lines_with_the_readers_decimal_sign():
    assert str(sentence_on_pose(USED)) == (
        "pose00: stripes RMS 0.042 mm from their planes, target RMS 0.031 px, 1 line seen"
    )
    assert str(sentence_on_pose(replace(USED, points=(SEEN, SEEN)))).endswith("2 lines seen")
    assert "0,042" in language("de")(sentence_on_pose(USED))


def test_a_pose_left_out_tells_why_and_how_far_off_it_is_where_that_is_known():
    out = replace(USED, used=False, exclusion=Exclusion.BY_HAND)
    assert str(sentence_on_pose(out)) == f"pose00: left out ({out.reason}); its stripes are 0.042 mm off the planes"
    assert str(sentence_on_pose(replace(out, rms_mm=math.nan))) == f"pose00: left out ({out.reason})"
    unknown = replace(out, exclusion=None, rms_mm=math.nan)
    assert str(sentence_on_pose(unknown)) == "pose00: left out (no reason recorded)"


def test_an_angle_whose_uncertainty_the_file_does_not_keep_has_none_rather_than_zero():
    planes = tuple(LightPlane(np.array([0.0, -1.0, slope]) / 150) for slope in (0.2, 0.3))
    known, unknown = Fan(planes, np.eye(6) * 1e-12), Fan(planes)
    for free, sd in ((known, True), (unknown, False)):
        fan = FanCalibration(known, free, (0.0, 0.0), known.angles, free.angles, 0.0, None, None, ())
        assert bool(plane_cells(fan)[0][-1].parts(Words())[1]) is sd
