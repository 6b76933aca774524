"""A proof is left out only where nothing that it rests on has changed since all were passed."""

import ast
import subprocess
from dataclasses import fields
from pathlib import Path

import pytest

from core.findings import of_proof
from core.findings.table import all_findings as finding_codes
from core.wing import Wing
from tests.changed import (
    PASSED,
    PROVEN,
    ROOT,
    below_workbench,
    changed_since,
    packing_changed,
    proofs_of,
    readers_of,
    reads_words,
    take_over,
    touched_on_second,
    touched_proofs,
    tree_to_prove,
)
from tests.rests_on import ASKED_FOR_BY, Tree

MARK = "@pytest.mark." + "accuracy"  # in two pieces, or this module were taken for one of proofs
FILES = {
    "core/__init__.py": "",
    "core/compiled.py": "",
    "core/loops.py": "from core.compiled import compiled\n",
    "core/deep.py": '"""Depth."""\nDEPTH = 1\n',
    "core/far.py": "def far():\n    from core import deep\n    return deep.DEPTH\n",
    "core/started.py": "",
    "core/cli/__init__.py": "",
    "core/cli/app.py": "NAME, JOB, OURS = 'core.started', 'core.named:function', 'core.wings'\n",
    "core/named.py": "",
    "core/findings/__init__.py": "",
    "core/findings/table.py": "OURS = 'core.wings'\n",
    "core/wings/__init__.py": "",
    "core/wings/rig/__init__.py": "",
    "core/wings/rig/wing.py": "WING = Wing(\n    commands='core.wings.rig.commands:commands',\n"
    "    findings='core.wings.rig.findings:ROWS',\n    other='core.wings.rig.other',\n)\n",
    "core/wings/rig/commands.py": "",
    "core/wings/rig/findings.py": "",
    "core/wings/rig/other.py": "",
    "core/wings/rig/unused.py": "",
    "workbench/__init__.py": "",
    "workbench/theme.py": "",
    "resources/style.qss": "QWidget {}\n",
    "constraints.txt": "numpy==2.4.6\n",
    "tests/__init__.py": "",
    "tests/conftest.py": "import pytest\n@pytest.fixture\ndef measured(small):\n    return made()\n"
    "@pytest.fixture\ndef small():\n    return 1\ndef made():\n    import core.cli.app\n",
    "tests/test_far.py": f"import pytest, core.far\n{MARK}\ndef test_far():\n    pass\n",
    "tests/test_run.py": f"import pytest\n{MARK}\ndef test_run(measured):\n    pass\n",
    "tests/test_seen.py": f"import pytest, workbench.theme\n{MARK}\ndef test_seen():\n    pass\n",
    "tests/test_told.py": f"import pytest, core.findings.table\n{MARK}\ndef test_told():\n    pass\n",
    "tests/test_quick.py": "import core.deep\n",
}
PROOFS = {"far", "run", "seen", "told"}


def git(folder, *words):
    subprocess.run(("git", "-c", "user.name=A", "-c", "user.email=a@b", "-C", str(folder), *words), check=True)


