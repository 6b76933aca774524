"""Pictures with the fan on and off under each other's names."""

import pytest

from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.image.stripes.exchanged import EXCHANGED
from core.pipeline.steps.planes_step import measure_poses
from core.simulate.rig import paper_rig
from tests.simulated import TINY, copy_of

CAMERA = paper_rig(scale=TINY.scale).camera


def exchanged(folder, to, names):
    folder = copy_of(folder, to)
    for name in names:
        on, off = folder / "planes" / f"{name}.png", folder / "planes" / f"{name}_off.png"
        kept = on.read_bytes()
        on.write_bytes(off.read_bytes())
        off.write_bytes(kept)
    return open_set(folder)


def test_where_all_are_exchanged_that_is_said_and_no_pose_is_blamed(tiny_set, tmp_path):
    found = exchanged(tiny_set, tmp_path / "set", [f"pose{k:02d}" for k in range(4)])
    with pytest.raises(InputError) as told:
        measure_poses(PictureReader(found), CAMERA)
    assert str(told.value) == (
        f"{found.folders['planes']}: {EXCHANGED}; give each NAME its NAME_off's name, and the other way round."
    )


def test_one_exchanged_pose_is_left_out_for_that_reason(tiny_set, tmp_path):
    found = exchanged(tiny_set, tmp_path / "set", ["pose02"])
    assert [pose.reason for pose in measure_poses(PictureReader(found), CAMERA)] == [None, None, EXCHANGED, None]
