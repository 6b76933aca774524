"""What the window shows of a scan: the files' numbers, in the order of σ, ready to be drawn."""

import json
import pickle
import shutil
from dataclasses import replace

import numpy as np
import pytest

from core.errors import Cancelled, InputError
from core.files.project.folder import results_folder
from core.files.recording.rig import GaugeSpec
from core.files.results.ply import read_cloud, read_mesh
from core.inspect.faces import region_field
from core.inspect.shown.shown_scan import DEPTH, HEIGHT, LOWER, NO_FACE, UPPER
from core.pipeline.project.inspect_view import inspection_view, outline_selected
from core.pipeline.project.measuring import measure_gauge
from tests.simulated import copy_of


@pytest.fixture(scope="module")
def view(done):
    return inspection_view(done.folder, done.project)


@pytest.fixture(scope="module")
def cloud(done):
    return read_cloud(results_folder(done.folder) / "cloud.ply").cloud


def without(done, tmp_path, *names):
    folder = copy_of(done.folder, tmp_path / "project")
    for name in names:
        (results_folder(folder) / name).unlink()
    return folder


def test_points_come_in_the_order_of_their_sigma_and_keep_what_belongs_to_them(view, cloud):
    assert len(view) == len(cloud)
    assert np.all(np.diff(view.sigma) >= 0)
    assert np.array_equal(view.points, cloud.points[view.number])
    assert np.array_equal(view.uv, cloud.uv[view.number].astype(np.float32))
    numbers = np.where(cloud.frame[view.number] >= 0, cloud.frame[view.number] + 1, np.nan)
    assert np.array_equal(view.frame, numbers.astype(np.float32), equal_nan=True)


def test_points_up_to_a_sigma_are_the_first_ones(view, cloud):
    limit = float(np.median(cloud.sigma))
    assert view.up_to(limit) == np.count_nonzero(view.sigma <= np.float32(limit))
    assert view.up_to(0.0) == 0
    assert view.up_to(1.0) == len(view)


def test_heights_are_over_the_lower_face(view):
    assert view.height_is == HEIGHT
    upper, lower = view.gauge.upper.indices, view.gauge.lower.indices
    assert np.median(view.height[upper]) == pytest.approx(view.gauge.thickness_mm, abs=0.1)
    assert np.median(view.height[lower]) == pytest.approx(0.0, abs=0.1)


def test_the_points_used_keep_their_face_and_their_deviation(view, done):
    gauge = done.summary.gauge
    assert view.gauge.points_used == gauge.points_used
    assert view.gauge.thickness_mm == gauge.thickness_mm
    for face, kind, before in ((view.gauge.upper, UPPER, gauge.upper), (view.gauge.lower, LOWER, gauge.lower)):
        assert np.all(np.diff(face.indices) > 0)
        assert np.array_equal(np.sort(view.number[face.indices]), np.sort(before.indices))
        assert np.all(view.face[face.indices] == kind)
        assert np.allclose(view.deviation[face.indices], face.residuals, atol=1e-6)
    assert np.array_equal(np.isnan(view.deviation), view.face == NO_FACE)


def test_the_points_used_among_the_first_ones_are_told(view):
    half = len(view) // 2
    upper, lower = view.used_up_to(half)
    assert np.array_equal(upper, np.flatnonzero(view.face[:half] == UPPER))
    assert np.array_equal(lower, np.flatnonzero(view.face[:half] == LOWER))


def test_the_mesh_can_be_cut_by_sigma_like_the_points(view, done):
    mesh, file = view.mesh, read_mesh(results_folder(done.folder) / "mesh.ply")
    assert len(mesh.triangles) == len(file.triangles)
    limit = float(np.median(mesh.triangle_sigma))
    shown = mesh.triangles[: mesh.up_to(limit)]
    assert mesh.sigma[shown].max() <= np.float32(limit)
    on_faces = np.isfinite(mesh.deviation)
    assert 0.3 < on_faces.mean() < 1
    assert np.nanmax(np.abs(mesh.deviation)) < 3.0


def test_outlines_lie_round_the_points_used(view):
    for outline, used in zip(view.outlines, view.used_uv, strict=True):
        assert 3 <= len(outline) <= 16
        inside = np.all((used > outline.min(axis=0) - 3) & (used < outline.max(axis=0) + 3), axis=1)
        assert inside.mean() > 0.8


def test_pictures_are_named_the_reference_first_and_the_best_frame_is_known(view):
    assert view.pictures[0] == "scan/reference.png"
    assert view.shown in view.pictures[1:]
    first = int(np.flatnonzero(np.isfinite(view.frame))[0])
    assert view.frame_name(first) == f"scan/frame{int(view.frame[first]) - 1:04d}.png"
    fan = np.flatnonzero(np.isnan(view.frame))
    assert view.frame_name(int(fan[0])) == ""


def test_the_relief_is_bright_where_the_block_is(view):
    relief, gauge = view.relief, view.gauge

    def grey(uv):
        column, row = np.floor((uv + 0.5) / relief.cell_px).astype(int).T
        return np.median(relief.picture[row, column])

    width, height = view.image_size
    assert relief.picture.shape[1] == pytest.approx(width / relief.cell_px, abs=1)
    assert relief.picture.shape[0] == pytest.approx(height / relief.cell_px, abs=1)
    assert grey(view.uv[gauge.upper.indices]) > grey(view.uv[gauge.lower.indices]) + 50


def test_it_can_be_sent_to_another_process(view):
    again = pickle.loads(pickle.dumps(view))
    assert np.array_equal(again.points, view.points)
    assert again.points.dtype == np.float64 and again.points.flags.c_contiguous  # as the 3D view holds them
    assert again.gauge.thickness_mm == view.gauge.thickness_mm


