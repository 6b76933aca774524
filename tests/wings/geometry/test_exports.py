"""What of a comparison is handed over: in the frame of the part, or refused in one sentence."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.files.results.export_list import exports
from core.files.results.ply_format import parse_ply
from core.pipeline.project.export import export_results
from core.pipeline.steps.export_kinds import frame_of
from core.wing import OUR_EXPORTS
from core.wings.geometry.comparison.compare_step import compare_step
from core.wings.geometry.comparison.comparison_file import write_comparison_csv_in, write_comparison_ply_in
from core.wings.geometry.exports import ROWS
from tests.simulated import copy_of


@pytest.fixture
def results(measured, tmp_path):
    return copy_of(measured, tmp_path / "results")


def test_the_house_knows_the_names_of_its_kinds_and_offers_them_behind_the_geometry():
    names = [row.kind.name for row in ROWS]
    assert [name for name, wing in OUR_EXPORTS.items() if wing == "geometry"] == names
    offered = list(exports())
    place = offered.index("dxf") + 1
    assert offered[place : place + len(names)] == names


def test_a_comparison_is_turned_with_the_part(results, tmp_path):
    compare_step(results, results / "mesh.ply", to=results)
    paths = export_results(results, ["compared", "compared-csv"], tmp_path / "to")
    frame = frame_of(results, in_camera_frame=False)
    ours, turned = (parse_ply(path.read_bytes()) for path in (results / "comparison.ply", paths["compared"]))
    for names, move in ((("x", "y", "z"), frame.coordinates), (("nx", "ny", "nz"), frame.directions)):
        before, after = (
            np.column_stack([one.elements["vertex"][name] for name in names]).astype(float) for one in (ours, turned)
        )
        assert np.allclose(after, move(before), atol=1e-4)
    assert np.array_equal(turned.elements["vertex"]["deviation"], ours.elements["vertex"]["deviation"])
    assert [line for line in turned.comments if "frame of reference" in line] == [
        "frame of reference: the part, z up from its lower face, x along the camera's"
    ]
    table = np.genfromtxt(paths["compared-csv"], delimiter=",", names=True)
    assert table.dtype.names[:3] == ("x_face_mm", "y_face_mm", "height_over_face_mm")
    assert np.allclose(table["height_over_face_mm"], turned.elements["vertex"]["z"], atol=1e-4)


@pytest.mark.parametrize("content", [b"", b"x_mm\n1\n", b"a,b\nnot,numbers\n"])
def test_a_damaged_table_of_a_comparison_is_told(tmp_path, results, content):
    (tmp_path / "comparison").write_bytes(content)
    frame = frame_of(results, in_camera_frame=False)
    for write in (write_comparison_csv_in, write_comparison_ply_in):
        with pytest.raises(InputError, match="this is no table of a comparison"):
            write(tmp_path / "out", tmp_path / "comparison", frame)
    assert not (tmp_path / "out").exists()
