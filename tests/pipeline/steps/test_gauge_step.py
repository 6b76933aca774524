"""What is said where no thickness can be measured."""

from types import SimpleNamespace

import numpy as np
import pytest

from core.errors import InputError, OwnCause
from core.findings.proof import ScanFacts
from core.findings.table import note_of
from core.inspect.faces import OneFace
from core.messages import Message
from core.pipeline.steps import gauge_step
from core.scan.first_cause import Cause, Suspect, cause_first
from core.scan.surface.cloud import FAN


class Line(SimpleNamespace):
    """A piece of the fan's light."""

    def __len__(self):
        return len(self.saturated)


def scan_of(*, unsure_share=0.0, saturated=0, faults=(), sweeps=36, facts=None, causes=()):
    """What is kept of a scan of which so many of 100 of the fan's points are saturated."""
    line = Line(saturated=np.arange(100) < saturated)
    features = SimpleNamespace(fan=[line], frames=[], notes=(), faults=faults)
    facts = ScanFacts() if facts is None else facts
    return SimpleNamespace(
        unsure_share=unsure_share, features=features, sweep_frames=np.arange(sweeps), facts=facts, causes=causes
    )


def cloud_with(sigma=(0.01, 0.01, 0.01, 0.05)):
    """Four points at 500 mm, three of them the fan's own."""
    points = np.tile([0.0, 0.0, 500.0], (4, 1))
    return SimpleNamespace(points=points, sweep=np.array([FAN, FAN, FAN, 0]), sigma=np.array(sigma))


def told_first(scan, error, *, bends=None):
    """The complaint as the step tells it."""
    with (
        pytest.raises(InputError) as refused,
        cause_first(lambda: gauge_step.reasons_of_no_faces(scan, cloud_with(), bends), lambda: scan.causes),
    ):
        raise error
    return refused.value


def no_faces(kind=InputError):
    return kind(NO_FACES, where="point cloud", todo=Message("x.y", "scan both faces"))


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
    refused = told_first(scan_of(facts=facts), no_faces())
    assert refused.code == code
    assert "no two are parallel" in str(refused)
    assert todo in str(refused)


@pytest.mark.parametrize(("share", "said"), [(0.8, "80 % of the sweeps' points"), (0.2, "among 1 plane faces")])
def test_faces_that_are_not_found_are_told_with_the_points_that_are_too_unsure(share, said):
    refused = str(told_first(scan_of(unsure_share=share), no_faces()))
    assert said in refused
    assert "no two are parallel" in refused
    assert ("raise the scan's σ cut: --sigma-cut MM" in refused) == (share > 0.5)


def test_few_frames_are_named_before_points_that_are_too_unsure():
    refused = str(told_first(scan_of(unsure_share=0.8, sweeps=11), no_faces()))
    for said in ("only 11 frames", "no two are parallel", "record 30 frames or more"):
        assert said in refused
    assert "raise the scan's σ cut" not in refused


@pytest.mark.parametrize(("off_mm", "bent"), [(0.05, True), (0.01, False), (None, False)])
def test_lines_that_are_no_planes_are_named_before_what_seems_to_have_moved(off_mm, bent):
    """By what the light is off its planes at 500 mm, beside points of σ up to 0.05 mm."""
    bends = None if off_mm is None else np.diag([0, 0, off_mm / 500**2])[None]
    refused = told_first(scan_of(facts=ScanFacts(moved=True)), no_faces(), bends=bends)
    assert refused.code == ("gauge.bent_and_no_faces" if bent else "gauge.moved_and_no_faces")
    assert "no two are parallel" in str(refused)


def test_what_moved_is_named_before_lines_that_bend_where_it_explains_most():
    most = [Cause(Suspect.MOVED, 0.8, 12, 1e-9), Cause(Suspect.BENT_LINES, 0.1, 1, 1e-4)]
    bends, scan = np.diag([0, 0, 0.05 / 500**2])[None], scan_of(facts=ScanFacts(moved=True), causes=most)
    refused = told_first(scan, no_faces(), bends=bends)
    assert refused.code == "gauge.moved_and_no_faces"
    assert "(what is named first explains 80 % of what is too large)" in str(refused)


