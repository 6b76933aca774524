"""The simulated rig recorded live, frame by frame: its calibrations are right for its scans."""

import pytest

from core.acquire.source import Lasers, SourceChoice, SourceSettings
from core.files.recorder import Recorder
from core.pipeline import run
from core.pipeline.sources import make_source
from core.simulate.calibration import rig_toml
from core.simulate.live_scene import CAMERA_MOVE_S, CAMERA_REST_S, CAMERA_RESTS, PLANE_MOVE_S, PLANE_REST_S, PLANE_RESTS
from core.simulate.sample import sample_scenario

DARK, FAN, BOTH = Lasers(fan=False, hand=False), Lasers(fan=True, hand=False), Lasers(fan=True, hand=True)
PER_SECOND = 12
SCAN_S = 12
EVERY = 2


def frames(source, seconds):
    return [source.read(30) for _ in range(round(seconds * PER_SECOND))]


def record(source, folder):
    """What a technician would do: a view and a pose in the middle of each rest, then a scan."""
    source.prepare("camera")
    source.lasers(DARK)
    views = Recorder(folder / "camera")
    start = source.read(30).time_s
    for view in range(CAMERA_RESTS):
        wanted = start + view * (CAMERA_REST_S + CAMERA_MOVE_S) + CAMERA_REST_S / 2
        while (frame := source.read(30)).time_s < wanted:
            pass
        views.write(f"view{view:02d}.png", frame.picture)
    views.close()
    source.prepare("planes")
    poses = Recorder(folder / "planes")
    source.lasers(FAN)
    start = source.read(30).time_s
    for pose in range(PLANE_RESTS):
        wanted = start + pose * (PLANE_REST_S + PLANE_MOVE_S) + PLANE_REST_S / 2
        while (frame := source.read(30)).time_s < wanted:
            pass
        poses.write(f"pose{pose:02d}.png", frame.picture)
        source.lasers(DARK)
        poses.write(f"pose{pose:02d}_off.png", source.read(30).picture)
        source.lasers(FAN)
    poses.close()
    source.prepare("scan")
    scan = Recorder(folder / "scan")
    scan.write("reference.png", source.read(30).picture)
    source.lasers(BOTH)
    for number, frame in enumerate(frames(source, SCAN_S)):
        if number % EVERY == 0:
            scan.write(f"frame{number:05d}.png", frame.picture)
    scan.close()
    assert scan.dropped == views.dropped == poses.dropped == 0


@pytest.mark.slow
def test_a_block_recorded_live_measures_what_it_is(tmp_path):
    source = make_source(SourceChoice("simulated"))
    source.configure(SourceSettings(rate_hz=0))
    source.open()
    try:
        record(source, tmp_path / "set")
    finally:
        source.close()
    (tmp_path / "set" / "rig.toml").write_text(rig_toml(sample_scenario()))
    result = run(tmp_path / "set", tmp_path / "out")
    assert result.gauge.thickness_mm == pytest.approx(source.truth.thickness_mm, abs=0.05)
    assert result.gauge.U_mm < 0.06
