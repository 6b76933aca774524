"""Wherever a command is cut off, its folder is whole and results belong together: `tests.output_states` in short."""

from functools import partial

import pytest

from tests.output_states import PLAN, Watched, commands, done

SHORT = ("run", "inspect", "camera", "run again", "another scan")


@pytest.mark.parametrize(
    "chosen", [pytest.param(SHORT, id="short"), pytest.param((), id="all", marks=pytest.mark.accuracy)]
)
def test_every_state_of_the_output_folder_is_whole_and_belongs_together(chosen, tiny_set, tmp_path):
    (tmp_path / "plan.toml").write_text(PLAN)
    watched = Watched(tmp_path / "out", tmp_path / "states")
    for name, words in commands(tiny_set, tmp_path / "out", tmp_path / "plan.toml").items():
        if not chosen or name in chosen:
            watched.do(name, partial(done, words))
    count, wrong = watched.judged()
    assert not wrong, "\n".join(wrong)
    assert count > 30
