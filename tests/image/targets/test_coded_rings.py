"""Coded rings drawn exactly: found by their numbers, their discs' centres where they are."""

import numpy as np
import pytest

from core.image.targets.coded_rings import LEAST_APART, SECTORS, code_of, code_words, find_rings
from core.model import Camera, Pose
from core.simulate.blur import blurred
from core.simulate.rays import ray_map
from core.simulate.scene.patterns import Pattern, draw_pattern

CAMERA = Camera((480, 360), np.array([[1250.0, 0, 240], [0, 1250.0, 180], [0, 0, 1]]), np.zeros(4))
RADIUS = 4.0
NUMBERS = np.array([3, 17, 31, 60])
MIDDLES = np.array([[-35.0, -25], [38, -22], [-33, 27], [36, 24]])


def picture(pose, noise=0.6, seed=0):
    codes = np.array([code_of(int(number)) for number in NUMBERS])
    plate = Pattern(
        np.array([-60.0, 60]), np.array([-50.0, 50]), np.array([[0.8]]), 0.4, MIDDLES, RADIUS, 0.06, MIDDLES, codes
    )
    light = blurred(120 * draw_pattern(plate, pose, ray_map(CAMERA))[1], 0.9)
    return np.clip(np.rint(light + np.random.default_rng(seed).normal(0, noise, light.shape)), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.1])
def test_rings_are_found_by_their_numbers_however_they_are_turned(turn):
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    pose = Pose(rotation, np.array([0.3, -0.2, 520.0]))
    found = find_rings(picture(pose), range(61))
    assert [ring.number for ring in found] == NUMBERS.tolist()
    true = CAMERA.project_pose(pose, np.column_stack([MIDDLES, np.zeros(4)]))
    off = np.array([ring.ellipse.centre for ring in found]) - true
    assert np.sqrt(np.mean(off**2)) < 0.03


def test_numbers_that_are_not_asked_for_are_not_told():
    pose = Pose(np.eye(3), np.array([0.0, 0.0, 520.0]))
    assert [ring.number for ring in find_rings(picture(pose), {17})] == [17]


def test_codes_differ_however_they_are_turned():
    words = np.array(code_words())
    assert len(words) == 61
    for step in range(SECTORS):
        turned = ((words << step) | (words >> (SECTORS - step))) & ((1 << SECTORS) - 1)
        apart = np.bitwise_count(words[:, None] ^ turned[None])
        assert apart[~np.eye(len(words), dtype=bool)].min() >= LEAST_APART
