"""What scripts are promised: names, documentation, the same results as the program's own steps, clear refusals."""

import inspect
import json
import pickle
import subprocess
import sys
from dataclasses import replace
from typing import Any, cast

import cv2
import numpy as np
import pytest

import trisect
from core.findings.proof import SIZE_UNCONFIRMED
from core.model import Camera
from core.scan.method import Method
from tests.simulated import CUT
from trisect import promised
from trisect.scan import _plates

PROMISED = {
    "read_picture", "extract_stripes", "find_crossings", "find_target", "calibrate_camera", "calibrate_fan",
    "triangulate", "solve_scan", "fuse", "build_mesh", "measure_thickness", "measure_features", "read_cloud",
    "write_cloud", "open_set", "run", "simulate", "report", "join_views", "open_project",
    "Camera", "LightPlane", "Fan", "Cloud",
    "Mesh", "Gauge", "Length", "InputError", "Cancelled",
    # what these take and give
    "BlackSquare", "BoardTolerance", "CameraCalibration", "Centreline", "Charuco", "Checkerboard", "CircleGrid",
    "Crossing", "FanCalibration", "Feature", "JoinedViews", "Options", "Part", "ReconstructOptions", "SolvedScan",
    "Stability", "TargetView", "compression_of",
    # what a package with kinds of features of its own declares
    "FeatureKind", "ResultKind",
}  # fmt: skip
"""A name goes from here only after a version that warns of it."""
OWN = [getattr(trisect, name) for name in sorted(PROMISED) if name[0].islower() and name != "open_project"]


def test_every_promised_name_is_there_and_no_other():
    assert set(trisect.__all__) == set(promised.__all__) == set(dir(trisect)) == PROMISED
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        trisect.__getattr__("nothing")
    assert all(hasattr(trisect, name) for name in PROMISED)


@pytest.mark.parametrize("function", OWN, ids=lambda one: one.__name__)
def test_each_function_says_what_it_takes_gives_and_refuses_with_an_example(function):
    text = inspect.getdoc(function)
    sections = ["Returns\n---", "Examples\n---", ">>> "]
    sections += ["Raises\n---"] * (
        function not in (trisect.find_crossings, trisect.compression_of)
    )  # which refuse nothing
    sections += ["Parameters\n---"] * (len(inspect.signature(function).parameters) > 1)
    assert [one for one in sections if one not in text] == []
    annotations = inspect.signature(function)
    assert annotations.return_annotation is not inspect.Signature.empty
    assert all(one.annotation is not inspect.Parameter.empty for one in annotations.parameters.values())


def test_nothing_of_a_window_or_of_plots_is_imported():
    code = "import sys, trisect; print(*sorted({one.partition('.')[0] for one in sys.modules}))"
    loaded = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=True).stdout.split()
    assert not {"workbench", "PySide6", "pyvista", "vtkmodules", "matplotlib"} & set(loaded)


@pytest.fixture(scope="module")
def calibrated(simulated):
    """The set, its camera and its fan, by arrays alone."""
    found = trisect.open_set(simulated)
    rig = found.rig
    views = [
        trisect.find_target(trisect.read_picture(path), rig.camera_target, name=path.stem) for path in found.camera
    ]
    height, width = trisect.read_picture(found.camera[0]).shape
    camera = trisect.calibrate_camera(views, (width, height), tolerance=rig.camera_board)
    pairs = [
        (trisect.read_picture(pose.on), None if pose.off is None else trisect.read_picture(pose.off))
        for pose in found.planes
    ]
    fan = trisect.calibrate_fan(pairs, rig.plane_target, camera, angle=rig.angle, tolerance=rig.plane_board)
    return found, camera, fan


def frames_of(found):
    reference = None if found.reference is None else trisect.read_picture(found.reference)
    return [trisect.read_picture(path) for path in found.frames], reference


@pytest.fixture(scope="module")
def solved(calibrated):
    found, camera, fan = calibrated
    frames, reference = frames_of(found)
    cut = float(CUT[CUT.index("--sigma-cut") + 1])
    return trisect.solve_scan(
        frames, camera, fan, reference=reference,
        options=trisect.ReconstructOptions(sigma_cut_mm=cut, row_time_us=found.rig.row_time_us),
        stability=found.rig.stability,
    )  # fmt: skip


