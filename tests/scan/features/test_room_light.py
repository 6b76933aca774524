"""Room light that changes within a scan is taken off, and stripes stay where they are."""

import numpy as np
import pytest

from core.scan.features.extraction import FrameReader, choose_sweep_stripe, extract_features
from core.scan.features.reference import read_reference
from core.simulate.effects.room import RoomEffects
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario

ROOM = Scenario(scale=0.25, frames=36, seed=3)


def frames_of(scenario):
    stage, sheets, _ = scan_of(scenario)
    return stage.reference(), [(f"frame{i:04d}", stage.frame(i, sheets[i])) for i in (3, 8, 14, 20, 25, 30)]


@pytest.mark.parametrize(
    "effects",
    [
        {"room": RoomEffects(flicker=0.2), "readout_ms": 71.0},
        pytest.param({"room": RoomEffects(lamp_frame=10, lamp_change=2.0)}, marks=pytest.mark.accuracy),
        pytest.param({"room": RoomEffects(lamp_frame=10, lamp_change=-0.8)}, marks=pytest.mark.accuracy),
        pytest.param({"room": RoomEffects(shadow=0.8)}, marks=pytest.mark.accuracy),
    ],
)
def test_stripes_are_found_where_they_are_in_light_that_stays(effects):
    reference, frames = frames_of(ROOM)
    still = extract_features(reference, frames, len(frames))
    changed = extract_features(*(made := frames_of(Scenario(scale=0.25, frames=36, seed=3, **effects))), len(made[1]))
    assert [frame.reason for frame in changed.frames] == [None] * len(frames)
    assert any(note.code == "scan.room_light_changed" for note in changed.faults)
    for one, other in zip(still.frames, changed.frames, strict=True):
        points, there = (np.concatenate([piece.uv for piece in frame.centrelines]) for frame in (one, other))
        normals = np.concatenate([piece.normal for piece in one.centrelines])
        sigmas = np.concatenate([piece.sigma for piece in one.centrelines])
        assert len(there) > 0.9 * len(points)
        away = np.linalg.norm(points[:, None] - there[None], axis=2)
        nearest = away.argmin(axis=1)
        close = away.min(axis=1) < 1
        assert close.mean() > 0.9
        off = ((there[nearest] - points) * normals).sum(axis=1)[close]
        assert abs(np.mean(off)) < 0.02
        assert np.sqrt(np.mean(off**2)) < 2 * np.sqrt(np.mean(sigmas**2)) + 0.05


def test_light_that_stays_is_not_touched():
    reference, frames = frames_of(ROOM)
    seen = read_reference(reference)
    for _, picture in frames:
        difference, change, _ = seen.of_lasers(picture)
        assert change == 0
        assert difference.dtype == np.int16


def test_a_stripe_along_the_rows_is_no_room_light():
    """It fills whole cells of the grid: were it taken for a change of the room, it would be gone."""
    reference, frames = frames_of(Scenario(scale=0.25, frames=36, seed=3))
    v = np.arange(reference.shape[0], dtype=np.float32)[:, None]
    seen = read_reference(reference)
    for tilt in (0.0, 0.1):
        u = np.arange(reference.shape[1], dtype=np.float32)[None, :]
        stripe = 80 * np.exp(-0.5 * ((v - 500 - tilt * u) / 1.6) ** 2)
        lit = np.clip(reference.astype(np.float32) * 1.5 + stripe, 0, 255).astype(np.uint8)
        difference, change, _ = seen.of_lasers(lit)
        assert change > 10
        on_crest = [
            difference[round(500 + tilt * c), c] for c in range(50, reference.shape[1] - 50, 7) if 505 + tilt * c < 680
        ]
        assert np.median(on_crest) > 70
    assert choose_sweep_stripe(frames, seen) is not None
    assert FrameReader(seen, None)((0, frames[0])).light_change == 0
