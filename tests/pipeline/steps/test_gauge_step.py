"""What is said where no thickness can be measured."""

from types import SimpleNamespace

import pytest

from core.errors import InputError
from core.findings.proof import ScanFacts
from core.messages import Message
from core.pipeline.steps import gauge_step

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
    with pytest.raises(InputError) as refused, gauge_step.unsure_first(SimpleNamespace(unsure_share=share)):
        raise InputError(NO_FACES, where="point cloud", todo=Message("x.y", "scan both faces"))
    assert said in str(refused.value)
    assert "no two are parallel" in str(refused.value)
    assert ("raise the scan's σ cut" in str(refused.value)) == (share > 0.5)
