"""Course of the hand that moves the single-line laser: its position and direction in each frame of a scan.

A scan is several passes over the object, there and back, alternately from both sides of the camera, the stripe tilted
now one way, now the other: it meets the fan's lines at 35° to 90°, and stripes of different passes meet everywhere on
the object. On top of that the hand wanders smoothly and trembles a little.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.model import LightPlane
from core.model.arrays import Array
from core.simulate.effects.setup import USUAL_SETUP, Setup
from core.simulate.rig import Rig
from core.simulate.scene.laser import Sheet
from core.simulate.scene.scene import Scene

# The hand's course. Chosen so that stripes meet the fan's lines at 35° to 90° and each other everywhere:
# tests/simulate/test_sweep.py holds it.
FRAMES_PER_PASS = 12
"""Frames of one pass over the object."""
LEAST_PASSES = 4
"""Passes of a short scan, if it has so many frames."""
TILTS_DEG = (18.0, -24.0, 42.0, -40.0, 4.0, 33.0, -10.0, -33.0)
"""Middle tilt of the stripe against the picture's vertical, pass by pass."""
LARGEST_TILT = 0.8
"""rad, 46°: of the stripe with all that the hand adds."""
BASELINE_MM, BASELINE_RANGE_MM = 240.0, 55.0
"""Distance of the laser from the optical axis, and how far the hand wanders from it."""
HEIGHT_MM, HEIGHT_RANGE_MM = 40.0, 35.0
"""z of the laser, and how far the hand wanders from it."""
RIM_MM = 20.0
"""How far beyond the object the hand goes before it turns back."""
EMPTY_HALF_WIDTH_MM = 40.0
"""Half the width that is swept where nothing stands on the table."""


@dataclass(frozen=True, slots=True)
class SweepRange:
    """Range of a scan: the stripe's aim runs over ± `half_width_mm` about `centre` (3,), given as a tuple."""

    centre: tuple[float, float, float]
    half_width_mm: float = 75.0


@dataclass(frozen=True, eq=False, slots=True)
class HandCourse:
    """Course of the hand: position and direction of the laser at N instants.

    Parameters
    ----------
    number
        (N,) which pass over the object, from 0.
    tilt
        (N,) of the stripe against the picture's vertical, in rad.
    side
        (N,) side of the camera the laser is held at, +1 (right) or −1.
    baseline, sway, nearness
        (N,) distance from the optical axis in mm, wandering off it (a number about 0), and z in mm.
    aims
        (N, 3) points the laser is pointed to, in mm.
    """

    number: NDArray[np.intp]
    tilt: Array
    side: Array
    baseline: Array
    sway: Array
    nearness: Array
    aims: Array

    def sheets(self, rig: Rig) -> list[Sheet]:
        """Compute the laser sheet at each instant of the hand's course, in the camera frame."""
        emitters = np.column_stack(
            [
                self.side * self.baseline * np.cos(self.tilt) + 5 * self.sway,
                self.side * self.baseline * np.sin(self.tilt) * 0.8 + 25 * self.sway,
                self.nearness,
            ]
        )
        stripes = np.column_stack([-np.sin(self.tilt), np.cos(self.tilt), np.zeros(len(self.tilt))])
        return [_sheet(rig, *row) for row in zip(emitters, self.aims, stripes, strict=True)]


def hand_course(reach: SweepRange, frames: int, rng: np.random.Generator, setup: Setup = USUAL_SETUP) -> HandCourse:
    """Make the course of the hand-held laser during a scan of `frames` frames: its place and aim at each."""
    number = _passes(frames)
    passes = int(number.max(initial=-1)) + 1
    begins = np.searchsorted(number, np.arange(passes))
    counts = np.diff(np.append(begins, frames))
    along = (np.arange(frames) - begins[number] + 0.5) / counts[number]  # 0 … 1 within the pass
    along = np.where(number % 2 == 0, along, 1 - along)
    wander = _wander(frames, 5, rng)
    side = np.where((number // 2 + number) % 2 == 0, 1.0, -1.0)
    middle = setup.stripes_turned * np.radians(np.array(TILTS_DEG)[number % len(TILTS_DEG)])
    tilt = np.clip(
        middle + np.radians(4.0) * wander[:, 0] + rng.normal(0, np.radians(0.5), frames), -LARGEST_TILT, LARGEST_TILT
    )
    baseline = setup.hand_aside * BASELINE_MM + BASELINE_RANGE_MM * np.tanh(wander[:, 1])
    nearness = HEIGHT_MM + HEIGHT_RANGE_MM * np.tanh(wander[:, 3])
    across = (2 * along - 1) * reach.half_width_mm + rng.normal(0, 0.8, frames)
    aims = np.array(reach.centre) + np.column_stack([across, 6 * wander[:, 4], np.zeros(frames)])
    return HandCourse(number, tilt, side, baseline, wander[:, 2], nearness, aims)


def hand_sweeps(
    rig: Rig, reach: SweepRange, frames: int, rng: np.random.Generator, setup: Setup = USUAL_SETUP
) -> list[Sheet]:
    """Make the laser sheets of a scan of `frames` frames, in the camera frame, in the order of time."""
    return hand_course(reach, frames, rng, setup).sheets(rig)


def headings_of(frames: int) -> Array:
    """List for each frame of a scan (N,) the way of the stripe: +1 to the right, −1 to the left."""
    return np.where(_passes(frames) % 2 == 0, 1.0, -1.0)


def _passes(frames: int) -> NDArray[np.intp]:
    """(N,) number of the pass over the object, from 0, that each frame is of."""
    passes = max(min(LEAST_PASSES, frames), round(frames / FRAMES_PER_PASS))
    return np.arange(frames) * passes // max(frames, 1)


def sweep_range(scene: Scene, centre: Array) -> SweepRange:
    """Choose how far the hand sweeps about `centre` (3,) in mm: over all that stands on the table, and a rim."""
    extents = [mesh.triangles.reshape(-1, 3)[:, 0] for mesh in scene.meshes]
    extents += [sphere.centre[0] + np.array([-sphere.radius, sphere.radius]) for sphere in scene.spheres]
    widest = max((float(np.abs(x - centre[0]).max()) for x in extents), default=EMPTY_HALF_WIDTH_MM)
    return SweepRange((float(centre[0]), float(centre[1]), float(centre[2])), widest + RIM_MM)


def _sheet(rig: Rig, emitter: Array, aim: Array, stripe: Array) -> Sheet:
    normal = np.cross(aim - emitter, stripe)
    normal /= np.linalg.norm(normal)
    return Sheet(LightPlane(normal / (normal @ emitter)), emitter, aim - emitter, rig.sweep_beam)


def _wander(frames: int, channels: int, rng: np.random.Generator) -> Array:
    """Smooth random curves (frames, channels) of unit variance: a few slow sines each."""
    time = np.arange(frames)[:, None, None] / 60.0
    rates = rng.uniform(0.5, 3.0, (1, 6, channels))
    phases = rng.uniform(0, 2 * np.pi, (1, 6, channels))
    curves: Array = np.sin(2 * np.pi * rates * time + phases).sum(axis=1) / np.sqrt(3)
    return curves
