"""Proofs that would begin too late are told, not begun."""

import subprocess
import sys
import time

import pytest

from tests.code import ROOT
from tests.time_left import AT_LEAST

ONE = "def test_one():\n    pass\n"
MANY = f"import pytest\n@pytest.mark.parametrize('n', range({AT_LEAST + 5}))\ndef test_many(n):\n    pass\n"
WITHOUT = "import pytest\ndef test_lacks():\n    pytest.skip('no camera')\n"


def run(tmp_path, monkeypatch, text, left_s, *words):
    (tmp_path / "test_one.py").write_text(text)
    monkeypatch.setenv("TRISECT_TRY_UNTIL", "" if left_s is None else str(time.time() + left_s))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    command = [sys.executable, "-m", "pytest", "-p", "tests.time_left", "-rs", "-q", "-c", "/dev/null", *words]
    command.append(str(tmp_path))
    return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("words", [(), ("-n", "1")])
@pytest.mark.parametrize(
    ("text", "left_s", "said"),
    [
        (ONE, -1, "touched 1, passed 1, NOT TRIED 0"),
        (MANY, -1, f"touched {AT_LEAST + 5}, passed {AT_LEAST}, NOT TRIED 5"),
        (MANY, 600, f"touched {AT_LEAST + 5}, passed {AT_LEAST + 5}, NOT TRIED 0"),
        (ONE, None, "touched 1, passed 1, NOT TRIED 0"),
        (WITHOUT, -1, "touched 0, passed 0, NOT TRIED 0"),
    ],
)
def test_what_would_begin_too_late_is_left_out_and_said_but_the_first_are_tried(
    text, left_s, said, words, tmp_path, monkeypatch
):
    told = run(tmp_path, monkeypatch, text, left_s, *words)
    assert told.stdout.splitlines()[-1] == said and told.returncode == 0, told.stdout + told.stderr
    assert ("NOT TRIED for want of time" in told.stdout) == (said[-1] != "0")


def test_where_nothing_has_passed_that_there_was_to_try_it_is_no_success(tmp_path, monkeypatch):
    lacks_first = MANY.replace("pass", "pytest.skip('no camera')").replace(f"{AT_LEAST + 5}", f"{AT_LEAST}")
    told = run(tmp_path, monkeypatch, lacks_first + ONE, -1)
    assert told.stdout.splitlines()[-1] == "touched 1, passed 0, NOT TRIED 1", told.stdout + told.stderr
    assert told.returncode == 1
