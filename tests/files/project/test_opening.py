import dataclasses
import json
import math
from dataclasses import fields, replace
from datetime import UTC, date, datetime, timedelta, timezone

import numpy as np
import pytest

from core.calibrate.board_shape import BoardTolerance
from core.calibrate.camera.options import CameraOptions
from core.calibrate.change import Stability
from core.calibrate.drift import Air, Drift
from core.checks.artefact_check import Artefact
from core.errors import InputError
from core.files.project import json_form as project_json
from core.files.project.data import (
    Accepted,
    Done,
    KeptStudy,
    Project,
    ProjectFile,
    ProjectInfo,
    Repeat,
    ReportChoices,
    Sources,
    new_project,
)
from core.files.project.folder import create_project, read_project
from core.files.project.json_form import SCHEMA, project_text
from core.files.recording.rig import (
    Channels,
    GaugeSpec,
    KnownPlaneTarget,
    ReferenceTarget,
    Rig,
    Validity,
    default_rig,
    read_rig,
    rig_to_toml,
)
from core.image.stripes.stripe import StripeSettings
from core.image.targets import BlackSquare, Charuco, CircleGrid, Rectangle
from core.inspect.conformity import Limits
from core.inspect.plan.conditions import Master, Temperature
from core.inspect.plan.feature_spec import FeatureSpec, Filters, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan, PartFrame
from core.inspect.uncertainty.part import Part, TargetTemperature
from core.messages import Message, plain
from core.model.certificate import Certificate
from core.settings.options import Options

AT = datetime(2026, 1, 31, 12, 30, 15, 250_000, timezone(timedelta(hours=2)))
POLYGON = np.array([[0, 0], [10.5, 0], [10, 1 / 3]])
REPEAT = Repeat("recordings/scan-20260131-120000", 49.987, 0.024, 2.0, "abc-def", AT)


def full_project():
    """A project in which no field is as in a new one."""
    return Project(
        ProjectInfo("Block 50", "gauge", "S/N 7", "Ö. Ärzt", "ACME", "Lab 3", 20.5, 21, 'quotes " and\nlines — σ'),
        Rig(Charuco(9, 7, 20, 15), CircleGrid(7, 6, 37.5), 2, math.radians(4.0), GaugeSpec(50, 0.2, POLYGON, POLYGON),
            "green", BoardTolerance(0.1, 2e-4), BoardTolerance(0.05, 3e-4),
            plane_margin_mm=12.0, stability=Stability(5e-5, 0.01, 0.1, 5e-5),
            drift=Drift(Stability(3e-5, 0.003, 0.04, 2e-5), Stability(1e-6, 1e-3, 0.01, 1e-6)), air=Air(20.5, 21, 23.5),
            row_time_us=26.0,
            channels=Channels("red", "blue", "red"), validity=Validity(30.0, 1.0, 2.0), name="bench-2", readjust=True,
            mosaic="RGGB", reference=ReferenceTarget(BlackSquare(36.0), BoardTolerance(0.01, 1e-5)),
            part=Part("wax", 0.12, 0.01, 0.02, 0.004, 9e-5, 2e-5, 21.5, 0.5,
                      TargetTemperature(23.0, 0.5, 24e-6, 1e-6)),
            certificates={"plane_target": Certificate("D-K 7", "Labor Nord", date(2028, 3, 1))},
            simulated=True,
            known_planes={"wall": KnownPlaneTarget(Rectangle(250.0, 150.0, 10.0), BoardTolerance(0.3, 1e-3), 5.0)}),
        Sources("/data/set/camera", "recordings/planes-1", "C:/pictures/scan", "recordings/check-1"),
        Options("three-crossings", 0.3, CameraOptions(False, frozenset({"p1", "k2"}), True, "all"), "my part",
                StripeSettings(8.5, 120), frozenset({"camera/b.png", "planes/pose02", "scan/ä ö.png"}), False, True,
                StripeSettings(12.5, 90), True),
        Accepted("0123456789ab", "ba9876543210"),
        frozenset({"deadbeef0123", "0123456789cd"}),
        (REPEAT, replace(REPEAT, thickness_mm=50.001)),
        ReportChoices(frozenset({"plots", "frames"}), "Letter", "de", "house/template.toml"),
        full_plan(),
        (KeptStudy("c0ffee012345", "grr", Message("study.title_grr", "{parts} parts", parts=3), False),),
        (Artefact("GB 50-7", 50.0003, 0.0004, 2.5, "D-K-15070", date(2028, 3, 1), "sphere", "Lab 4"),),
        {"ball Ø": (40.0, -70.5)},
        plate_beside=True,
    )  # fmt: skip


