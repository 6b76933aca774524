import subprocess
import sys

import pytest

from core.errors import InputError
from core.files.folder_lock import alone_in
from tests.simulated import contents, copy_of, trisect

HOLD = """
import sys, time
from pathlib import Path
from core.files.folder_lock import alone_in
from tests.simulated import contents, copy_of, trisect
with alone_in(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_a_second_program_is_told_and_a_killed_one_lets_go(tmp_path):
    with subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True) as other:
        try:
            assert other.stdout.readline() == "held\n"
            with pytest.raises(InputError, match="another run writes its results here; wait"), alone_in(tmp_path):
                pass
        finally:
            other.kill()
            other.wait()
    with alone_in(tmp_path):
        pass


def test_what_a_killed_program_left_is_swept_and_nothing_else(tmp_path):
    for name in (".gauge.json.0a1b2c3d.part", ".autosave.json", "gauge.json", ".x.part"):
        (tmp_path / name).touch()
    with alone_in(tmp_path):
        assert sorted(path.name for path in tmp_path.iterdir()) == [".autosave.json", ".x.part", "gauge.json"]


@pytest.mark.parametrize("step", ["camera", "planes", "scan", "gauge", "report", "inspect"])
def test_a_single_step_into_a_folder_that_another_program_writes_to_is_refused_in_one_sentence(
    step, simulated, measured, tmp_path
):
    out = copy_of(measured, tmp_path / "out")
    before = contents(out)
    (tmp_path / "plan.toml").write_text('[[feature]]\nname = "table"\nkind = "plane"\n')
    more = ("--plan", tmp_path / "plan.toml") if step == "inspect" else ()
    with alone_in(out):
        said = trisect(step, simulated, "--out", out, *more)
    assert said.code == 2
    assert "another run writes its results here; wait for its end" in said.sentence
    assert contents(out) == before
