"""Where pictures of a scan will come from: the way the last ones came."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication

from core.files.project.data import Sources, new_project
from workbench.pages.sources import recording_folder, scan_begins_live
from workbench.project_model import ProjectModel

LIVE, ELSEWHERE = "/parts/1/recordings/planes-20261126-111234", "/sets/block/planes"


@pytest.fixture
def model(qapp: QApplication, tmp_path: Path) -> Iterator[ProjectModel]:
    made = ProjectModel()
    made.create(tmp_path / "part 2", new_project("Part 2"))
    yield made
    made.close()


@pytest.mark.parametrize(
    ("sources", "live"),
    [
        (Sources(), True),
        (Sources(camera=LIVE, planes=LIVE), True),
        (Sources(camera=ELSEWHERE, planes=LIVE + "-2"), True),
        (Sources(camera=ELSEWHERE, planes=ELSEWHERE), False),
        (Sources(camera=ELSEWHERE), False),
        (Sources(planes="imported/planes"), False),
        (Sources(planes="recordings/packed/planes"), False),
        (Sources(scan="recordings/scan-20261126-111234"), False),
    ],
)
def test_a_scan_is_recorded_unless_it_or_its_calibrations_pictures_come_from_elsewhere(
    model: ProjectModel, sources: Sources, live: bool
) -> None:
    model.edit("choose", replace(model.project, sources=sources))
    assert scan_begins_live(model) == live


def test_what_is_recorded_is_known_again_by_its_folder(model: ProjectModel, tmp_path: Path) -> None:
    for _ in range(2):
        folder = recording_folder(tmp_path, "planes")
        folder.mkdir(parents=True)
        model.edit("choose", replace(model.project, sources=Sources(planes=folder.as_posix())))
        assert scan_begins_live(model)
