"""A file of proofs has passed where a run of all of it has, on a tree without changes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

MARK = "@pytest.mark." + "accuracy"  # in two pieces, or this module were taken for one of proofs
ROOT = Path(__file__).parents[1]
FILES = {
    "pytest.ini": "[pytest]\nmarkers = accuracy\naddopts = -p no:cacheprovider\n",
    ".gitignore": "build\n__pycache__\n",
    "tests/__init__.py": "",
    "tests/changed.py": (ROOT / "tests/changed.py").read_text(encoding="utf-8"),
    "tests/rests_on.py": (ROOT / "tests/rests_on.py").read_text(encoding="utf-8"),
    "tests/passed_proofs.py": (ROOT / "tests/passed_proofs.py").read_text(encoding="utf-8"),
    "tests/time_left.py": (ROOT / "tests/time_left.py").read_text(encoding="utf-8") + "\nAT_LEAST = 0\n",
    "tests/test_good.py": f"import pytest\n{MARK}\ndef test_a():\n    pass\n{MARK}\ndef test_b():\n    pass\n"
    "def test_no_proof():\n    raise OSError\n",
    "tests/test_half.py": f"import pytest\n{MARK}\ndef test_a():\n    pass\n{MARK}\ndef test_b():\n    raise OSError\n",
    "tests/test_untried.py": f"import pytest\n{MARK}\ndef test_a():\n    pass\n"
    f"{MARK}\ndef test_b():\n    pytest.skip()\n",
    "tests/test_last.py": f"import pytest\n{MARK}\ndef test_a():\n    open('changed', 'w').close()\n",
    "tests/test_ended.py": f"import pytest\n{MARK}\ndef test_a():\n    pytest.exit('enough')\n",
}
GOOD, HALF, UNTRIED, LAST, ENDED = (f"tests/test_{name}.py" for name in ("good", "half", "untried", "last", "ended"))


@pytest.fixture(scope="module")
def committed(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("proofs")
    for name, text in FILES.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    git = ("git", "-c", "user.name=A", "-c", "user.email=a@b", "-C", str(folder))
    for words in (("init", "-q"), ("add", "."), ("commit", "-qm", "All")):
        subprocess.run((*git, *words), check=True)
    return folder


@pytest.fixture
def checkout(committed) -> Path:
    """A checkout in which nothing has been tried."""
    for path in (committed / "build" / "passed_proofs", committed / "changed"):
        path.unlink(missing_ok=True)
    return committed


def passed(checkout, *words, until="") -> set[str]:
    """Files that have passed by now, after one more run."""
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    command = (sys.executable, "-m", "pytest", "-q", "-p", "tests.time_left", "-p", "tests.passed_proofs", *words)
    subprocess.run(command, cwd=checkout, env=surroundings | {"TRISECT_TRY_UNTIL": until}, stdout=subprocess.DEVNULL)
    head = subprocess.check_output(("git", "-C", str(checkout), "rev-parse", "HEAD"), text=True).strip()
    record = checkout / "build" / "passed_proofs"
    lines = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
    assert all(line.endswith(f" {head}") for line in lines)
    return {line.split()[0] for line in lines}


def test_a_file_has_passed_where_each_of_its_proofs_has(checkout):
    assert passed(checkout, "-n", "2", "-m", "accuracy", GOOD, HALF, UNTRIED) == {GOOD}
    assert passed(checkout, "-m", "accuracy", GOOD, until="1") == set(), "one that has not now is forgotten"


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(("-m", "accuracy", f"{GOOD}::test_a"), id="one by name"),
        pytest.param(("-m", "accuracy", GOOD, LAST), id="the tree changes meanwhile"),
        pytest.param(("-m", "accuracy", GOOD, ENDED), id="ended before its end"),
    ],
)
def test_a_run_of_some_or_on_another_tree_proves_nothing(checkout, words):
    assert passed(checkout, *words) == set()
