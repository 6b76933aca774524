"""The command line on a small simulated set: what it writes, says, and leaves with."""

import hashlib
import json
import re
import subprocess
import sys
import tomllib

import numpy as np
import pytest
from pypdf import PdfReader

from core import __version__
from core.cli.app import whole_command
from core.files.results.ply_format import parse_ply
from core.report.wording import with_uncertainty
from tests.simulated import CUT, SMALL, copy_of, trisect

RESULTS = {"camera.json", "planes.json", "cloud.ply", "mesh.ply", "gauge.json", "report.pdf", "run.json"}
COMPANIONS = {"planes.npz", "scan.npz", "gauge.npz"}


def digests(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def test_a_run_writes_exactly_the_files_of_the_contract(measured):
    assert {path.name for path in measured.iterdir()} == RESULTS | COMPANIONS


def test_the_thickness_is_right_within_its_own_uncertainty(measured):
    gauge = json.loads((measured / "gauge.json").read_text())
    assert gauge["U_mm"] == pytest.approx(gauge["k"] * gauge["u_mm"])
    assert abs(gauge["thickness_mm"] - SMALL.height_mm) < 2 * gauge["U_mm"]
    assert gauge["U_mm"] < 1.0


def test_the_cloud_has_a_sigma_at_every_point_below_the_cut(measured):
    vertices = parse_ply((measured / "cloud.ply").read_bytes()).elements["vertex"]
    assert len(vertices) > 1000
    assert vertices["sigma"].min() > 0
    assert vertices["sigma"].max() <= 0.3
    assert set(np.unique(vertices["frame"])) <= set(range(-1, SMALL.frames))
    normals = np.column_stack([vertices[name] for name in ("nx", "ny", "nz")])
    towards = -np.einsum("ni,ni->n", normals, np.column_stack([vertices[name] for name in "xyz"]))
    known = normals.any(axis=1)
    assert known.mean() > 0.5
    assert np.all(towards[known] > 0)


def test_run_json_has_a_hash_of_every_input_and_a_record_of_every_frame(simulated, measured):
    record = json.loads((measured / "run.json").read_text())
    files = [path for path in simulated.rglob("*") if path.is_file()]
    assert record["inputs"] == {
        path.relative_to(simulated).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files
    }
    assert len(record["frames"]) == SMALL.frames
    assert all(frame["points"] > 0 or frame["reason"] for frame in record["frames"])
    assert set(record["timings_s"]) == {"camera", "planes", "scan", "gauge", "report"}
    assert record["version"] == __version__


def test_page_one_of_the_report_says_that_a_simulated_set_is_simulated(simulated, measured):
    assert tomllib.loads((simulated / "rig.toml").read_text())["simulated"] is True
    assert json.loads((measured / "run.json").read_text())["simulated"] is True
    page = " ".join(PdfReader(str(measured / "report.pdf")).pages[0].extract_text().split())
    assert "Simulated: every picture was rendered by a program, and no real part was measured." in page


def test_the_report_names_part_thickness_and_version(measured):
    gauge = json.loads((measured / "gauge.json").read_text())
    text = "\n".join(page.extract_text() for page in PdfReader(str(measured / "report.pdf")).pages)
    assert 1 <= len(PdfReader(str(measured / "report.pdf")).pages) <= 4
    assert __version__ in text
    value, uncertainty = with_uncertainty(gauge["thickness_mm"], gauge["U_mm"])
    assert f"{value} mm ± {uncertainty} mm" in " ".join(text.split())


def test_the_report_has_the_results_with_it_as_they_are(measured):
    attached = {name: files[0] for name, files in PdfReader(str(measured / "report.pdf")).attachments.items()}
    assert set(attached) == {"camera.json", "planes.json", "gauge.json"}
    assert all(data == (measured / name).read_bytes() for name, data in attached.items())


@pytest.mark.accuracy
def test_each_step_alone_gives_the_same_files_as_the_whole_run(simulated, measured, tmp_path):
    out = tmp_path / "out"
    for step in ("camera", "planes", "scan", "gauge", "report"):
        said = trisect(step, simulated, "--out", out, *(CUT if step == "scan" else ()))
        assert said.code in (0, 1), said.err
    whole, steps = digests(measured), digests(out)
    for name in (RESULTS | COMPANIONS) - {"run.json", "report.pdf"}:
        assert steps[name] == whole[name], name
    assert report_without_times(out) == report_without_times(measured)


def report_without_times(out):
    """The report's text without dates and times of day: of the measurement, and of each calibration."""
    text = "\n".join(page.extract_text() for page in PdfReader(str(out / "report.pdf")).pages)
    return re.sub(r"\d{4}-\d\d-\d\d|\b\d\d:\d\d(:\d\d)?\b", "", text).split()


def test_the_report_alone_gives_the_same_bytes(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    (out / "report.pdf").unlink()
    assert trisect("report", simulated, "--out", out).code == 0
    assert (out / "report.pdf").read_bytes() == (measured / "report.pdf").read_bytes()


def with_gauge(folder, table):
    rig = folder / "rig.toml"
    rig.write_text(rig.read_text().partition("[gauge]")[0] + table)
    return folder


def test_exit_code_1_when_the_part_is_out_of_tolerance(simulated, measured, tmp_path):
    folder = with_gauge(copy_of(simulated, tmp_path / "set"), "[gauge]\nnominal_mm = 45.0\ntolerance_mm = 0.2\n")
    said = trisect("gauge", folder, "--out", copy_of(measured, tmp_path / "out"))
    assert said.code == 1
    assert "not conforming" in said.out


def test_without_a_nominal_value_no_verdict_and_exit_code_0(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    said = trisect("gauge", with_gauge(copy_of(simulated, tmp_path / "set"), ""), "--out", out, "--json", "--quiet")
    values = json.loads(said.out)  # one object and nothing else
    assert (said.code, said.err) == (0, "")
    assert (values["verdict"], values["nominal_mm"]) == ("", None)
    assert values["thickness_mm"] == json.loads((measured / "gauge.json").read_text())["thickness_mm"]
    assert values["files"]["gauge"] == str(out / "gauge.json")


def test_the_papers_method_by_name(tiny_set, tiny_measured, tmp_path):
    out = copy_of(tiny_measured, tmp_path / "out")
    said = trisect("scan", tiny_set, "--out", out, "--method", "three-crossings", *CUT, "--json")
    assert said.code == 0, said.err
    assert json.loads((out / "run.json").read_text())["settings"]["scan"]["method"] == "three-crossings"
    assert (out / "cloud.ply").read_bytes() != (tiny_measured / "cloud.ply").read_bytes()


def test_a_scan_without_reference_makes_one_of_its_frames(tiny_set, tiny_measured, tmp_path):
    folder = copy_of(tiny_set, tmp_path / "set")
    (folder / "scan" / "reference.png").unlink()
    said = trisect("scan", folder, "--out", copy_of(tiny_measured, tmp_path / "out"), *CUT)
    assert said.code == 0, said.err
    assert "There is no scan/reference.png" in said.out


def first_name(folder, part):
    return f"{part}/{min(path.name for path in (folder / part).iterdir() if path.stem != 'reference')}"


def text_of(kept):
    """A message in a file, or the text that stands for it."""
    return kept["text"] if isinstance(kept, dict) else kept


@pytest.mark.accuracy
def test_pictures_are_left_out_by_name(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    view, frame = first_name(simulated, "camera"), first_name(simulated, "scan")
    pose = first_name(simulated, "planes").partition(".")[0].removesuffix("_off")
    for step, name in (("camera", view), ("planes", pose), ("scan", frame)):
        said = trisect(step, simulated, "--out", out, "--exclude", name, *(CUT if step == "scan" else ()))
        assert said.code == 0, said.err
        assert json.loads((out / "run.json").read_text())["settings"][step]["excluded"] == [name]
    run, reason = json.loads((out / "run.json").read_text()), "left out by hand"
    views, poses = (json.loads((out / name).read_text()) for name in ("camera.json", "planes.json"))
    for name, rows in ((view, views["views"]), (pose.partition("/")[2], poses["poses"]), (frame, run["frames"])):
        found = {row["name"]: (row["used"], text_of(row["reason"])) for row in rows}
        assert found[name] == (False, reason)
        assert [row for row in found.values() if row[1] == reason] == [(False, reason)]


@pytest.mark.accuracy
def test_a_camera_adjusted_with_the_fan_is_the_one_the_scan_uses(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    assert trisect("planes", simulated, "--out", out, "--adjust-camera").code == 0
    camera, planes = (json.loads((out / name).read_text()) for name in ("camera.json", "planes.json"))
    adjusted = planes["camera"]
    assert planes["camera_id"] == camera["id"] != adjusted["id"]
    assert 0 < abs(adjusted["matrix"][0][0] - camera["matrix"][0][0]) < 3 * camera["sd"]["alpha"]
    assert adjusted["covariance"][0][0] < camera["sd"]["alpha"] ** 2
    assert json.loads((out / "run.json").read_text())["settings"]["planes"]["camera"] == "adjusted"
    assert trisect("scan", simulated, "--out", out, *CUT).code == 0
    assert f"{adjusted['id']}-{planes['id']}".encode() in (out / "cloud.ply").read_bytes()[:2000]


def test_a_picture_that_is_not_there_cannot_be_left_out_and_no_result_is_touched(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    view = first_name(simulated, "camera")
    said = trisect("run", simulated, "--out", out, "--exclude", view, "--exclude", view.replace("camera", "camra"))
    assert said.code == 2
    assert f"the nearest is {view}" in said.sentence
    assert digests(out) == digests(measured)


def test_a_table_for_people(simulated, measured, tmp_path):
    said = trisect("camera", simulated, "--out", copy_of(measured, tmp_path / "out"), "--quiet")
    assert said.code == 0
    assert "corners off by" in said.out
    assert "camera.json" in said.out
    assert said.err == ""


def test_version_and_help():
    assert trisect("--version").out == f"trisect {__version__}\n"
    for command in ("run", "camera", "planes", "scan", "gauge", "report", "simulate", "demo"):
        said = trisect(command, "--help")
        assert said.code == 0
        assert "Usage: trisect" in said.out


def test_help_imports_no_scipy():
    program = """
import sys
from core.cli import main
try:
    main(["--help"])
finally:
    print(*sorted(name for name in sys.modules if name.partition(".")[0] in ("scipy", "numba", "pydantic")))
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "Usage: trisect" in ran.stdout
    assert ran.stdout.splitlines()[-1] == ""


def test_a_wrong_command_line_leaves_with_2():
    assert trisect("measure").code == 2
    assert trisect("run").code == 2
    assert trisect("run", "SET", "--out", "DIR", "--method", "magic").code == 2


def test_simulate_writes_a_set_that_can_be_opened(tmp_path):
    from core.files.recording.recording_set import open_set

    out = tmp_path / "set"
    said = trisect(
        "simulate", "sphere", "--out", out, "--scale", 0.1, "--frames", 2, "--views", 1, "--poses", 1, "--seed", 5
    )
    assert said.code == 0, said.err
    recording_set = open_set(out)
    assert (len(recording_set.camera), len(recording_set.planes), len(recording_set.frames)) == (1, 1, 2)
    assert not list(out.rglob("*truth*"))
    again = trisect("simulate", "sphere", "--out", out)
    assert again.code == 2
    assert "there is something already" in again.sentence


def test_simulate_takes_effects_of_real_rigs_from_a_file(tmp_path):
    from core.files.recording.recording_set import open_set

    effects, out = tmp_path / "effects.toml", tmp_path / "set"
    effects.write_text("[sensor]\njpeg_quality = 70\n[room]\nflicker = 0.2\n")
    small = ("--scale", 0.1, "--frames", 1, "--views", 1, "--poses", 1)
    assert trisect("simulate", "block", "--out", out, *small, "--effects", effects, "--unstated").code == 0
    recording_set = open_set(out)
    assert [path.suffix for path in recording_set.frames] == [".jpg"]
    assert recording_set.rig.stability is None
    effects.write_text("[sensors]\njpeg_quality = 70\n")
    assert (
        "'sensors' is not a field"
        in trisect("simulate", "block", "--out", tmp_path / "b", "--effects", effects).sentence
    )


@pytest.mark.accuracy
def test_width_and_contrast_of_the_stripes_can_be_given(simulated, measured, tmp_path):
    out = copy_of(measured, tmp_path / "out")
    said = trisect("scan", simulated, "--out", out, *CUT, "--stripe-width", 2.4, "--contrast", 60)
    assert said.code == 0, said.err
    run = json.loads((out / "run.json").read_text())
    assert run["settings"]["scan"]["stripe"] == {"width_px": 2.4, "contrast": 60.0}
    assert "stripes.told_width_wrong" in [note["code"] for note in run["notes"]["scan"]]


def test_a_width_without_a_contrast_is_refused(simulated, tmp_path):
    said = trisect("scan", simulated, "--out", tmp_path, "--stripe-width", 4)
    assert said.code == 2
    assert "--contrast" in said.sentence


def test_no_word_of_a_help_is_taken_for_markup():
    """What stands in brackets would be missing on the screen."""
    commands = {"": whole_command()[0], **whole_command()[0].commands}
    helps = [p.help for command in commands.values() for p in command.params if getattr(p, "help", None)]
    helps += [command.help for command in commands.values() if command.help]
    assert len(helps) > 100
    assert not [one for one in helps if re.search(r"(?<!\\)\[[a-z/]", one)]
