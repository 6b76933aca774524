"""What a camera's residuals say over the picture: a lens that the model does not have, and corners that fit badly."""

import numpy as np
import pytest

from core.calibrate.camera.calibration import calibrate_camera
from core.calibrate.camera.options import CameraOptions
from core.calibrate.camera.picture_residuals import bad_fit
from core.calibrate.results import CameraCalibration
from tests.calibrate.camera_views import TRUTH, changed, synthetic_views

CODES = ("camera.pattern_outwards", "camera.pattern_in_region", "camera.bad_fit")


def calibrated(
    seed: int, fifth_px: float = 0.0, noise_px: float = 0.03, count: int = 14, options: CameraOptions | None = None
) -> CameraCalibration:
    """From views by a lens with a ring that k1 and k2 do not have, of `fifth_px` at its height."""
    centre, far = TRUTH.matrix[:2, 2], np.linalg.norm(TRUTH.image_size) / 2
    views = []
    for view in synthetic_views(seed, count, noise_px):
        off = view.uv - centre
        share = np.linalg.norm(off, axis=1) / far
        ring = fifth_px * np.exp(-0.5 * ((share - 0.45) / 0.1) ** 2)
        views.append(changed(view, view.uv + ring[:, None] * off / np.linalg.norm(off, axis=1)[:, None]))
    return calibrate_camera(views, TRUTH.image_size, options)


def told(calibration: CameraCalibration) -> list:
    return [note for note in calibration.notes if note.code in CODES]


def test_a_ring_that_the_lens_model_lacks_is_told_with_direction_and_place():
    (note,) = told(calibrated(1, 0.25, options=CameraOptions(k3=False)))
    assert note.code == "camera.pattern_outwards"
    assert 0.02 < note.values["px"] < 0.3
    assert "outwards" in str(note) or "inwards" in str(note)
    at = note.values["depth_mm"]
    assert note.values["mm"] == pytest.approx(note.values["px"] * at / TRUTH.matrix[0, 0], rel=0.02)
    assert f"px ({note.values['mm']:.3f} mm at a distance of {at:.0f} mm)" in str(note)


@pytest.mark.accuracy
def test_k3_takes_most_of_such_a_ring_and_what_is_left_is_told():
    without, found = calibrated(1, 0.25, options=CameraOptions(k3=False)), calibrated(1, 0.25)
    assert found.notes[0].code == "camera.third_radial"
    (before,), (left,) = told(without), told(found)
    assert left.values["px"] < 0.6 * before.values["px"]
    assert found.rms_px < without.rms_px


def test_a_part_of_the_picture_that_is_off_is_told_in_mm_too():
    views = []
    for view in synthetic_views(1, 14, 0.03):
        wave = 0.2 * np.sin(3 * np.pi * view.uv[:, 0] / TRUTH.image_size[0])
        views.append(changed(view, view.uv + np.column_stack([np.zeros_like(wave), wave])))
    (note,) = told(calibrate_camera(views, TRUTH.image_size))
    assert note.code == "camera.pattern_in_region"
    assert f"px ({note.values['mm']:.3f} mm at a distance of" in str(note)


@pytest.mark.accuracy
def test_a_lens_of_the_model_is_not_accused():
    assert [seed for seed in range(4) if told(calibrated(seed, count=10))] == []


def test_corners_that_fit_to_most_of_a_pixel_are_a_bad_calibration():
    views = synthetic_views(2, 12, 0.03)
    rng = np.random.default_rng(2)
    shaken = [changed(view, view.uv + rng.normal(0, 0.7, view.uv.shape)) for view in views]
    calibration = calibrate_camera(shaken, TRUTH.image_size)
    (note,) = told(calibration)
    assert note.code == "camera.bad_fit"
    assert bad_fit(calibration) == note
    assert note.values["rms"] == pytest.approx(0.96, abs=0.1)
    assert note.values["times"] > 15
    sure, unsure = calibrate_camera(views, TRUTH.image_size).sd, calibration.sd
    assert min(unsure[name] / sure[name] for name in ("alpha", "beta", "u0", "v0")) > 10, "U is wider by as much"


@pytest.mark.accuracy
def test_the_standard_deviations_contain_what_the_lens_model_lacks():
    """With a ring of 0.25 px the focal length is as far off as its σ says; k1 and k2 have become the ring's."""
    errors = []
    for seed in range(16):
        found = calibrated(100 + seed, 0.25)
        errors.append((found.camera.matrix[0, 0] - TRUTH.matrix[0, 0]) / found.sd["alpha"])
    assert np.sqrt(np.mean(np.square(errors))) < 1.4