def test_arrays_give_the_thickness_that_the_steps_give(calibrated, solved, measured):
    found = calibrated[0]
    spec = found.rig.gauge
    gauge = trisect.measure_thickness(
        solved, nominal_mm=spec.nominal_mm, tolerance_mm=spec.tolerance_mm, part=found.rig.part
    )
    of_steps = json.loads((measured / "gauge.json").read_text(encoding="utf-8"))
    assert gauge.thickness_mm == pytest.approx(of_steps["thickness_mm"], abs=0.001)
    assert gauge.U_mm == pytest.approx(of_steps["U_mm"], rel=0.02)
    assert str(gauge.verdict) == of_steps["verdict"]
    assert {str(row.source) for row in gauge.budget} == {row["source"]["text"] for row in of_steps["budget"]}


def test_what_nobody_states_of_the_rig_is_in_u_and_told(calibrated, solved):
    found, camera, fan = calibrated
    frames, reference = frames_of(found)
    unstated = trisect.solve_scan(
        frames, camera, fan, reference=reference, options=trisect.ReconstructOptions(sigma_cut_mm=0.3)
    )
    assert found.rig.stability is not None, "the simulated rig states it"
    assert trisect.measure_thickness(unstated).u_mm > trisect.measure_thickness(solved).u_mm
    assert any(note.code == "scan.shutter_assumed" for note in unstated.notes)


def test_a_scan_is_judged_by_the_method_it_is_solved_by(calibrated, monkeypatch):
    found, camera, fan = calibrated
    frames, reference = frames_of(found)
    judged_by: list[Method] = []

    def judged(*_: object, method: Method = Method.NETWORK, **__: object) -> None:
        judged_by.append(method)
        raise trisect.Cancelled

    monkeypatch.setattr("trisect.scan.judged_scan", judged)
    options = trisect.ReconstructOptions(Method.THREE_CROSSINGS, sigma_cut_mm=5.0)
    with pytest.raises(trisect.Cancelled):
        trisect.solve_scan(frames, camera, fan, reference=reference, options=options)
    assert judged_by == [Method.THREE_CROSSINGS]


def test_plates_whose_stripes_do_not_fit_them_are_no_plates(calibrated):
    fan = calibrated[2]
    assert len(_plates(fan)) == sum(pose.used for pose in fan.poses) > 0
    assert _plates(replace(fan, stripes=())) == [], "of a file, which holds no stripes"
    with pytest.raises(ValueError, match="shorter"):
        _plates(replace(fan, stripes=fan.stripes[:-1]))


def test_a_target_whose_size_nobody_states_proves_nothing(calibrated):
    found, camera, _ = calibrated
    pairs = [(trisect.read_picture(pose.on), trisect.read_picture(pose.off)) for pose in found.planes]
    fan = trisect.calibrate_fan(pairs, found.rig.plane_target, camera, angle=found.rig.angle)
    frames, reference = frames_of(found)
    scan = trisect.solve_scan(
        frames, camera, fan, reference=reference, options=trisect.ReconstructOptions(sigma_cut_mm=0.3)
    )
    assert fan.scale_assumed and scan.facts.size_unconfirmed
    gauge = trisect.measure_thickness(scan, nominal_mm=50.0, tolerance_mm=5.0)
    assert str(gauge.verdict) == "not proven" and SIZE_UNCONFIRMED.note in gauge.notes


def test_points_alone_prove_nothing(solved):
    gauge = trisect.measure_thickness(solved.cloud, nominal_mm=50.0, tolerance_mm=5.0)
    assert str(gauge.verdict) == "not proven"
    assert gauge.notes[0].code == "inspection.missing_in_u"
    inspection = trisect.measure_features(solved.cloud, [trisect.Feature("block", "thickness")])
    assert not any(not one.doubts for one in inspection.characteristics)


def test_surface_and_features_come_from_the_same_scan(solved):
    mesh = trisect.build_mesh(trisect.fuse(solved.cloud, solved.features.image_size))
    assert len(mesh.triangles) > 1000
    inspection = trisect.measure_features(solved, [trisect.Feature("block", "thickness")], mesh=mesh)
    (row,) = [one for one in inspection.characteristics if one.kind == "thickness"]
    assert isinstance(row, trisect.Length)
    assert row.value == pytest.approx(trisect.measure_thickness(solved).thickness_mm, abs=0.02)


