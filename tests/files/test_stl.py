"""STL files of other programs, binary and as text."""

import numpy as np
import pytest
import trimesh

from core.files.stl import read_corners

BOX = trimesh.creation.box((20, 10, 8))


@pytest.mark.parametrize("kind", ["stl", "stl_ascii"])
def test_the_triangles_are_those_another_program_wrote(tmp_path, kind):
    path = tmp_path / "box.stl"
    BOX.export(path, file_type=kind)
    assert np.allclose(read_corners(path), BOX.triangles)


def test_a_binary_file_that_begins_like_text_is_read_as_binary(tmp_path):
    path = tmp_path / "solid.stl"
    data = BOX.export(file_type="stl")
    path.write_bytes(b"solid box".ljust(80) + data[80:])
    assert np.allclose(read_corners(path), BOX.triangles)


@pytest.mark.parametrize("text", ["vertex 1 2 x\n" * 3, "vertex 1 2 3\n" * 4])
def test_text_with_a_wrong_number_or_a_lost_corner_is_refused(tmp_path, text):
    path = tmp_path / "part.stl"
    path.write_text("solid part\n" + text)
    with pytest.raises(ValueError, match=r"x|corners"):
        read_corners(path)


def test_upper_case_and_indents_do_not_matter(tmp_path):
    path = tmp_path / "part.stl"
    path.write_text("SOLID part\n" + "\t VERTEX 1E0 2 -3\r\n" * 3)
    assert read_corners(path).tolist() == [[[1.0, 2.0, -3.0]] * 3]