def test_of_two_causes_that_were_compared_the_one_that_explains_more_is_named_though_it_is_not_most():
    shares = [Cause(Suspect.MOVED, 0.4, 12, 1e-9), Cause(Suspect.BENT_LINES, 0.2, 1, 1e-4)]
    bends, scan = np.diag([0, 0, 0.05 / 500**2])[None], scan_of(facts=ScanFacts(moved=True), causes=shares)
    refused = told_first(scan, no_faces(), bends=bends)
    assert refused.code == "gauge.moved_and_no_faces"
    assert "(what is named first explains 40 % of what is too large)" in str(refused)


@pytest.mark.parametrize("kind", [InputError, OwnCause])
@pytest.mark.parametrize(
    ("facts", "share", "changed"),
    [
        (ScanFacts(rig_changed=True), None, True),  # by pictures of the day
        (ScanFacts(fan_disagrees=True), 0.99, True),
        (ScanFacts(), 0.3, False),
        (ScanFacts(), None, False),
    ],
)
def test_a_rig_that_changed_is_named_before_faces_that_lie_askew_by_it(kind, facts, share, changed):
    causes = () if share is None else (Cause(Suspect.RIG_CHANGED, share, 6, 1e-9),)
    refused = told_first(scan_of(unsure_share=0.3, facts=facts, causes=causes), no_faces(kind))
    assert refused.code == ("gauge.changed_and_no_faces" if changed else "gauge.no_parallel_faces")
    assert "no two are parallel" in str(refused)
    assert ("calibrate it again" in str(refused)) == changed
    assert ("explains 99 %" in str(refused)) == (changed and share is not None)


def test_only_the_likeliest_cause_is_told_of_faces_that_are_not_found():
    scan = scan_of(unsure_share=0.8, saturated=53, facts=ScanFacts(moved=True))
    refused = told_first(scan, no_faces())
    assert refused.code == "gauge.moved_and_no_faces"
    assert "saturated" not in str(refused)


def test_overexposed_stripes_are_named_before_points_that_are_too_unsure():
    refused = str(told_first(scan_of(unsure_share=0.8, saturated=53), no_faces()))
    for said in ("53 % of the fan's points", "no two are parallel", "1 stop less"):
        assert said in refused
    assert "less sure than" not in refused


@pytest.mark.parametrize("holding", [{"unsure_share": 0.8, "saturated": 53}, {"faults": True}])
def test_faces_that_are_seen_to_lie_askew_are_told_as_they_are(holding):
    if "faults" in holding:
        holding = {"faults": (note_of("scan.speckled", percent=12.0),)}
    refused = told_first(scan_of(**holding), no_faces(OwnCause))
    assert isinstance(refused, OwnCause)
    assert str(refused).startswith("point cloud: among 1 plane faces")


def test_lines_that_bend_are_named_before_unsure_points_though_they_explain_little():
    bends = np.diag([0, 0, 0.05 / 500**2])[None]
    little = [Cause(Suspect.BENT_LINES, 0.2, 1, 1e-4)]
    refused = told_first(scan_of(unsure_share=0.8, causes=little), no_faces(), bends=bends)
    assert refused.code == "gauge.bent_and_no_faces" and "explains 20 % of what is too large" in str(refused)
    facts_alone = told_first(scan_of(unsure_share=0.8), no_faces(), bends=bends)
    assert facts_alone.code == "gauge.bent_and_no_faces" and "explains" not in str(facts_alone)


@pytest.mark.parametrize(("kept", "code"), [(10, "scan.pictures_at_fault"), (90, "gauge.too_few_faces")])
def test_faults_of_pictures_are_named_before_a_face_that_is_only_missing(kept, code):
    """Where the σ cut left most of the fan's own points out, those left do not show that nothing else is in view."""
    scan = scan_of(faults=(note_of("scan.compressed", grey=2.8, noise=0.4),))
    missing = Message("gauge.too_few_faces", "only 1 plane face is in view")
    with (
        pytest.raises(InputError) as refused,
        cause_first(lambda: gauge_step.reasons_of_no_faces(scan, cloud_with(), None)),
        gauge_step.single_face_as_cause(scan, SimpleNamespace(sweep=np.array([0] * 50 + [FAN] * kept))),
    ):
        raise OneFace(missing, where="point cloud", todo=Message("x.y", "let the fan cross both faces"))
    assert refused.value.code == code and "only 1 plane face is in view" in str(refused.value)
