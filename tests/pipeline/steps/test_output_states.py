"""Wherever a command is cut off, its folder is whole and results belong together."""

from functools import partial

import pytest

from tests.output_states import PLAN, Watched, commands, done


@pytest.mark.accuracy
def test_every_state_of_the_output_folder_is_whole_and_belongs_together(tiny_set, tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)
    watched = Watched(tmp_path / "out", tmp_path / "states")
    for name, words in commands(tiny_set, tmp_path / "out", tmp_path / "plan.toml").items():
        watched.do(name, partial(done, words))
    count, wrong = watched.judged()
    assert not wrong, "\n".join(wrong)
    assert count > 30