GREY = np.full((40, 60), 20, np.uint8)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: trisect.extract_stripes(np.zeros((40, 60, 3), np.uint8)), "picture: an array of shape (40, 60, 3)"),
        (lambda: trisect.extract_stripes(np.full((40, 60), np.nan)), "type float64 is no picture"),
        (lambda: trisect.extract_stripes(np.zeros((0, 60), np.uint8)), "shape (0, 60)"),
        (lambda: trisect.extract_stripes([]), "no picture"),
        (lambda: trisect.extract_stripes(GREY, GREY[:20]), "background: the pictures differ"),
        (lambda: trisect.extract_stripes(GREY, GREY.astype(np.uint16)), "uint16"),
        (lambda: trisect.extract_stripes(GREY, width_px=8.0), "width and contrast"),
        (lambda: trisect.extract_stripes(GREY, width_px=-8.0, contrast=60.0), "width and contrast"),
        (lambda: trisect.find_target(GREY, trisect.Checkerboard(8, 6, 5.0)), "picture"),
        (lambda: trisect.find_target(GREY, cast(Any, "checkerboard")), "target: str is given where Checkerboard or "),
        (lambda: trisect.calibrate_camera([], (60, 40)), ""),
        (lambda: trisect.calibrate_camera([], cast(Any, (60.5, 40))), "image_size: (60.5, 40) is no size"),
        (lambda: trisect.calibrate_camera([], (0, 0)), "no size of pictures"),
        (lambda: trisect.read_picture("nowhere.png"), "nowhere.png"),
        (lambda: trisect.read_cloud("nowhere.ply"), "nowhere.ply"),
        (lambda: trisect.open_set("nowhere"), "nowhere"),
    ],
)
def test_what_cannot_be_done_is_refused_in_a_sentence(call, said):
    with pytest.raises(trisect.InputError) as refused:
        call()
    assert said in str(refused.value)
    assert str(refused.value).endswith(".")


def test_scans_that_cannot_be_solved_are_refused(calibrated):
    found, camera, fan = calibrated
    frames, reference = frames_of(found)
    with pytest.raises(trisect.InputError, match="at least three frames"):
        trisect.solve_scan(frames[:2], camera, fan)
    with pytest.raises(trisect.InputError, match=r"frame 2: the pictures differ"):
        trisect.solve_scan([frames[0], frames[1][:-1]], camera, fan, reference=reference)
    with pytest.raises(trisect.InputError, match="camera: the pictures differ"):
        trisect.solve_scan([frame[:-1] for frame in frames], camera, fan, reference=reference[:-1])
    for wrong in ({"sigma_cut_mm": np.inf}, {"sigma_cut_mm": 0.0}, {"row_time_us": np.nan}, {"row_time_us": -5.0}):
        with pytest.raises(trisect.InputError, match="options: a σ cut"):
            trisect.solve_scan(frames, camera, fan, options=trisect.ReconstructOptions(**wrong))
    for covariance in (0 * camera.covariance, camera.covariance[:3, :3], np.nan * camera.covariance):
        with pytest.raises(trisect.InputError, match="no covariance"):
            trisect.solve_scan(frames, replace(camera, covariance=covariance), fan)
    with pytest.raises(trisect.InputError):
        trisect.solve_scan([np.zeros_like(frame) for frame in frames], camera, fan)


def test_a_record_of_another_kind_is_refused_in_a_sentence(calibrated, solved):
    _, camera, fan = calibrated
    stripes, board = solved.features.fan, trisect.Checkerboard(8, 6, 5.0)
    for call, said in (
        (lambda: trisect.solve_scan([GREY] * 3, camera, fan.fan), "fan: Fan is given where FanCalibration is needed"),
        (lambda: trisect.solve_scan([GREY] * 3, camera.camera, fan), "camera: Camera is given where CameraCalibration"),
        (lambda: trisect.calibrate_fan([], board, camera.camera), "camera: Camera is given where CameraCalibration"),
        (lambda: trisect.find_target(GREY, board, camera=camera), "camera: CameraCalibration is given where Camera is"),
        (lambda: trisect.triangulate(stripes[0], fan, camera.camera), "where LightPlane is needed"),
        (lambda: trisect.build_mesh(solved.cloud), "surface: Cloud is given where Surface is needed"),
        (lambda: trisect.measure_features(solved, [], mesh=solved.cloud), "mesh: Cloud is given where Mesh is needed"),
        (lambda: trisect.measure_features(solved, [board]), "features[0]: Checkerboard is given where Feature is"),
        (lambda: trisect.measure_thickness(solved.result), "scan: ScanResult is given where SolvedScan or Cloud is"),
        (lambda: trisect.measure_thickness(None), "scan: NoneType is given where SolvedScan or Cloud is needed"),
        (lambda: trisect.calibrate_camera(camera.views, (60, 40)), "views[0]: ViewQuality is given where TargetView"),
        (
            lambda: trisect.calibrate_camera(camera.views[0].view, (60, 40)),
            "views: TargetView is given where Sequence is needed",
        ),
        (lambda: trisect.find_crossings(stripes, stripes[0]), "other: Centreline is given where Sequence is needed"),
        (lambda: trisect.run("set", "out", options=trisect.ReconstructOptions()), "where Options is needed"),
        (lambda: trisect.write_cloud("cloud.ply", solved), "cloud: SolvedScan is given where Cloud is needed"),
    ):
        with pytest.raises(trisect.InputError) as refused:
            call()
        assert said in str(refused.value)
        assert "; help(trisect." in str(refused.value)


