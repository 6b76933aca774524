"""What the widths of a scan's stripes tell of the hand's motion within its exposures."""

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.scan.features.exposure_blur import exposure_blurs, notes_on_blur
from core.scan.features.frames import FrameFeatures

SIZE, FRAMES, REST_PX = (960, 687), 60, 1.1


def stripe(at: float, slant: float, blur_px: float, uneven: float, rng: np.random.Generator) -> Centreline:
    """A stripe from the top to the bottom, at `at` in the middle row; its sections scatter by 4 %."""
    v = np.arange(10.0, SIZE[1] - 10)
    uv = np.column_stack([at + slant * (v - SIZE[1] / 2), v])
    uv = uv[(uv[:, 0] > 5) & (uv[:, 0] < SIZE[0] - 5)]
    one = np.ones(len(uv))
    width = np.hypot(REST_PX * (1 + uneven * uv[:, 0] / SIZE[0]), blur_px) * (1 + 0.04 * rng.normal(size=len(uv)))
    normal = np.tile(np.array([1.0, -slant]) / np.hypot(1, slant), (len(uv), 1))
    return Centreline(uv, normal, width, 100 * one, 0.05 * one, one > 2)


def swept(blur_px, uneven: float = 0.0) -> list[FrameFeatures]:
    """Frames of a stripe that goes over the picture and back, blurred by so many px each.

    At rest it is `uneven` times wider at the right edge than at the left.
    """
    rng = np.random.default_rng(1)
    frames = []
    for number, blur in enumerate(np.broadcast_to(blur_px, FRAMES)):
        at = 100 + 760 * abs((2 * number / FRAMES) % 2 - 1)
        line = stripe(at, 0.3 if number % 2 else -0.3, float(blur), uneven, rng)
        frames.append(FrameFeatures(number, f"{number:03d}.png", (line,)))
    return frames


def trembling() -> np.ndarray:
    """Blur of a hand that stands still now and then, in px."""
    return 1.5 * np.abs(np.sin(1.7 * np.arange(FRAMES)))


def test_the_blur_of_each_frame_is_found_by_its_width_against_the_others():
    blur = trembling()
    found, at_rest = exposure_blurs(swept(blur), SIZE).T
    known = np.isfinite(found)
    clear = known & (blur > 0.7)
    assert known.sum() > 0.9 * FRAMES and clear.sum() > 15
    assert np.median(np.abs(found - blur)[clear]) < 0.25
    assert np.all(found[clear] < blur[clear] + 0.2), "less where no frame that passed there was at rest"
    assert np.corrcoef(found[known], blur[known])[0, 1] > 0.9
    assert np.median(at_rest[known]) == pytest.approx(REST_PX, abs=0.25)


@pytest.mark.parametrize("uneven", [0.0, 0.8], ids=["even", "wider at one side"])
@pytest.mark.parametrize("steady_px", [0.0, 0.8], ids=["at rest", "steady"])
def test_a_hand_that_rests_or_goes_on_evenly_is_told_nothing(uneven, steady_px):
    """Nor is a stripe that is not in focus everywhere."""
    blurs = exposure_blurs(swept(steady_px, uneven), SIZE)
    assert np.isfinite(blurs).mean() > 0.9
    assert notes_on_blur(blurs) == ()


def test_many_blurred_frames_are_told_and_a_single_one_is_not():
    (note,) = notes_on_blur(exposure_blurs(swept(trembling()), SIZE))
    assert note.code == "scan.exposure_blur"
    assert 0.3 * FRAMES < note.values["n"] < 0.8 * FRAMES
    assert note.values["blur_px"] == pytest.approx(1.5, abs=0.3)
    alone = exposure_blurs(swept(np.where(np.arange(FRAMES) == 7, 1.5, 0.0)), SIZE)
    assert alone[7, 0] == pytest.approx(1.5, abs=0.2)
    assert notes_on_blur(alone) == ()


def test_frames_that_hardly_share_a_part_of_the_picture_tell_nothing():
    few = exposure_blurs(swept(0.0)[:3], SIZE)
    assert np.isnan(few).all() and notes_on_blur(few) == ()
    assert np.isnan(exposure_blurs([FrameFeatures(0, "a.png", ())], SIZE)).all()
