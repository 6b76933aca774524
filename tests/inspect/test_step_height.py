"""Thickness by the step on light profiles: faces found, tilt told or taken, uncertainty as large as the errors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.deviations import Deviation
from core.inspect.causes import CALIBRATIONS, Cause
from core.inspect.profile_faces import faces_of, stretches
from core.inspect.step_height import NO_FACES, NO_TILT, NOT_PLANE, KnownTilt, Step, measure_steps, step_of
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.scan.common_errors import CommonErrors
from core.scan.surface.cloud import FAN, Cloud
from core.scan.surface.triangulate import join
from tests.inspect.profile_pictures import CORRELATION_PX, NORMAL, RIG, errors, fan_of, picture
from tests.shared import REAL_SETS

REAL = REAL_SETS / "gaugeblock"

BLOCK = ((-150.0, -40.0, 0.0), (-20.0, 30.0, 20.0), (60.0, 150.0, 0.0))
"""A table, a block of 20 mm on it, and the table again behind a shadow."""
ONE = fan_of([0])
KNOWN = KnownTilt(tuple(NORMAL.tolist()), np.radians(0.1))


def step(cloud, tilt=None, fan=RIG.fan) -> Step:
    found = step_of(cloud, errors(fan), tilt)
    assert not isinstance(found, Message), str(found)
    return found


def test_straight_stretches_end_at_gaps_and_bends_and_keep_off_the_edges():
    found = stretches(picture(BLOCK, fan=ONE))
    assert [one.length_mm for one in found] == pytest.approx([107, 47, 87], abs=1.0)


def test_both_sides_of_the_table_are_one_face():
    cloud = picture(BLOCK, noise_px=0.05)
    pair = faces_of(cloud, stretches(cloud), None)
    heights = -cloud.points @ NORMAL + 560.0
    assert heights[pair.upper].min() > 19.5
    assert np.ptp(cloud.points[pair.lower, 0]) > 250
    assert heights[pair.lower].max() < 0.5


def test_exact_profiles_give_the_exact_step_and_the_tilt_by_themselves():
    found = step(picture(BLOCK))
    assert found.faces.planes.tilt_determined
    assert found.thickness_mm == pytest.approx(20.0, abs=1e-4)
    assert found.faces.planes.normal == pytest.approx(NORMAL, abs=1e-5)


def test_one_line_says_nothing_of_the_tilt_and_takes_it_from_elsewhere():
    cloud = picture(BLOCK, fan=ONE)
    assert step_of(cloud, errors(ONE)) == NO_TILT
    found = step(cloud, KNOWN, ONE)
    assert found.thickness_mm == pytest.approx(20.0, abs=1e-4)
    assert found.by_tilt_mm > 0


def test_the_share_of_a_given_tilt_is_what_a_wrong_tilt_does():
    cloud, sd = picture(BLOCK, fan=ONE), np.radians(0.1)
    along = stretches(cloud)[0].along
    turned = NORMAL + sd * np.cross(along, NORMAL)
    wrong = step(cloud, KnownTilt(tuple((turned / np.linalg.norm(turned)).tolist()), sd), ONE)
    assert abs(wrong.thickness_mm - 20.0) == pytest.approx(step(cloud, KNOWN, ONE).by_tilt_mm, rel=0.05)


def test_a_light_plane_taken_to_be_square_on_the_faces_measures_within_itself():
    found = step(picture(BLOCK, fan=ONE), KnownTilt(None, np.radians(1.0)), ONE)
    slant = abs(float(ONE.planes[0].normal @ NORMAL))
    assert found.thickness_mm == pytest.approx(20.0 / np.sqrt(1 - slant**2), rel=1e-3)


def test_a_single_level_gives_no_step():
    assert step_of(picture(((-150.0, 150.0, 0.0),)), errors()) == NO_FACES


@pytest.mark.parametrize(("fan", "tilt"), [(RIG.fan, None), (ONE, KNOWN)])
def test_thicknesses_scatter_as_they_state(fan, tilt):
    found = [step(picture(BLOCK, fan=fan, noise_px=0.1, seed=seed), tilt, fan) for seed in range(20)]
    relative = [(one.thickness_mm - 20.0) / one.own_mm for one in found]
    assert 0.6 < np.sqrt(np.mean(np.square(relative))) < 1.4


def moved(count, *, still=False):
    """Steps of pictures of a part that is moved between them, or stands still: the same noise again."""
    parts = [tuple((a + 3 * i, b + 3 * i, h) for a, b, h in BLOCK) for i in range(count)]
    return [
        step(picture(BLOCK if still else part, noise_px=0.1, seed=0 if still else i, frame=i))
        for i, part in enumerate(parts)
    ]


def test_pictures_of_a_moved_part_make_the_mean_surer():
    steps = moved(4)
    result = measure_steps(steps, nominal_mm=20.0, tolerance_mm=0.5)
    assert result.u_mm < 0.7 * steps[0].own_mm
    assert abs(result.thickness_mm - 20.0) < result.U_mm
    assert result.verdict == "conforming"
    assert [note.code for note in result.notes] == ["profile.mean_of"]


def test_pictures_of_a_part_at_rest_are_no_surer_together_and_this_is_told():
    steps = moved(4, still=True)
    result = measure_steps(steps)
    assert result.u_mm > 0.95 * steps[0].own_mm
    assert "profile.stood_still" in [note.code for note in result.notes]


def test_pictures_that_disagree_widen_the_uncertainty():
    steps = moved(4)
    other = step(
        picture(((-150.0, -40.0, 0.0), (-20.0, 30.0, 20.3), (60.0, 150.0, 0.0)), noise_px=0.1, seed=9, frame=9)
    )
    result = measure_steps([*steps, other])
    assert "study.cause_observed" in [row.words.code for row in result.budget]
    assert result.U_mm > 3 * measure_steps(steps).U_mm


def test_a_step_too_small_to_be_told_from_noise_gives_none():
    flat = ((-150.0, -40.0, 0.0), (-20.0, 30.0, 0.05), (60.0, 150.0, 0.0))
    assert step_of(picture(flat, noise_px=0.1), errors()) == NO_FACES


def test_arcs_are_no_faces():
    x = np.arange(-25.0, 25.0, 2.0)
    ball = [(float(a), float(a) + 2.0, float(np.sqrt(30.0**2 - (a + 1) ** 2) - 10.0)) for a in x]
    cloud = picture([(-150.0, -40.0, 0.0), *ball, (60.0, 150.0, 0.0)], noise_px=0.05)
    assert isinstance(step_of(cloud, errors()), Message)


def test_lines_at_other_heights_on_the_part_tell_that_it_is_no_plane():
    heights = (18.0, 20.0, 18.0)
    clouds = [
        picture([(a, b, height if h else 0.0) for a, b, h in BLOCK], noise_px=0.02, seed=line)
        for line, height in enumerate(heights)
    ]
    lying = join([cloud.select(cloud.sweep == FAN - line) for line, cloud in enumerate(clouds)])
    assert step_of(lying, errors()) == NOT_PLANE


@pytest.mark.skipif(not REAL.exists(), reason="needs the real profile of a gauge block")
def test_a_real_profile_of_a_block_gives_the_published_height():
    upper, lower = (
        np.genfromtxt(REAL / f"frame_000974_{part}_points.csv", delimiter=",", names=True)
        for part in ("height", "baseline")
    )
    table = np.concatenate([upper, lower])
    points = np.column_stack([table[name] for name in ("Xc_mm", "Yc_mm", "Zc_mm")])
    # Its heights over the calibrated ground are affine in the place: their gradient is the ground's normal.
    gradient = np.linalg.lstsq(np.column_stack([points, np.ones(len(points))]), table["Zg_mm"], rcond=None)[0][:3]
    normal = -gradient / np.linalg.norm(gradient)
    count = len(table)
    cloud = Cloud(
        points, np.column_stack([table["u"], table["v"]]), np.full(count, 0.02), np.ones(count), np.zeros(count),
        np.full(count, FAN), np.zeros((count, 3)),
    )  # fmt: skip
    found = step_of(cloud, PointErrors(speckle_px=8.0), KnownTilt(tuple(normal.tolist()), np.radians(0.1)))
    assert isinstance(found, Step)
    assert found.thickness_mm == pytest.approx(19.876, abs=0.05)  # published; 19.835 to 20.070 by choice of baseline
    assert 0.01 < found.own_mm < 0.1


def test_light_that_is_bent_widens_the_uncertainty_of_a_step():
    form = np.zeros((RIG.fan.lines, 3, 3))
    form[:, 0, 0] = 1e-5  # light is this times x² off its plane: 0.1 mm at 100 mm aside
    bent = Deviation("bend", RIG.camera, replace(RIG.fan, bends=form))
    cloud = picture(BLOCK, noise_px=0.02)
    known, unknown = (
        step_of(cloud, PointErrors(common=CommonErrors.of_fan(RIG.camera, RIG.fan, of), speckle_px=CORRELATION_PX))
        for of in ((bent,), ())
    )
    assert isinstance(known, Step)
    assert isinstance(unknown, Step)
    of_bend = [one for one in known.effects if one.source == CALIBRATIONS["bend"]]
    assert len(of_bend) == 1
    assert np.linalg.norm(of_bend[0].factor) > 1e-3
    assert len(known.effects) == len(unknown.effects) + 1


def test_light_from_below_the_faces_is_in_all_pictures_alike():
    unstated = replace(errors(), part=Part())
    parts = [tuple((a + 3 * i, b + 3 * i, h) for a, b, h in BLOCK) for i in range(4)]
    steps = [step_of(picture(part, noise_px=0.1, seed=i, frame=i), unstated) for i, part in enumerate(parts)]

    def by_light(of):
        (row,) = (one for one in measure_steps(of).budget if one.source == Cause.LIGHT_FROM_BELOW_ASSUMED)
        return row.u_mm

    assert by_light(steps) == pytest.approx(by_light(steps[:1]), rel=0.1) and by_light(steps) > 0.1


def lifted(cloud: Cloud, up_mm: np.ndarray) -> Cloud:
    """A cloud with points (N,) moved towards the camera along their rays by so many mm."""
    return replace(cloud, points=cloud.points * (1 - up_mm / cloud.points[:, 2])[:, None])


def codes(steps: Sequence[Step]) -> list[str]:
    return [note.code for note in measure_steps(steps).notes]


@pytest.mark.parametrize(
    ("count", "seeds"), [(1, range(8)), (4, range(2)), pytest.param(4, range(2, 8), marks=pytest.mark.accuracy)]
)
def test_plane_faces_in_straight_light_are_not_accused(count, seeds):
    for seed in seeds:
        steps = [step(picture(BLOCK, noise_px=0.1, seed=10 * seed + i, frame=i)) for i in range(count)]
        assert codes(steps) == ["profile.mean_of"], seed


def test_light_that_is_bent_alike_in_all_pictures_is_told():
    def bent(seed: int) -> Cloud:
        cloud = picture(BLOCK, noise_px=0.1, seed=seed, frame=seed)
        return lifted(cloud, 0.25 * (cloud.points[:, 0] / 100) ** 2)

    notes = [
        one for one in measure_steps([step(bent(i)) for i in range(4)]).notes if one.code == "profile.not_straight"
    ]
    assert any("the lower face" in str(note) and "above their line" in str(note) for note in notes)


def test_a_bowed_face_is_told_apart_from_the_plane_one_under_it():
    def bowed(seed: int) -> Cloud:
        cloud = picture(BLOCK, noise_px=0.1, seed=seed, frame=seed)
        x = (cloud.points[:, 0] - 5) / 25
        return lifted(cloud, np.where(np.abs(x) <= 1, 0.5 * (1 - x**2), 0.0))

    of_mean, note = measure_steps([step(bowed(i)) for i in range(4)]).notes
    assert (of_mean.code, note.code) == ("profile.mean_of", "profile.not_straight")
    assert "the upper face" in str(note)