def test_functions_can_be_sent_to_other_processes():
    assert all(pickle.loads(pickle.dumps(function)) is function for function in OWN)


def test_views_of_other_pictures_or_of_another_target_are_refused(calibrated):
    found, camera, _ = calibrated
    views, (width, height) = [one.view for one in camera.views], camera.camera.image_size
    for wrong in ((height, width), (width // 2, height // 2)):
        with pytest.raises(
            trisect.InputError, match=r"image_size: .* has a point at .* outside pictures of .*; give \(width, height\)"
        ):
            trisect.calibrate_camera(views, wrong)
    other = trisect.Checkerboard(8, 6, 5.0)
    with pytest.raises(trisect.InputError) as refused:
        trisect.calibrate_camera([*views[:3], replace(views[3], target=other), *views[4:]], (width, height))
    assert str(refused.value).startswith(
        f"{views[3].name}: this view shows {other} and {views[0].name} shows {views[0].target}, but "
    )
    nameless = [replace(view, name="", target=None) for view in views[:2]] + [replace(views[2], name="", target=other)]
    with pytest.raises(trisect.InputError, match=r"view 4: this view shows .* and view 3 shows"):
        trisect.calibrate_camera([*nameless, replace(views[3], name="")], (width, height))
    picture = trisect.read_picture(found.camera[0])
    with pytest.raises(trisect.InputError, match="camera: the pictures differ"):
        trisect.find_target(picture.T, found.rig.camera_target, camera=camera.camera)


def test_compressed_pictures_have_less_sure_stripes(tmp_path):
    v = np.mgrid[:80, :160][0]
    noise = np.random.default_rng(2).normal(0, 0.3, v.shape)
    picture = (30 + noise + 100 * np.exp(-0.5 * ((v - 40.3) / 2.5) ** 2)).astype(np.uint8)
    cv2.imwrite(str(tmp_path / "one.jpg"), picture, [cv2.IMWRITE_JPEG_QUALITY, 40])
    read = trisect.read_picture(tmp_path / "one.jpg")
    told = trisect.extract_stripes(read, compression=trisect.compression_of(tmp_path / "one.jpg"))
    assert np.median(told[0].sigma) > np.median(trisect.extract_stripes(read)[0].sigma)


def test_a_laser_that_cannot_be_and_pictures_of_another_camera_are_refused_at_once(calibrated):
    found, camera, _ = calibrated
    pair = (trisect.read_picture(found.planes[0].on), trisect.read_picture(found.planes[0].off))
    for wrong in ({"lines": 0}, {"angle": 5.0}):
        with pytest.raises(trisect.InputError, match="in rad"):
            trisect.calibrate_fan([pair], found.rig.plane_target, camera, **wrong)
    with pytest.raises(trisect.InputError, match="pose 1, camera: the pictures differ"):
        trisect.calibrate_fan([(pair[0].T, pair[1].T)], found.rig.plane_target, camera)


def test_a_foreign_core_is_told_in_a_sentence(tmp_path):
    (tmp_path / "core").mkdir()
    (tmp_path / "core/__init__.py").write_text("raise SystemExit(5)")
    said = subprocess.run(
        (sys.executable, "-c", "import trisect; trisect.Camera"), capture_output=True, text=True, cwd=tmp_path
    )
    assert said.returncode == 1
    assert "is found before its own folder" in said.stderr.splitlines()[-1]


def test_an_empty_picture_has_no_stripes_and_these_no_crossings():
    assert trisect.extract_stripes(GREY) == ()
    assert trisect.find_crossings((), ()) == ()


def test_points_of_a_stripe_are_as_unsure_as_their_plane():
    _, u = np.mgrid[:80, :120]
    (stripe,) = trisect.extract_stripes((20 + 150 * np.exp(-0.5 * ((u - 60) / 2.5) ** 2)).astype(np.uint8))
    camera = Camera((120, 80), np.array([[500.0, 0, 59.5], [0, 500.0, 39.5], [0, 0, 1]]))
    plane = trisect.LightPlane.from_normal([0.6, 0, 0.8], 400.0)
    exact = trisect.triangulate(stripe, plane, camera)
    unsure = trisect.triangulate(stripe, plane, camera, covariance=1e-12 * np.eye(3))
    with pytest.raises(trisect.InputError, match="no covariance"):
        trisect.triangulate(stripe, plane, camera, covariance=np.eye(2))
    assert np.all(unsure.sigma > exact.sigma)
