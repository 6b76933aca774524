"""Modules are handed out by what they took: the longest first."""

import pytest

from tests import durations
from tests.changed import PROVEN
from tests.code import ROOT


def test_what_has_run_replaces_what_is_known_of_it_and_what_is_short_or_gone_has_no_line(tmp_path):
    file = tmp_path / "tests" / "durations.txt"
    file.parent.mkdir()
    for name in "abc":
        (file.parent / f"test_{name}.py").touch()
    assert durations.read(file) == {}
    durations.write({"tests/test_a.py": 30.2, "tests/test_b.py": 4.0, "tests/test_c.py": 0.3, "tests/no.py": 9.0}, file)
    assert file.read_text() == "30 tests/test_a.py\n4 tests/test_b.py\n"
    durations.write({"tests/test_b.py": 1.0, "tests/test_c.py": 50.0}, file)
    assert list(durations.read(file)) == ["tests/test_c.py", "tests/test_a.py"]


@pytest.mark.parametrize("count", [1, 3])
def test_parts_take_alike_and_have_each_module_once(count):
    took = {"a": 30.0, "b": 20.0, "c": 11.0, "d": 9.0}
    modules = [*took, *"efghij"]
    parts = [durations.part_of(modules, f"{number + 1}/{count}", took) for number in range(count)]
    assert sorted(one for part in parts for one in part) == sorted(modules)
    long = [sum(took.get(one, durations.USUAL_S) for one in part) for part in parts]
    assert max(long) == max(30.0, sum(long) / count), "the longest module alone is as long as the others together"


def test_every_module_that_has_a_line_is_there():
    """One that was moved would be taken for a short one, and handed out last; or for one that has never passed."""
    proven = [line.split()[0] for line in (ROOT / PROVEN).read_text(encoding="utf-8").splitlines()]
    named = [*durations.read(), *(name for name in proven if "/" in name)]
    assert [name for name in named if not (ROOT / name).is_file()] == []