def test_without_a_thickness_there_are_depths_and_no_faces(done, tmp_path):
    view = inspection_view(without(done, tmp_path, "gauge.json", "gauge.npz"), done.project)
    assert view.gauge is None and view.outlines is None and view.used_uv is None
    assert view.height_is == DEPTH
    assert np.allclose(view.height, view.points[:, 2], atol=1e-3)
    assert np.isnan(view.deviation).all() and not view.face.any()
    assert [len(used) for used in view.used_up_to(len(view))] == [0, 0]


def test_without_a_mesh_the_points_are_shown_alone(done, tmp_path):
    assert inspection_view(without(done, tmp_path, "mesh.ply"), done.project).mesh is None


def test_pictures_that_are_gone_are_not_missed(done):
    sources = replace(done.project.sources, scan="gone")
    view = inspection_view(done.folder, replace(done.project, sources=sources))
    assert view.pictures == () and view.shown == ""


def test_without_a_scan_it_says_what_to_do(done, tmp_path):
    with pytest.raises(InputError, match=r"no scan among the results.*scan the part first"):
        inspection_view(without(done, tmp_path, "cloud.ply"), done.project)


def test_a_damaged_scan_is_told_with_its_reason(done, tmp_path):
    folder = copy_of(done.folder, tmp_path / "project")
    (results_folder(folder) / "cloud.ply").write_bytes(b"ply\n")
    with pytest.raises(InputError, match=r"no scan among the results \(.*cloud\.ply"):
        inspection_view(folder, done.project)


def test_it_can_be_cancelled(done):
    def cancel(step, done_, total):
        if step == "preparing what is shown":
            raise Cancelled

    with pytest.raises(Cancelled):
        inspection_view(done.folder, done.project, cancel)


# ---- regions


def test_chosen_points_become_regions_that_measure_the_same_block(done, view, tmp_path):
    folder = shutil.copytree(done.folder, tmp_path / "project")
    numbers = [view.number[face.indices] for face in (view.gauge.upper, view.gauge.lower)]
    upper, lower = (
        outline_selected(folder, chosen, face) for chosen, face in zip(numbers, ("upper", "lower"), strict=True)
    )
    gauge = GaugeSpec(upper_polygon_px=upper, lower_polygon_px=lower)
    again = measure_gauge(folder, replace(done.project, rig=replace(done.project.rig, gauge=gauge)))
    assert again.thickness_mm == pytest.approx(view.gauge.thickness_mm, abs=again.U_mm)


def test_a_selection_of_another_scan_is_refused(done):
    with pytest.raises(InputError, match="replaced by another one"):
        outline_selected(done.folder, np.array([10**6], dtype=np.int32), "upper")


def test_exchanged_regions_are_told_apart(done, view, tmp_path):
    folder = shutil.copytree(done.folder, tmp_path / "project")
    upper, lower = view.outlines
    rig = replace(done.project.rig, gauge=GaugeSpec(upper_polygon_px=lower, lower_polygon_px=upper))
    with pytest.raises(InputError) as told:
        measure_gauge(folder, replace(done.project, rig=rig))
    assert told.value.where == region_field("upper")
    assert told.value.todo.code == "gauge.advice_exchange_faces"


def test_two_regions_over_one_face_are_refused(done, view, tmp_path):
    folder = shutil.copytree(done.folder, tmp_path / "project")
    _, lower = view.outlines
    rig = replace(done.project.rig, gauge=GaugeSpec(upper_polygon_px=lower, lower_polygon_px=lower + 1.0))
    with pytest.raises(InputError, match=r"upper_polygon_px: both regions hold one and the same face; draw"):
        measure_gauge(folder, replace(done.project, rig=rig))


def test_a_region_beside_the_part_is_refused(done, tmp_path):
    folder = shutil.copytree(done.folder, tmp_path / "project")
    corner = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 8.0]])
    rig = replace(done.project.rig, gauge=GaugeSpec(upper_polygon_px=corner, lower_polygon_px=corner))
    with pytest.raises(InputError, match=r"upper_polygon_px: .*draw it over a face"):
        measure_gauge(folder, replace(done.project, rig=rig))


def test_points_that_stand_for_themselves_are_outlined_though_they_are_no_whole_face(done, view):
    upper = np.sort(view.gauge.upper.indices)
    part = upper[view.uv[upper, 0] < np.median(view.uv[upper, 0])]
    outline = outline_selected(done.folder, view.number[part], "")
    low, high = view.uv[part].min(axis=0), view.uv[part].max(axis=0)
    assert 3 <= len(outline) <= 16
    assert np.all(outline >= low - 5) and np.all(outline <= high + 5)
    assert np.ptp(outline, axis=0) == pytest.approx(high - low, rel=0.2)


def test_the_next_best_pair_is_outlined_where_the_measured_one_is_not(done, tmp_path, view):
    upper, lower = (outline.tolist() for outline in view.outlines)
    shared = {"points": [9, 9], "upper_px": [0.0, 0.0], "lower_px": [0.0, 0.0]}
    pairs = [
        {"thickness_mm": 50.0, "outlines_px": [[[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]], lower], **shared},
        {"thickness_mm": 20.0, "outlines_px": [upper, lower], **shared},
    ]
    folder = copy_of(done.folder, tmp_path / "project")
    path = results_folder(folder) / "gauge.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"candidates": pairs}))
    pair = inspection_view(folder, done.project).next_pair
    assert pair.thickness_mm == 20.0 and np.array_equal(pair.outlines_px, [upper])
    on_face = view.points[view.face == UPPER]
    assert np.abs(pair.outlines[0][:, 2] - np.median(on_face[:, 2])).max() < 3.0
    assert view.next_pair is None
