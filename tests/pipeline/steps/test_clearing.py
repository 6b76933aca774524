from pathlib import Path

import pytest

from core.files.recording.recording_set import open_set
from core.files.step_graph import FILES
from core.pipeline.steps.workspace import CLEARED, Workspace

RESTS_ON = {
    "report": set(FILES) - {"report"},
    "gauge": {"faces", "cloud", "scan", "mesh", "planes", "camera"},
    "inspection": {"inspected", "cloud", "scan", "planes", "camera"},
    "mesh": {"cloud", "scan", "planes", "camera"},
    "cloud": {"planes", "camera"},
    "scan": {"planes", "camera"},
    "profile": {"profiles", "planes", "camera"},
    "check": {"planes", "camera"},
    "planes": {"camera"},
}


@pytest.fixture
def work(simulated, tmp_path):
    workspace = Workspace.open(open_set(simulated), tmp_path)
    for name in FILES:
        workspace.path(name).touch()
    return workspace


def test_whenever_clearing_is_cut_off_no_result_stands_without_what_it_rests_on(work, monkeypatch):
    seen = []
    unlink = Path.unlink

    def watched(path, missing_ok=False):
        unlink(path, missing_ok=missing_ok)
        seen.append({name for name in FILES if work.path(name).exists()})

    monkeypatch.setattr(Path, "unlink", watched)
    work.clear()
    assert seen[-1] == set()
    for left in seen:
        for name in left & set(RESTS_ON):
            assert RESTS_ON[name] <= left, f"{name} without {RESTS_ON[name] - left}"


def test_every_result_is_cleared():
    assert sorted(CLEARED) == sorted(FILES)
