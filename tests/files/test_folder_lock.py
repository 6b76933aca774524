import subprocess
import sys

import pytest

from core.errors import InputError
from core.files.folder_lock import alone_in

HOLD = """
import sys, time
from pathlib import Path
from core.files.folder_lock import alone_in
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