@pytest.fixture
def checkout(tmp_path) -> Path:
    """A checkout of which everything was proven."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    git(tmp_path, "init", "-q")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "All")
    commit = subprocess.check_output(("git", "-C", str(tmp_path), "rev-parse", "HEAD"), text=True)
    (tmp_path / PROVEN).parent.mkdir()
    (tmp_path / PROVEN).write_text(f"proofs {commit}packing {commit}", encoding="utf-8")
    return tmp_path


def run_again(checkout):
    return {path.stem.removeprefix("test_") for path in touched_proofs(checkout, proofs_of(checkout))}


def to_be_packed(checkout):
    return packing_changed(checkout, changed_since(checkout, proven(checkout).get("packing")))


def proven(checkout):
    lines = (checkout / PROVEN).read_text(encoding="utf-8").splitlines()
    return dict(line.split() for line in lines if " " in line)


def commit_all(checkout) -> str:
    git(checkout, "add", ".")
    git(checkout, "commit", "-qm", "More")
    return subprocess.check_output(("git", "-C", str(checkout), "rev-parse", "HEAD"), text=True).strip()


def add_to(checkout, path):
    with (checkout / path).open("a", encoding="utf-8") as file:
        file.write("assert True\n")


def test_where_nothing_has_changed_no_proof_is_run_again(checkout):
    assert {path.stem.removeprefix("test_") for path in proofs_of(checkout)} == PROOFS
    assert run_again(checkout) == set()
    assert not to_be_packed(checkout)


@pytest.mark.parametrize(
    ("path", "proofs"),
    [
        ("core/deep.py", {"far"}),
        ("core/__init__.py", {"far", "run", "told"}),
        ("core/cli/app.py", {"run"}),
        ("core/cli/__init__.py", {"run"}),
        ("core/started.py", {"run"}),
        ("core/named.py", {"run"}),
        ("core/wings/rig/wing.py", {"run", "told"}),
        ("core/wings/rig/commands.py", {"run"}),
        ("core/wings/rig/findings.py", {"told"}),
        ("core/wings/rig/other.py", {"run", "told"}),
        ("core/wings/rig/unused.py", set()),
        ("core/loops.py", set()),
        ("tests/conftest.py", PROOFS),
        ("tests/test_far.py", {"far"}),
        ("tests/test_quick.py", set()),
        ("resources/style.qss", {"seen"}),
        ("constraints.txt", PROOFS),
        ("README.md", set()),
        ("resources/other.dat", PROOFS),
        ("locks/dev.txt", set()),
    ],
)
def test_a_proof_is_run_again_when_something_that_it_imports_or_asks_for_has_changed(checkout, path, proofs):
    (checkout / path).parent.mkdir(exist_ok=True)
    add_to(checkout, path)
    assert run_again(checkout) == proofs


def test_a_fixture_is_followed_to_where_a_conftest_has_it_from_and_to_what_it_asks_for(checkout):
    write(checkout, "tests/near/conftest.py", "from tests.far_conftest import taken\n")
    write(
        checkout,
        "tests/far_conftest.py",
        "import pytest\n@pytest.fixture\ndef taken(measured):\n    import core.loops\n",
    )
    write(checkout, "tests/near/test_near.py", f"import pytest\n{MARK}\ndef test_near(taken):\n    pass\n")
    write(
        checkout,
        "tests/test_mine.py",
        f"from tests.far_conftest import taken\n{MARK}\ndef test_mine(taken):\n    pass\n",
    )
    write(checkout, PROVEN, f"proofs {commit_all(checkout)}\n")
    add_to(checkout, "core/loops.py")
    assert run_again(checkout) == {"near", "mine"}
    add_to(checkout, "core/cli/app.py")
    assert run_again(checkout) == {"near", "mine", "run"}
    add_to(checkout, "tests/far_conftest.py")
    assert run_again(checkout) == {"near", "mine", "run"}


def test_no_fixture_has_another_name_than_its_function_and_none_comes_as_a_plugin():
    """Neither is followed."""
    for path in (ROOT / "tests").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("fixture"):
                assert not {"name"} & {one.arg for one in node.keywords}, f"{path}:{node.lineno}"
            assert not (isinstance(node, ast.Name) and node.id == "pytest_" + "plugins"), f"{path}:{node.lineno}"


def test_a_module_that_is_gone_counts_as_changed_and_so_does_a_committed_change(checkout):
    (checkout / "core/deep.py").unlink()
    git(checkout, "commit", "-qam", "Gone")
    assert run_again(checkout) == {"far"}, "of the import the package is left, and the module is not there any more"


def test_comments_and_docstrings_are_no_change(checkout):
    (checkout / "core/deep.py").write_text('"""How deep."""\n\n# in floors\nDEPTH = 1\n', encoding="utf-8")
    assert run_again(checkout) == set()


def write(checkout, path, text):
    (checkout / path).parent.mkdir(exist_ok=True)
    (checkout / path).write_text(text, encoding="utf-8")


MANY = """from core.deep import DEPTH, OTHER
USED, UNUSED = 1, 2
ALONE = 3
def far():
    return inner() + DEPTH
