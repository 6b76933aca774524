"""A project's report: what people say of the job, and the old one whole until the new one is."""

from dataclasses import replace

import pytest
from pypdf import PdfReader

from core.errors import Cancelled
from core.files.project.data import ProjectInfo, ReportChoices
from core.pipeline.project.report import make_report
from tests.simulated import contents, copy_of


def test_the_report_prints_what_the_project_says(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    info = ProjectInfo(
        "job", part="Endmass 7", serial="S-17", operator="Ada", customer="Babbage Ltd", laboratory="Room 12",
        air_celsius=20.5, notes="Seen through glass.",
    )  # fmt: skip
    hidden = frozenset({"inputs", "surface", "frame", "points", "maps", "no such section"})
    project = replace(done.project, info=info, report=ReportChoices(hidden))
    text = "\n".join(page.extract_text() for page in PdfReader(str(make_report(folder, project))).pages)
    for words in ("Endmass 7", "S-17", "Ada", "Babbage Ltd", "Room 12", "20.5", "Seen through glass."):
        assert words in text


def test_a_report_that_is_cancelled_leaves_the_old_one(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    before = contents(folder)

    def stop(step, done, total):
        if done == total - 1:
            raise Cancelled

    with pytest.raises(Cancelled):
        make_report(folder, done.project, stop)
    assert contents(folder) == before
