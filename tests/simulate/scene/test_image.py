import numpy as np
import pytest

from core.simulate.blur import blurred
from core.simulate.rig import Optics
from core.simulate.scene.image import Sensor, generator
from core.simulate.scene.speckle import Speckle

PLAIN = Optics()


def test_blur_keeps_the_light_and_its_place_and_has_the_stated_width():
    light = np.zeros((41, 41), np.float32)
    light[20, 20] = 100.0
    out = blurred(light, 1.3)
    assert out.sum() == pytest.approx(100.0, rel=1e-4)
    at = np.arange(41) - 20
    assert (out.sum(axis=0) * at).sum() == pytest.approx(0, abs=1e-3)
    # discrete moments of an integrated Gaussian: σ² + 1/12
    assert (out.sum(axis=0) * at**2).sum() / 100 == pytest.approx(1.3**2 + 1 / 12, rel=2e-3)


def test_no_lens_blur_leaves_the_light():
    light = np.random.default_rng(0).uniform(0, 100, (20, 20)).astype(np.float32)
    assert np.abs(blurred(light, 0.0) - light).max() < 1e-4


@pytest.mark.parametrize("level", [0.0, 20.0, 150.0])
def test_noise_is_shot_noise_and_read_noise(level):
    light = np.full((600, 600), level, np.float32)
    picture = Sensor(PLAIN, bits=16).expose(light, generator(1, "test")) / 257.0
    assert picture.mean() == pytest.approx(level + PLAIN.black_level_grey, abs=0.02)
    variance = level / PLAIN.electrons_per_grey + PLAIN.read_noise_grey**2
    assert picture.var() == pytest.approx(variance, rel=0.02)


def test_noise_factor_scales_the_noise_and_zero_leaves_rounding():
    light = np.full((300, 300), 100.3, np.float32)
    single = Sensor(PLAIN, 16, 1.0).expose(light, generator(1, "a")).std()
    assert Sensor(PLAIN, 16, 2.0).expose(light, generator(1, "a")).std() == pytest.approx(2 * single, rel=0.001)
    assert (Sensor(PLAIN, 8, 0.0).expose(light, generator(1, "a")) == 105).all()


@pytest.mark.parametrize(("bits", "kind", "white"), [(8, np.uint8, 255), (16, np.uint16, 65535)])
def test_bright_light_saturates(bits, kind, white):
    picture = Sensor(PLAIN, bits).expose(np.full((10, 10), 400.0, np.float32), generator(1, "b"))
    assert picture.dtype == kind
    assert (picture == white).all()


def test_pictures_have_random_numbers_of_their_own():
    first = generator(7, "frame", 3).standard_normal(5)
    assert (generator(7, "frame", 3).standard_normal(5) == first).all()
    for other in (generator(7, "frame", 4), generator(8, "frame", 3), generator(7, "camera", 3)):
        assert (other.standard_normal(5) != first).any()


def test_speckle_has_mean_one_and_the_stated_contrast_and_grain():
    speckle = Speckle(0.3, 2.0, generator(1, "speckle"))
    rows, columns = np.indices((1024, 1024)).reshape(2, -1)
    seen = speckle.at(rows, columns, generator(1, "place")).reshape(1024, 1024)
    assert seen.mean() == pytest.approx(1.0, abs=0.01)
    assert seen.std() == pytest.approx(0.3, abs=0.015)
    field = np.log(seen) - np.log(seen).mean()
    at_grain = (field * np.roll(field, 2, axis=1)).mean() / field.var()
    assert at_grain == pytest.approx(np.exp(-1), abs=0.02)


def test_views_of_the_speckle_differ_from_picture_to_picture():
    speckle = Speckle(0.3, 2.0, generator(1, "speckle"))
    rows, columns = np.indices((64, 64)).reshape(2, -1)
    first = speckle.at(rows, columns, generator(1, "frame", 0))
    other = speckle.at(rows, columns, generator(1, "frame", 1))
    assert (speckle.at(rows, columns, generator(1, "frame", 0)) == first).all()
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.2
