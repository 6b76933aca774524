"""The simulated rig recorded as a technician would: its calibrations are right for its scans.

The pictures are asked for at the moments that count. How the live source comes to them, frame by frame and order by
order, is proved in tests/simulate/live/test_source.py.
"""

from itertools import count

import pytest

from core.acquire.source import Lasers
from core.files.recording.recorder import Recorder
from core.pipeline.run import run
from core.simulate.calibration import rig_toml
from core.simulate.live.scene import (
    CAMERA_MOVE_S,
    CAMERA_REST_S,
    CAMERA_RESTS,
    PLANE_MOVE_S,
    PLANE_REST_S,
    PLANE_RESTS,
    LiveScene,
    Moment,
)
from core.simulate.sample import sample_scenario

DARK, FAN, BOTH = Lasers(fan=False, hand=False), Lasers(fan=True, hand=False), Lasers(fan=True, hand=True)
FRAME_S = 1 / 12
SCAN_S = 12
EVERY = 4


def record(scene, folder):
    """A view and a pose, with the fan on and off, in the middle of each rest, then a scan."""
    numbers = count()

    def take(step, lasers, time_s, sweep_s=0.0):
        return scene.picture(Moment(step, lasers, time_s, sweep_s, next(numbers)))

    views = Recorder(folder / "camera")
    for view in range(CAMERA_RESTS):
        at = view * (CAMERA_REST_S + CAMERA_MOVE_S) + CAMERA_REST_S / 2
        views.write(f"view{view:02d}.png", take("camera", DARK, at))
    views.close()
    poses = Recorder(folder / "planes")
    for pose in range(PLANE_RESTS):
        at = pose * (PLANE_REST_S + PLANE_MOVE_S) + PLANE_REST_S / 2
        poses.write(f"pose{pose:02d}.png", take("planes", FAN, at))
        poses.write(f"pose{pose:02d}_off.png", take("planes", DARK, at + FRAME_S))
    poses.close()
    scan = Recorder(folder / "scan")
    scan.write("reference.png", take("scan", FAN, 0.0))
    for number in range(0, round(SCAN_S / FRAME_S), EVERY):
        scan.write(f"frame{number:05d}.png", take("scan", BOTH, number * FRAME_S, number * FRAME_S))
    scan.close()
    assert scan.dropped == views.dropped == poses.dropped == 0


@pytest.mark.accuracy
def test_a_block_recorded_live_measures_what_it_is(tmp_path):
    scene = LiveScene(sample_scenario())
    record(scene, tmp_path / "set")
    (tmp_path / "set" / "rig.toml").write_text(rig_toml(sample_scenario()))
    result = run(tmp_path / "set", tmp_path / "out")
    assert result.gauge.thickness_mm == pytest.approx(scene.truth.thickness_mm, abs=0.03)
    assert result.gauge.U_mm < 0.03
