"""What is said where no thickness can be measured."""

from types import SimpleNamespace

import numpy as np
import pytest

from core.errors import InputError, OwnCause
from core.findings.proof import ScanFacts
from core.findings.table import note_of
from core.messages import Message
from core.pipeline.steps import gauge_step
from core.scan.features.picture_faults import faults_first
from core.scan.surface.cloud import FAN


def scan_of(*, unsure_share, saturated=0, faults=(), sweeps=36):
    """What is kept of a scan of which so many of 100 of the fan's points are saturated."""
    line = SimpleNamespace(saturated=np.arange(100) < saturated)
    features = SimpleNamespace(fan=[line], frames=[], notes=(), faults=faults)
    return SimpleNamespace(unsure_share=unsure_share, features=features, sweep_frames=np.arange(sweeps))


NO_FACES = Message("gauge.no_parallel_faces", "among {n} plane faces no two are parallel", n=1)


@pytest.mark.parametrize(
    ("facts", "code", "todo"),
    [
        (ScanFacts(moved=True), "gauge.moved_and_no_faces", "hold both still"),
        (ScanFacts(drifted=True), "gauge.drifted_and_no_faces", "warm up"),
        (ScanFacts(), "gauge.no_parallel_faces", "scan both"),
    ],
)
def test_faces_that_are_not_found_are_told_with_what_happened_to_the_scan(facts, code, todo):
    with pytest.raises(InputError) as refused, gauge_step.movement_first(SimpleNamespace(facts=facts)):
        raise InputError(NO_FACES, where="point cloud", todo=Message("x.y", "scan both faces"))
    assert refused.value.code == code
    assert "no two are parallel" in str(refused.value)
    assert todo in str(refused.value)


@pytest.mark.parametrize(("share", "said"), [(0.8, "80 % of the sweeps' points"), (0.2, "among 1 plane faces")])
def test_faces_that_are_not_found_are_told_with_the_points_that_are_too_unsure(share, said):
    with pytest.raises(InputError) as refused, gauge_step.unsure_first(scan_of(unsure_share=share)):
        raise InputError(NO_FACES, where="point cloud", todo=Message("x.y", "scan both faces"))
    assert said in str(refused.value)
    assert "no two are parallel" in str(refused.value)
    assert ("raise the scan's σ cut" in str(refused.value)) == (share > 0.5)


def test_few_frames_are_named_before_points_that_are_too_unsure():
    with pytest.raises(InputError) as refused, gauge_step.unsure_first(scan_of(unsure_share=0.8, sweeps=11)):
        raise InputError(NO_FACES, where="point cloud")
    for said in ("only 11 frames", "no two are parallel", "record 30 frames or more"):
        assert said in str(refused.value)
    assert "raise the scan's σ cut" not in str(refused.value)


@pytest.mark.parametrize(("off_mm", "bent"), [(0.05, True), (0.01, False), (None, False)])
def test_lines_that_are_no_planes_are_named_before_what_seems_to_have_moved(off_mm, bent):
    """By what the light is off its planes at 500 mm, beside points of σ up to 0.05 mm."""
    bends = None if off_mm is None else np.diag([0, 0, off_mm / 500**2])[None]
    points = np.tile([0.0, 0.0, 500.0], (4, 1))
    cloud = SimpleNamespace(points=points, sweep=np.array([FAN, FAN, FAN, 0]), sigma=np.array([0.01, 0.01, 0.01, 0.05]))
    moved = gauge_step.movement_first(SimpleNamespace(facts=ScanFacts(moved=True)))
    with pytest.raises(InputError) as refused, gauge_step.bent_first(cloud, bends), moved:
        raise InputError(NO_FACES, where="point cloud")
    assert refused.value.code == ("gauge.bent_and_no_faces" if bent else "gauge.moved_and_no_faces")
    assert "no two are parallel" in str(refused.value)


def test_overexposed_stripes_are_named_before_points_that_are_too_unsure():
    bright = scan_of(unsure_share=0.8, saturated=53)
    with pytest.raises(InputError) as refused, gauge_step.unsure_first(bright):
        raise InputError(NO_FACES, where="point cloud")
    for said in ("53 % of the fan's points", "no two are parallel", "1 stop less"):
        assert said in str(refused.value)
    assert "less sure than" not in str(refused.value)


@pytest.mark.parametrize("first", [gauge_step.unsure_first, lambda scan: faults_first(scan.features.faults)])
def test_faces_that_are_seen_to_lie_askew_are_told_as_they_are(first):
    doubtful = scan_of(unsure_share=0.8, saturated=53, faults=(note_of("scan.speckled", percent=12.0),))
    with pytest.raises(OwnCause, match=r"^point cloud: among 1 plane faces"), first(doubtful):
        raise OwnCause(NO_FACES, where="point cloud")