def inner():
    return Held.value
def unused():
    return OTHER
class Held:
    value = 1
    def method(self):
        return late()
def late():
    import core.started as started
    return started.HERE
"""


@pytest.mark.parametrize(
    ("path", "before", "after", "proofs"),
    [
        ("core/far.py", "inner() +", "inner() -", {"far"}),
        ("core/far.py", "value = 1", "value = 2", {"far"}),
        ("core/far.py", "Held.value", "Held().value", {"far"}),
        ("core/far.py", "return OTHER", "return 1", set()),
        ("core/far.py", "ALONE = 3", "ALONE = 4", set()),
        ("core/far.py", "import DEPTH, OTHER", "import DEPTH", set()),
        ("core/far.py", "import DEPTH, OTHER", "import OTHER as DEPTH", {"far"}),
        ("core/deep.py", "DEPTH = 1", "DEPTH = 2", {"far"}),
        ("core/deep.py", "OTHER = 2", "OTHER = 3", set()),
        ("core/started.py", "HERE = 1", "HERE = 2", {"far", "run"}),
        ("core/started.py", "THERE = 1", "THERE = 2", {"run"}),
        ("core/started.py", "registered(HERE)", "registered(2)", {"far", "run"}),
    ],
)
def test_of_a_module_only_what_is_reached_counts(checkout, path, before, after, proofs):
    """A text that names a module reaches all of it."""
    write(
        checkout, "tests/test_far.py", f"import pytest\nfrom core.far import far\n{MARK}\ndef test_far():\n    far()\n"
    )
    write(checkout, "core/far.py", MANY)
    write(checkout, "core/deep.py", "DEPTH = 1\nOTHER = 2\n")
    write(checkout, "core/started.py", "HERE = 1\nTHERE = 1\nregistered(HERE)\n")
    commit = commit_all(checkout)
    write(checkout, PROVEN, f"proofs {commit}\n")
    assert run_again(checkout) == set()
    text = (checkout / path).read_text(encoding="utf-8")
    assert before in text
    write(checkout, path, text.replace(before, after))
    assert run_again(checkout) == proofs


@pytest.mark.parametrize(
    ("after", "proofs"), [("how deep: {n}", {"run"}), ("deep", {"far", "run"}), ("{n:.3f} deep", {"run"})]
)
def test_words_of_a_sentence_count_where_sentences_are_read(checkout, after, proofs):
    """Another place in it is more than words: a value would be missing."""
    write(checkout, "core/deep.py", "DEPTH = Message('a.b', '{n} deep', n=1)\n")
    write(checkout, "core/cli/app.py", "from core import deep\nSHOWN = deep.DEPTH\n")
    write(checkout, PROVEN, f"proofs {commit_all(checkout)}\n")
    write(checkout, "core/deep.py", f"DEPTH = Message('a.b', '{after}', n=1)\n")
    assert run_again(checkout) == proofs


def test_words_that_a_helper_of_tests_reads_count(checkout):
    write(checkout, "core/deep.py", "DEPTH = Message('a.b', '{n} deep', n=1)\n")
    write(checkout, "tests/helper.py", "from core import deep\ndef said():\n    return str(deep.DEPTH)\n")
    write(checkout, "tests/test_told.py", f"from tests.helper import said\n{MARK}\ndef test_told():\n    said()\n")
    write(checkout, PROVEN, f"proofs {commit_all(checkout)}\n")
    write(checkout, "core/deep.py", "DEPTH = Message('a.b', '{n} floors down', n=1)\n")
    assert run_again(checkout) == {"told"}


def test_a_proof_of_numbers_reads_no_words_although_it_tells_findings(proofs):
    """Each that measures reaches the table of findings, and so the wings: only what a wing shows counts."""
    reading = {path for path, rests_on in proofs.items() if reads_words(ROOT, rests_on)}
    assert Path("tests/accuracy/test_coverage.py") not in reading
    assert Path("tests/test_cli.py") in reading and Path("tests/report/test_report_pdf.py") in reading


def test_what_a_change_is_nearest_to_is_proven_first(checkout):
    add_to(checkout, "core/deep.py")
    add_to(checkout, "core/cli/app.py")
    add_to(checkout, "core/far.py")
    assert [path.stem for path in touched_proofs(checkout, proofs_of(checkout))] == ["test_far", "test_run"]


@pytest.mark.parametrize("text", ["", "proofs\n", "proofs {0}\npacking {0}\n".format("0123456789" * 4)])
def test_where_the_proven_commit_is_not_known_all_is_run(checkout, text):
    (checkout / PROVEN).write_text(text, encoding="utf-8")
    assert run_again(checkout) == PROOFS
    assert to_be_packed(checkout)


@pytest.mark.parametrize(
    ("path", "packed"),
    [("core/loops.py", True), ("constraints.txt", True), ("core/deep.py", False), ("tests/test_far.py", False)],
)
def test_what_is_packed_is_tried_again_when_loops_or_versions_have_changed(checkout, path, packed):
    add_to(checkout, path)
    assert to_be_packed(checkout) == packed


def test_a_file_of_proofs_that_has_passed_later_counts_from_then_on(checkout):
    add_to(checkout, "core/deep.py")
    add_to(checkout, "core/cli/app.py")
    later = commit_all(checkout)
    assert run_again(checkout) == {"far", "run"}
    with (checkout / PROVEN).open("a", encoding="utf-8") as file:
        file.write(f"tests/test_far.py {later}\n")
    assert run_again(checkout) == {"run"}
    add_to(checkout, "core/far.py")
    assert run_again(checkout) == {"far", "run"}, "what has changed since then is proven again"


def test_a_file_of_proofs_with_a_commit_that_is_not_known_is_run_again(checkout):
    with (checkout / PROVEN).open("a", encoding="utf-8") as file:
        file.write(f"tests/test_far.py {'0123456789' * 4}\n")
    assert run_again(checkout) == {"far"}


def test_only_a_tree_without_changes_proves_anything(checkout):
    assert tree_to_prove(checkout) == proven(checkout)["proofs"], "the file of what is proven may differ"
    add_to(checkout, "core/far.py")
    assert tree_to_prove(checkout) is None
    later = commit_all(checkout)
    assert tree_to_prove(checkout) == later
    (checkout / "core/new.py").touch()
    assert tree_to_prove(checkout) is None
    assert tree_to_prove(checkout.parent) is None, "nor does one that git does not know"


def note(checkout, **commits):
    (checkout / PASSED).parent.mkdir(exist_ok=True)
    (checkout / PASSED).write_text("".join(f"tests/test_{name}.py {one}\n" for name, one in commits.items()))


def test_what_has_passed_is_taken_over_once_each_with_its_line(checkout):
    before = proven(checkout)
    note(checkout, far="a" * 40, seen="b" * 40, gone="c" * 40)
    assert take_over(checkout) == ["tests/test_far.py", "tests/test_seen.py"]
    assert proven(checkout) == before | {"tests/test_far.py": "a" * 40, "tests/test_seen.py": "b" * 40}
    assert take_over(checkout) == []
    note(checkout, far="d" * 40)
    take_over(checkout)
    assert proven(checkout)["tests/test_far.py"] == "d" * 40
    assert proven(checkout)["tests/test_seen.py"] == "b" * 40


def test_where_all_have_passed_at_one_commit_one_line_says_so(checkout):
    note(checkout, far="a" * 40)
    take_over(checkout)
    before = proven(checkout)
    note(checkout, **dict.fromkeys(PROOFS, "b" * 40))
    take_over(checkout)
    assert proven(checkout) == {"proofs": "b" * 40, "packing": before["packing"]}


def on_second(checkout):
    touched = touched_on_second(checkout, below_workbench(checkout))
    return {path.stem.removeprefix("test_") for path in touched}


def test_a_second_python_runs_what_names_a_changed_module_since_all_passed_there(checkout):
    assert on_second(checkout) == PROOFS | {"quick"}, "never all yet"
    with (checkout / PROVEN).open("a", encoding="utf-8") as file:
        file.write(f"second {commit_all(checkout)}\n")
    assert on_second(checkout) == set()
    add_to(checkout, "core/deep.py")
    assert on_second(checkout) == {"quick"}, "it names the module; the other reaches it by way of one"
    add_to(checkout, "core/far.py")
    assert on_second(checkout) == {"far", "quick"}, "whether proofs or not"
    note(checkout, **dict.fromkeys(PROOFS, "b" * 40))
    take_over(checkout)
    assert on_second(checkout) == {"far", "quick"}, "proofs on the first say nothing of it"


@pytest.mark.parametrize(
    ("path", "files"),
    [
        ("constraints.txt", {*PROOFS, "quick"}),
        ("pyproject.toml", {*PROOFS, "quick"}),
        ("resources/other.dat", {*PROOFS, "quick"}),
        ("tests/conftest.py", {*PROOFS, "quick"}),
        ("tests/helper.py", {"run"}),
        ("core/behind.py", {"seen"}),
        ("core/cli/app.py", {"run"}),
        ("core/wings/rig/commands.py", {"run"}),
        ("core/wings/rig/findings.py", {"told"}),
        ("core/deep.py", {"quick"}),
        ("core/loops.py", set()),
        ("resources/style.qss", {"seen"}),
    ],
)
def test_a_second_python_tries_every_change_that_a_test_reaches(checkout, path, files):
    """By fixtures, by a name that a package hands on, and what no test names by those that reach it soonest."""
    conftest = (checkout / "tests/conftest.py").read_text(encoding="utf-8")
    write(
        checkout,
        "tests/conftest.py",
        conftest.replace("return 1", "return helper.SMALL") + "import tests.helper as helper\n",
    )
    write(checkout, "tests/helper.py", "SMALL = 1\n")
    write(checkout, "core/behind.py", "class Behind:\n    pass\n")
    write(checkout, "core/packed.py", "from core.behind import Behind\n")
    write(
        checkout,
        "tests/test_seen.py",
        f"import pytest, workbench.theme\nfrom core.packed import Behind\n{MARK}\ndef test_seen():\n    pass\n",
    )
    write(checkout, PROVEN, f"second {commit_all(checkout)}\n")
    assert on_second(checkout) == set()
    add_to(checkout, path)
    if path == "tests/helper.py":
        write(checkout, path, "SMALL = 2\n")
    assert on_second(checkout) == files


def test_on_a_second_python_the_nearest_come_first_also_where_all_are_touched(checkout):
    write(checkout, PROVEN, f"second {commit_all(checkout)}\n")
    for path in ("constraints.txt", "core/far.py", "core/cli/app.py"):
        add_to(checkout, path)
    found = [path.stem for path in touched_on_second(checkout, below_workbench(checkout))]
    assert {*found[:2]} == {"test_far", "test_run"} and len(found) == 5


def test_windows_are_not_tried_on_a_second_python():
    files = {path.as_posix() for path in below_workbench()}
    assert "tests/test_changed.py" in files and not any(name.startswith("tests/workbench/") for name in files)
    assert len(files) > 200


@pytest.fixture(scope="module")
def tree(syntax_trees) -> Tree:
    """All that this project defines."""
    return Tree(ROOT)


@pytest.fixture(scope="module")
def proofs(tree) -> dict[Path, set[str]]:
    """Those of this project, each with what it rests on."""
    return {path: tree.proof(path) for path in proofs_of()}


def test_no_proof_of_this_project_is_overlooked(proofs):
    assert len(proofs) > 100
    assert all({"tests.conftest", "core"} <= rests_on for rests_on in proofs.values())


def test_what_a_wing_names_is_rested_on_by_way_of_what_asks_for_it(tree, proofs):
    """A change of a command or a drawing would touch nearly every proof, as each tells findings."""
    rests_on = tree.closure(["core.findings.table"])
    assert not {name for name in rests_on if name.startswith("core.cli")}
    assert "core.wings.studies.findings" in rests_on and len({name.partition(":")[0] for name in rests_on}) < 50
    assert len({name.partition(":")[0] for name in proofs[Path("tests/accuracy/test_coverage.py")]}) < 400
    commands = {f"core.wings.{wing}.commands" for wing in ("audit", "geometry", "studies", "rig_planning")}
    assert commands <= tree.closure(["core.cli.app"])
    assert "core.wings.studies.printed" in tree.closure(["core.pipeline.steps.brought_sections"])


def test_each_finding_is_rested_on_by_who_names_its_code(tree, proofs):
    """A row that nobody reached would be left out of every proof: tables of findings change often, most rows never."""
    codes = set(finding_codes()) - {row.code for row in of_proof.ROWS}  # of these the codes are put together
    reached = {name for name in tree.closure(["core.cli.app", "workbench.app"]) if name.partition(":")[2] in codes}
    assert len(reached) == len(codes) > 100
    of_boards = {name.partition(":")[2] for name in proofs[Path("tests/image/targets/test_checkerboard.py")]}
    assert not of_boards & {code for code in codes if code.startswith("scan.")}


def test_who_reaches_a_definition_is_who_rests_on_it(tree, proofs):
    for one in ("core.scan.standstill:SCORE_LIMIT", "core.image.targets.corners"):
        found = tree.who_reach([one], proofs)[one]
        assert found == [path for path, rests_on in proofs.items() if one in rests_on] != []


def test_a_proof_of_pictures_rests_on_little_of_the_program(tree, proofs):
    """Where it imports a module, it does not rest on all that this has for others."""
    program = {name for name in tree.closure(["core.cli.app"]) if name.startswith("core.")}
    of_boards = {name for name in proofs[Path("tests/image/targets/test_checkerboard.py")] if name.startswith("core.")}
    assert "core.image.targets.checkerboard" in of_boards
    assert len(of_boards) < len(program) / 8


def test_who_asks_for_what_a_wing_names_is_known():
    """Each field with a place, and a module that reads it: what asked in vain would be left out of every proof."""
    assert {name for names in ASKED_FOR_BY.values() for name in names} == {
        field.name for field in fields(Wing) if field.name not in ("name", "after")
    }
    for module, names in ASKED_FOR_BY.items():
        text = (ROOT / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8")
        assert all(f"wing.{name}" in text for name in names)


def test_files_that_no_proof_reads_touch_no_module():
    """An empty name would be one that every module with an empty text in it names."""
    assert readers_of({".ci/proven", "locks/dev.txt", "resources/manual/check.md", "README.md"}) == set()


def test_no_proof_of_numbers_rests_on_the_window(proofs):
    """The program's name stands in many texts, and is that of the package for scripts, whose start knows the window."""
    found = {path.as_posix() for path, rests_on in proofs.items() if "workbench.app" in rests_on}
    assert found and not {
        path for path in found if path.startswith(("tests/accuracy", "tests/calibrate", "tests/scan"))
    }
