"""The next part of a series has all that was decided for it, and nothing that was measured on the part before."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from core.errors import Cancelled, InputError
from core.files.project.data import Accepted, Done, KeptStudy, ProjectFile, Repeat, Sources, new_project
from core.files.project.folder import create_project, read_project
from core.files.project.keys import finished, left_to_do, up_to_date
from core.files.project.next_part import drawn_in_picture, next_part
from core.files.project.witness import TRAIL
from core.inspect.conformity import Limits
from core.inspect.plan.feature_spec import Deviation, FaceAt, FeatureSpec, Polygon, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.part import Part
from core.messages import plain
from core.settings.options import Options
from tests.simulated import trisect

HEIGHT = FeatureSpec("block", "thickness", limits=(("thickness", Limits(50.0, -0.1, 0.1)),))
SURFACE = FeatureSpec("surface", "deviation", deviation=Deviation("nominal/block.stl", tolerance_mm=0.1))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Part 1 of a series, everything measured, its pictures within the project."""
    folder = tmp_path / "Block 1"
    for name in ("recordings/camera/a.png", "recordings/planes/a.png", "recordings/scan-1/a.png", "nominal/block.stl"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(name.encode())
    (folder / "calibrations").mkdir()
    (folder / "calibrations" / "camera-c1.json").write_text("{}")
    (folder / "results").mkdir()
    (folder / "results" / "gauge.json").write_text("{}")
    made = new_project("Block 1")
    made = replace(
        made,
        info=replace(
            made.info, part="Block", serial="1", operator="Ada", laboratory="Lab", part_celsius=23.0, notes="!"
        ),
        sources=Sources("recordings/camera", "recordings/planes", "recordings/scan-1"),
        accepted=Accepted("c1", "f1"),
        options=Options(excluded=frozenset({"camera/a", "scan/a"})),
        inspection=InspectionPlan((HEIGHT, SURFACE)),
        repeats=(Repeat("scan-1", 50.0, 0.1, 2.0, "f1", datetime(2026, 1, 1, tzinfo=UTC)),),
        studies=(KeptStudy("a1", "repeats", plain("Repeats")),),
    )
    results: dict[str, Done] = {}
    for step in ("camera", "planes", "scan", "gauge", "inspection", "report"):
        results[step] = finished(step, made, results)
    create_project(folder, ProjectFile(made, results))
    return folder


def test_calibrations_plan_and_report_hold_and_nothing_of_the_last_part_does(project: Path, tmp_path: Path) -> None:
    before = read_project(project)
    to = next_part(project, tmp_path / "series" / "Block 2", " 2 ", "Bo")
    file = read_project(to)
    after = file.project
    assert (after.info.name, after.info.part, after.info.serial, after.info.operator) == ("Block 2", "Block", "2", "Bo")
    assert after.info.laboratory == "Lab" and after.info.part_celsius is None and after.info.notes == ""
    assert (after.accepted, after.inspection, after.rig) == (
        before.project.accepted, before.project.inspection, before.project.rig,
    )  # fmt: skip
    assert after.options.excluded == {"camera/a"} and after.repeats == () and after.studies == ()
    assert set(file.results) == {"camera", "planes"}
    assert all(up_to_date(step, after, file.results) for step in file.results), "calibrated anew for each part"
    assert after.sources.scan == "" and Path(after.sources.camera) == project / "recordings" / "camera"
    assert left_to_do(after, file.results) == ("scan", "inspection", "report")
    names = {path.relative_to(to).as_posix() for path in to.rglob("*") if path.is_file()} - {TRAIL}
    assert names == {"project.json", "Block 2.trisect", "calibrations/camera-c1.json", "nominal/block.stl"}
    assert read_project(project) == before


def test_the_temperature_of_the_last_part_is_not_taken_for_that_of_the_next(project: Path, tmp_path: Path) -> None:
    file = read_project(project)
    part = Part(material="steel", celsius=23.0, u_celsius=0.1)
    create_project(project, replace(file, project=replace(file.project, rig=replace(file.project.rig, part=part))))
    after = read_project(next_part(project, tmp_path / "Block 2", "2", "Ada")).project.rig.part
    assert after == Part(material="steel")


def test_a_simulated_part_does_not_make_the_next_one_simulated(project: Path, tmp_path: Path) -> None:
    file = read_project(project)
    create_project(project, replace(file, project=replace(file.project, rig=replace(file.project.rig, simulated=True))))
    assert read_project(next_part(project, tmp_path / "Block 2", "2", "Ada")).project.rig.simulated is None


@pytest.mark.parametrize(("serial", "operator"), [("", "Ada"), ("2", "  ")])
def test_a_part_without_a_number_or_an_operator_is_not_begun(
    project: Path, tmp_path: Path, serial: str, operator: str
) -> None:
    with pytest.raises(InputError, match="must be given"):
        next_part(project, tmp_path / "Block 2", serial, operator)
    assert not (tmp_path / "Block 2").exists()


def test_a_place_that_is_taken_is_refused_and_what_is_stopped_is_not_there(project: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there already"):
        next_part(project, project, "2", "Ada")

    def stop(step: str, done: int, total: int) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        next_part(project, tmp_path / "Block 2", "2", "Ada", progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == ["Block 1"]


@pytest.mark.parametrize(
    ("feature", "drawn"),
    [
        (HEIGHT, False),
        (replace(HEIGHT, regions=(FaceAt(at_mm=(0.0, 0.0, 1.0)),)), False),
        (replace(HEIGHT, regions=(FaceAt(at_px=(1.0, 2.0)),)), True),
        (replace(HEIGHT, regions=(Polygon(((0.0, 0.0), (9.0, 0.0), (9.0, 9.0))),)), True),
        (FeatureSpec("cut", "section", section=Section(((1.0, 2.0), (3.0, 4.0)))), True),
    ],
)
def test_what_is_drawn_in_the_picture_is_known(feature: Any, drawn: bool) -> None:
    assert drawn_in_picture(replace(new_project(""), inspection=InspectionPlan((feature,)))) == drawn


def test_the_command_makes_it(project: Path, tmp_path: Path) -> None:
    to = tmp_path / "Block 2"
    said = trisect("next-part", project, "--serial", "2", "--operator", "Bo", "--out", to)
    assert said.code == 0 and str(to) in said.out
    assert read_project(to).project.info.serial == "2"