def full_plan():
    """A plan of an inspection in which nothing is as usual."""
    ball = FeatureSpec(
        "ball Ø",
        "sphere",
        (Polygon(((1.5, 2.0), (30.0, 2.0), (15.0, 20.0))),),
        filters=Filters(0.04, 2.0, 3.5, 1.0),
        limits=(("diameter", Limits(50.0, -0.05, 0.1)),),
    )
    hot = Temperature(22.5, 0.3, 11.5e-6, 1e-6, 21.0, 0.2, 9e-6, 5e-7)
    master = Master("ring", 49.999, 0.0002, 50.004, ((plain("noise"), 0.003),), ("ball Ø",), False)
    return InspectionPlan((ball,), PartFrame("ball Ø", "table", "side"), hot, master, 3.0)


def full_file():
    results = {
        "scan": Done("c0ffee", {"laser planes": "2", "camera calibration": "1"}, AT),
        "camera": Done("beef", {}, AT.astimezone(UTC)),
    }
    return ProjectFile(full_project(), results, created=AT - timedelta(days=1), saved=AT)


def written(folder, file):
    create_project(folder, file)
    return read_project(folder)


def test_a_project_reads_back_as_it_was_written(tmp_path):
    for file in (full_file(), ProjectFile(new_project("empty"))):
        back = written(tmp_path / file.project.info.name, file)
        assert back == file
        assert hash(back.project) == hash(file.project)
        assert back.project.rig == file.project.rig


def leaves(value, path=()):
    """Every field of nested dataclasses, as a path of names."""
    for field in fields(value):
        inner = getattr(value, field.name)
        if dataclasses.is_dataclass(inner) and field.name not in ("camera_target", "plane_target"):
            yield from leaves(inner, (*path, field.name))
        else:
            yield (*path, field.name)


def swapped(to, source, path):
    """`to` with one field taken from `source`."""
    name, *rest = path
    inner = getattr(source, name)
    return replace(to, **{name: swapped(getattr(to, name), inner, rest) if rest else inner})


WHOLE = {
    ("rig", "gauge"),
    ("rig", "unstated"),
    ("rig", "stability"),
    ("rig", "row_time_us"),
    ("rig", "reference"),
    ("rig", "part"),
    ("options", "stripe"),
    ("options", "plane_stripe"),
    ("options", "channel"),
} | {("inspection", of) for of in ("frame", "temperature", "master")}
"""What a new project has none of; a project states all of its rig, the channels of colour pictures among it."""
ONE_BY_ONE = [path for path in leaves(full_project()) if path[:2] not in WHOLE]


@pytest.mark.parametrize("path", ONE_BY_ONE, ids=".".join)
def test_no_field_is_lost_on_disk_or_in_a_comparison(tmp_path, path):
    plain = new_project("")
    changed = swapped(plain, full_project(), path)
    assert changed != plain
    assert written(tmp_path, ProjectFile(changed)).project == changed


def test_the_full_project_differs_from_a_new_one_in_every_field():
    full, plain = full_project(), new_project("")
    for path in ONE_BY_ONE:
        assert swapped(plain, full, path) != plain, path


def test_equal_projects_give_the_same_bytes(tmp_path):
    one, other = full_file(), full_file()
    turned = replace(other.project.options, excluded=frozenset(reversed(sorted(other.project.options.excluded))))
    results = dict(reversed(other.results.items()))
    results["scan"] = replace(results["scan"], rests_on=dict(reversed(results["scan"].rests_on.items())))
    other = replace(other, project=replace(other.project, options=turned), results=results)
    assert other == one
    assert project_text(other, tmp_path) == project_text(one, tmp_path)


