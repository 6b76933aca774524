"""A board whose corners were counted wrongly is told by the first pictures."""

import pickle

import pytest

from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.image.targets import checkerboard
from core.image.targets.target_view import OtherBoard
from core.pipeline.steps.camera_step import see_views
from tests.simulated import copy_of


@pytest.fixture
def searches(monkeypatch):
    """How often the board is looked for in every way, which takes long."""
    made = []
    search = checkerboard.thorough_search
    monkeypatch.setattr(checkerboard, "thorough_search", lambda *given: made.append(given) or search(*given))
    return made


@pytest.mark.parametrize("counted", [(18, 13), (16, 11), (18, 12)])
def test_the_first_pictures_tell_and_no_long_search_is_made(tiny_set, tmp_path, searches, counted):
    folder = copy_of(tiny_set, tmp_path / "set")
    rig = folder / "rig.toml"
    rig.write_text(rig.read_text().replace("[17, 12]", str(list(counted))))
    with pytest.raises(OtherBoard) as told:
        see_views(PictureReader(open_set(folder)))
    columns, rows = counted
    assert str(told.value).startswith(
        f"{folder / 'camera'}: in the first 3 pictures the board shows 17 × 12 inner corners, not {columns} × {rows}; "
    )
    assert "inner_corners" in str(told.value)
    assert pickle.loads(pickle.dumps(told.value)).counted == (17, 12)
    assert not searches


def test_the_right_count_is_found_in_each_picture_once(tiny_set, searches, monkeypatch):
    looked = []
    quick = checkerboard.quick_search
    monkeypatch.setattr(checkerboard, "quick_search", lambda full: looked.append(full) or quick(full))
    seen = see_views(PictureReader(open_set(tiny_set)))
    assert len(seen.found) == len(looked) == 6
    assert not searches
