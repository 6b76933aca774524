"""The report page in real processes: everything that is handed over can be read by others."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pypdf import PdfReader

from core.files.results.ply import read_cloud, read_mesh
from tests.workbench.technician import Technician
from tests.workbench.watchdog import LIMIT_MS, Watchdog


@pytest.fixture
def page(technician: Technician, measured_project: Path) -> Any:
    technician.window.projects.open_project(measured_project)
    technician.window.go_to("report")
    shown = technician.page()
    technician.until(lambda: shown.preview.count() > 0, "the pages", 60)
    return shown


def drawn(technician: Technician, page: Any) -> None:
    technician.until(lambda: not page.presenter.drawing, "the pages", 60)
    technician.idle()


def test_the_preview_follows_what_is_chosen_typed_and_undone(technician: Technician, page: Any) -> None:
    t = technician
    drawn(t, page)
    whole = page.presenter.pages
    with Watchdog() as watchdog:
        t.press(page.boxes["surface"])
        page.refreshing.at_once()
        assert page.preview.note == "Drawing the pages …"
        assert page.preview.count() == len(whole), "the old pages stay until the new ones are there"
        drawn(t, page)
    assert page.preview.note == ""
    assert watchdog.longest_ms < LIMIT_MS, watchdog.worst()
    short = page.presenter.pages
    assert len(short) <= len(whole)
    t.model.undo_stack.undo()
    drawn(t, page)
    assert all(np.array_equal(a, b) for a, b in zip(page.presenter.pages, whole, strict=True)), "the same again"

    t.window.go_to("project")
    t.type_in(t.field("Operator"), "Somebody else")
    t.window.go_to("report")
    drawn(t, page)
    assert not np.array_equal(page.presenter.pages[0], whole[0])


@pytest.mark.accuracy
def test_everything_is_handed_over_the_report_is_what_was_seen_and_what_cannot_be_written_is_one_sentence(
    technician: Technician, page: Any, tmp_path: Path
) -> None:
    t = technician
    drawn(t, page)
    t.window.go_to("project")
    t.type_in(t.field("Notes"), "A remark to be printed")
    t.window.go_to("report")
    drawn(t, page)
    assert page.card.title.text() == "Out of date"
    written = {}
    for button, name in (
        ("Report (PDF)", "a.pdf"),
        ("Points (PLY)", "b.ply"),
        ("Surface (STL)", "d.stl"),
        ("Points (CSV)", "e.csv"),
        ("Thickness (JSON)", "f.json"),
    ):
        t.will_choose(tmp_path / name)
        t.press(button)
        t.until((tmp_path / name).exists, name, 60)
        t.idle()
        written[button] = tmp_path / name
    t.will_choose(tmp_path / "c.ply")
    page.exports["mesh"].trigger()  # in the menu of further formats
    t.until((tmp_path / "c.ply").exists, "the surface", 60)
    t.idle()
    assert page.card.title.text() == "The report is made", "the PDF that is handed over is the one that is shown"
    pdf = PdfReader(written["Report (PDF)"])
    assert len(pdf.pages) == page.preview.count()
    assert "A remark to be printed" in "".join(one.extract_text() for one in pdf.pages)
    cloud, mesh = read_cloud(written["Points (PLY)"]).cloud, read_mesh(tmp_path / "c.ply")
    assert int(np.frombuffer(written["Surface (STL)"].read_bytes(), "<u4", 1, 80)[0]) == len(mesh.triangles)
    with written["Points (CSV)"].open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    assert len(rows) - 1 == len(cloud)
    assert json.loads(written["Thickness (JSON)"].read_text())["thickness_mm"] == pytest.approx(50.0, abs=0.5)
    assert t.errors() == []

    (tmp_path / "file").write_text("in the way")
    t.will_choose(tmp_path / "file" / "a.stl")
    t.press("Surface (STL)")
    t.until(lambda: t.errors(), "a message", 30)
    t.idle()
    (message,) = t.errors()
    assert "cannot be written" in message
    assert "--out" not in message
    assert page.exports["stl"].isEnabled()