def test_the_file_is_for_people_too(tmp_path):
    text = project_text(full_file(), tmp_path)
    tables = json.loads(text)
    assert list(tables) == [
        "schema_version", "version", "created", "saved", "info", "rig", "sources", "options", "accepted", "rejected",
        "repeats", "report", "inspection", "studies", "artefacts", "callouts", "plate_beside",
        "results",
    ]  # fmt: skip
    assert tables["schema_version"] == SCHEMA
    assert tables["options"]["excluded"] == ["camera/b.png", "planes/pose02", "scan/ä ö.png"]
    assert '    "name": "Block 50",\n' in text
    assert max(map(len, text.splitlines())) < 130


def test_the_rig_stands_in_the_project_as_in_rig_toml(tmp_path):
    import tomllib

    tables = json.loads(project_text(full_file(), tmp_path))
    assert tables["rig"] == tomllib.loads(rig_to_toml(full_project().rig))
    (tmp_path / "rig.toml").write_text(rig_to_toml(full_project().rig))
    assert read_rig(tmp_path / "rig.toml") == full_project().rig


def test_a_time_without_zone_is_local(tmp_path):
    naive = datetime(2026, 1, 31, 12, 0)
    back = written(tmp_path, ProjectFile(new_project("x"), {"scan": Done("k", {}, naive)}))
    assert back.results["scan"].at == naive.astimezone()


