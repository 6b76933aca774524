"""Several kinds handed over at once, of which some cannot be had."""

import pytest

from core.errors import InputError
from core.pipeline.project.export import export_results


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "mesh.ply").write_bytes(b"a mesh")
    (folder / "gauge.json").write_bytes(b"{}")
    return folder


def test_the_others_are_written_and_the_one_is_told(results, tmp_path):
    with pytest.raises(InputError) as told:
        export_results(results, ["cloud", "mesh", "json"], tmp_path / "to", in_camera_frame=True)
    assert {path.name for path in (tmp_path / "to").iterdir()} == {"mesh.ply", "gauge.json"}
    sentence = str(told.value)
    assert sentence.startswith("mesh.ply, gauge.json are written, but not cloud (")
    assert sentence.endswith("cloud.ply: is not there); do the step that makes it first.")


def test_one_alone_is_told_as_it_is_and_several_together(results, tmp_path):
    with pytest.raises(InputError, match=r"cloud\.ply: is not there; do the step that makes it first\.$"):
        export_results(results, ["cloud"], tmp_path / "to", in_camera_frame=True)
    with pytest.raises(InputError, match=r"^nothing could be written: cloud \(.*\), pdf \("):
        export_results(results, ["cloud", "pdf"], tmp_path / "to", in_camera_frame=True)