def spoilt(tmp_path, change):
    create_project(tmp_path, full_file())
    path = tmp_path / "project.json"
    tables = json.loads(path.read_text(encoding="utf-8"))
    change(tables)
    path.write_text(json.dumps(tables), encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_project(tmp_path)
    sentence = str(error.value)
    where = sentence.partition(".json: ")[0].removeprefix("…")  # a long path is told by its end
    assert where and f"{where}.json".endswith("project.json") and str(path).endswith(f"{where}.json")
    assert sentence.endswith(".")
    assert "\n" not in sentence
    return sentence


@pytest.mark.parametrize(("keys", "value", "said"), [
    (("info", "air_celsius"), "warm", 'info.air_celsius is "warm", not a temperature in °C, or null'),
    (("info", "part_celsius"), -300, "info.part_celsius is -300, not a temperature"),
    (("info", "name"), 7, "info.name is 7, not a text"),
    (("info", "nmae"), "x", "info.nmae is an unknown key (did you mean name?)"),
    (("notes",), "x", "notes is an unknown key"),
    (("rig", "laser_fan", "lines"), 0, "rig.laser_fan.lines is 0, not a whole number from 1 to 20"),
    (("rig", "camera_target", "kind"), "chess", 'rig.camera_target.kind is "chess"'),
    (("rig", "camera_target", "dictionary"), "DICT_4X4_70", "rig.camera_target.dictionary is"),
    (("rig", "gauge", "upper_polygon_px"), [[0, 0]], "rig.gauge.upper_polygon_px is [[0, 0]], not a list of three"),
    (("rig", "gauge", "tolerance_mm"), None, "rig.gauge.tolerance_mm is missing; nominal_mm and"),
    (("sources", "scan"), None, "sources.scan is null, not a text"),
    (("options", "method"), "magic", 'options.method is "magic", not "network" or "three-crossings"'),
    (("options", "sigma_cut_mm"), 0, "options.sigma_cut_mm is 0, not a length in mm above 0 and at most 10"),
    (("options", "camera", "fixed"), ["k3"], "options.camera.fixed"),
    (("options", "camera", "skew"), 1, "options.camera.skew is 1, not true or false"),
    (("options", "stripe", "contrast"), -1, "options.stripe: contrast is −1.0, not a positive number"),
    (("options", "excluded"), ["view.png"], "options.excluded[0]"),
    (("accepted", "planes"), "../../x", 'accepted.planes is "../../x", not the id of a calibration'),
    (("repeats", 0, "U_mm"), -1, "repeats[0].U_mm is -1, not a length in mm"),
    (("repeats", 1, "measured_at"), "2026-01-31T12:00:00", "repeats[1].measured_at is"),
    (("report", "paper"), "A3", 'report.paper is "A3", not "A4" or "Letter"'),
    (("results", "scan", "at"), "yesterday", 'results.scan.at is "yesterday", not a date and time with its zone'),
    (("results", "scan", "rests_on"), {"a": 1}, "results.scan.rests_on"),
    (("schema_version",), 0, "schema_version is 0, not a whole number from 1 to"),
    (("schema_version",), "1", "this is no project"),
    (("schema_version",), True, "this is no project"),
])  # fmt: skip
def test_a_wrong_value_is_told_with_file_and_field(tmp_path, keys, value, said):
    def change(tables):
        *path, last = keys
        for key in path:
            tables = tables[key]
        tables[last] = value

    assert said in spoilt(tmp_path, change)


@pytest.mark.parametrize("key", ["info", "rig"])
def test_what_a_project_cannot_do_without_is_missed(tmp_path, key):
    assert f"{key} is missing" in spoilt(tmp_path, lambda tables: tables.pop(key))


def test_what_is_not_there_is_as_usual(tmp_path):
    create_project(tmp_path, full_file())
    path = tmp_path / "project.json"
    tables = json.loads(path.read_text())
    path.write_text(json.dumps({"schema_version": 1, "info": {"name": "x"}, "rig": tables["rig"]}))
    assert read_project(tmp_path) == ProjectFile(replace(new_project("x"), rig=full_project().rig))


def test_the_title_of_a_study_in_an_older_project_is_told_as_it_was_written(tmp_path):
    create_project(tmp_path, full_file())
    path = tmp_path / "project.json"
    tables = json.loads(path.read_text())
    tables["schema_version"], tables["studies"][0]["title"] = 7, "3 parts × 2 operators"
    path.write_text(json.dumps(tables))
    assert read_project(tmp_path).project.studies[0].title == plain("3 parts × 2 operators")


def test_a_newer_project_is_refused_in_one_sentence_whatever_else_it_holds(tmp_path):
    sentence = spoilt(tmp_path, lambda tables: tables.update(schema_version=SCHEMA + 1, colours="many"))
    assert "written by a newer program" in sentence
    assert "open it with a newer version" in sentence


def test_an_older_project_is_brought_up_to_date_step_by_step(tmp_path, monkeypatch):
    create_project(tmp_path, ProjectFile(new_project("x")))
    path = tmp_path / "project.json"
    tables = json.loads(path.read_text())
    tables["info"]["title"] = tables["info"].pop("name")
    path.write_text(json.dumps(tables))

    def name_for_title(old):
        info = {**old["info"], "name": old["info"]["title"] + "!"}
        return {**old, "info": {key: value for key, value in info.items() if key != "title"}}

    def shout(old):
        return {**old, "info": {**old["info"], "name": old["info"]["name"].upper()}}

    monkeypatch.setattr(project_json, "SCHEMA", SCHEMA + 2)
    monkeypatch.setattr(project_json, "MIGRATIONS", {SCHEMA: name_for_title, SCHEMA + 1: shout})
    assert read_project(tmp_path).project.info.name == "X!"


def test_a_project_from_before_reports_had_a_language_states_none_and_no_template(tmp_path):
    create_project(tmp_path, ProjectFile(full_project()))
    tables = json.loads((tmp_path / "project.json").read_text())
    tables["schema_version"] = 2
    del tables["report"]["language"], tables["report"]["template"]
    (tmp_path / "project.json").write_text(json.dumps(tables))
    report = read_project(tmp_path).project.report
    assert (report.paper, report.language, report.template) == ("Letter", "", "")


def test_the_artefacts_of_a_project_from_before_they_had_a_kind_are_blocks(tmp_path):
    block = Artefact("GB 50-7", 50.0003, 0.0004)
    create_project(tmp_path, ProjectFile(replace(new_project("x"), artefacts=(block, replace(block, kind="sphere")))))
    tables = json.loads((tmp_path / "project.json").read_text())
    assert [one["kind"] for one in tables["artefacts"]] == ["block", "sphere"]
    tables["schema_version"] = 7
    for one in tables["artefacts"]:
        del one["kind"]
    (tmp_path / "project.json").write_text(json.dumps(tables))
    assert read_project(tmp_path).project.artefacts == (block, block)


def test_a_project_from_before_places_of_callouts_were_kept_has_none(tmp_path):
    create_project(tmp_path, ProjectFile(full_project()))
    tables = json.loads((tmp_path / "project.json").read_text())
    assert tables["callouts"] == {"ball Ø": [40.0, -70.5]}
    tables["schema_version"] = 11
    del tables["callouts"]
    (tmp_path / "project.json").write_text(json.dumps(tables))
    assert read_project(tmp_path).project == replace(full_project(), callouts={})


def test_results_of_a_project_from_before_they_had_the_names_of_the_steps_are_known_by_these(tmp_path):
    done = {step: Done(step) for step in ("scan", "gauge", "inspection")}
    create_project(tmp_path, ProjectFile(new_project("x"), done))
    tables = json.loads((tmp_path / "project.json").read_text())
    assert tables["results"].keys() == done.keys()
    results = tables["results"]
    tables["schema_version"] = 9
    tables["results"] = {"scan": results["scan"], "inspect": results["gauge"], "features": results["inspection"]}
    (tmp_path / "project.json").write_text(json.dumps(tables))
    assert read_project(tmp_path).results == done


def test_light_planes_accepted_in_a_project_from_before_they_had_the_name_of_their_step_stay_accepted(tmp_path):
    accepted = Accepted("0123456789ab", "ba9876543210")
    create_project(tmp_path, ProjectFile(replace(new_project("x"), accepted=accepted), {}))
    tables = json.loads((tmp_path / "project.json").read_text())
    assert tables["accepted"] == {"camera": "0123456789ab", "planes": "ba9876543210"}
    tables["schema_version"], tables["accepted"] = 10, {"camera": "0123456789ab", "fan": "ba9876543210"}
    (tmp_path / "project.json").write_text(json.dumps(tables))
    assert read_project(tmp_path).project.accepted == accepted


@pytest.mark.parametrize(("data", "said"), [
    (b"", "no valid JSON"),
    (b'{"schema_version": 1, "info": {', "no valid JSON"),
    (b"[1, 2]", "this is no project"),
    (b"{}", "this is no project"),
    (b'"\xff"', "this is no UTF-8 text: byte 2 is in no letter"),
])  # fmt: skip
def test_a_damaged_project_says_so(tmp_path, data, said):
    (tmp_path / "project.json").write_bytes(data)
    with pytest.raises(InputError, match=said):
        read_project(tmp_path)


def test_what_could_not_be_read_again_is_not_written(tmp_path):
    good = ProjectFile(new_project("good"))
    create_project(tmp_path, good)
    wrong = [
        replace(good.project, rig=replace(default_rig(), lines=99)),
        replace(good.project, info=ProjectInfo(air_celsius=math.nan, part_celsius=-500.0)),
        replace(good.project, repeats=(replace(REPEAT, thickness_mm=math.nan),)),
    ]
    for project in wrong:
        with pytest.raises(InputError, match=r"project\.json"):
            create_project(tmp_path, ProjectFile(project))
    assert read_project(tmp_path) == good


def test_projects_can_be_compared_and_sorted_out_by_sets():
    assert full_project() == full_project()
    assert len({full_project(), full_project(), new_project("a"), new_project("b")}) == 3
    assert ProjectFile(full_project(), created=AT) == ProjectFile(full_project(), saved=AT)
    assert ProjectFile(full_project()) != ProjectFile(full_project(), {"scan": Done("k", {}, AT)})


def test_a_new_project_has_a_name_and_nothing_else():
    project = new_project("Block")
    assert project == replace(Project(), info=ProjectInfo("Block"))
    assert project.rig == default_rig()
