"""What has changed since it was proven: `python -m tests.changed` with `proofs`, `second`, `packing` or `passed`.

`.ci/proven` names the commits at which all of `make proofs` passed, at which every test below the workbench passed on a
second Python, and at which wheel and bundle were tried; a file of proofs that has passed since has a line of its own. A
proof is left out where nothing that it rests on has changed since: what its own module, and the fixtures that it asks
for, reach of all other modules, definition by definition (`tests/rests_on.py`). Comments and docstrings do not count,
nor do the words of a sentence for proofs that read none. Files that are no modules count by `READ_BY`.

`proofs` prints the files to run on standard output, and lists on standard error those that are left out; so does
`second` for the tests that a second Python has to pass, all of which `make test` runs on the first. There a change is
tried by the tests that have changed, name its module, ask for a fixture that names it, or else reach it soonest: what a
Python does otherwise, it does there.
`packing` prints "changed" where a wheel or a bundle could come out otherwise, else nothing.
`passed` writes into `.ci/proven` what has passed here since (`tests/passed_proofs.py`), and prints how much that is.
"""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from tests.rests_on import Tree, differing, module_name

ROOT = Path(__file__).parents[1]
PROVEN = Path(".ci/proven")
PASSED = Path("build/passed_proofs")
"""Files of proofs that have passed in this checkout, each with its commit, in the form of `PROVEN`."""
READ_BY = {
    "constraints": "tests.conftest",
    "pyproject.toml": "tests.conftest",
    "resources/sample/": "core.simulate.sample",
    "resources/script/": "core.pipeline.project.script",
    "resources/style.qss": "workbench.theme",
    "resources/icons/": "workbench.theme",
    "resources/translations/": "workbench.language",
    **dict.fromkeys(
        ("resources/manual/", "resources/pictures/", "bundle/", "locks/", ".ci/", ".github/", "NOTICE"), ""
    ),
}
"""Files that are no modules, by how their paths begin, each with the module whose readers depend on them.

Versions of libraries count for every proof; translations where windows are proven: no number depends on a text; what no
proof reads has no module.
"""
READERS_OF_WORDS = ("core.cli", "core.report", "core.wings.audit.commands", "workbench")
"""Modules that show sentences: a proof that rests on one of them may read some."""
SIGNS_OF_WORDS = ("match=", "str(", ".text", "catalogue")
"""What stands in a module of tests that may read sentences by itself."""
PACKED_BY = (
    "pyproject.toml", "constraints", "locks/", "bundle/", ".ci/bare_root", ".ci/matrix", "hatch_build.py", "trisect/",
    "resources/desktop/", "core/processes.py", "core/sources.py", "core/code_cache.py", "core/second_process.py",
    "core/pipeline/compile_ahead.py", "core/pipeline/executors.py", "workbench/app.py", "workbench/views/scene/",
)  # fmt: skip
"""How the paths of files begin that decide what is packed and how it is tried, beside the compiled loops."""


def _git(root: Path, *words: str) -> str:
    return subprocess.run(("git", "-C", str(root), *words), capture_output=True, text=True, check=True).stdout


def _commits(path: Path) -> dict[str, str]:
    """What stands in a file of lines "NAME COMMIT"; nothing where it cannot be read."""
    try:
        return dict(line.split() for line in path.read_text(encoding="utf-8").splitlines())
    except (OSError, ValueError):
        return {}


def _write_commits(path: Path, commits: dict[str, str]) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_text("".join(f"{name} {commit}\n" for name, commit in commits.items()), encoding="utf-8")


def changed_since(root: Path, commit: str | None) -> set[str] | None:
    """Paths that differ from a commit in more than comments; None where the commit is not known."""
    try:
        paths = _git(root, "diff", "--name-only", "--no-renames", commit or "").split("\n")
    except (OSError, subprocess.CalledProcessError):
        return None
    paths += _git(root, "ls-files", "--others", "--exclude-standard").split("\n")
    return {path for path in paths if path and _differing(root, commit or "", path) != set()}


def changed_definitions(root: Path, commit: str | None, words: bool = True) -> set[str] | None:
    """Definitions that differ from a commit, and modules that have changed as a whole or read a file that has.

    Without `words` a sentence for people is the same whatever its words are. None where the commit is not known.
    """
    if (paths := changed_since(root, commit)) is None:
        return None
    found = readers_of(paths)
    for path in paths:
        if path.endswith(".py"):
            module = module_name(Path(path))
            names = _differing(root, commit or "", path, words)
            found |= {module} if names is None else {f"{module}:{name}" if name else module for name in names}
    return found


@cache
def _differing(root: Path, commit: str, path: str, words: bool = True) -> set[str] | None:
    """Names of a module whose definitions differ from a commit, "" for what runs with its import; None: anything."""
    if not path.endswith(".py"):
        return None
    file, before = root / path, _texts_at(root, commit).get(path)
    now = file.read_text(encoding="utf-8") if file.exists() else None
    try:
        return differing(before or "", now or "", words) | {"" for one in (before, now) if one is None}
    except SyntaxError:
        return None


@cache
def _texts_at(root: Path, commit: str) -> dict[str, str]:
    """Modules at a commit that differ from those of the checkout, with their texts."""
    paths = _git(root, "diff", "--name-only", "--no-renames", "--diff-filter=MD", commit, "--", "*.py").split()
    command = ("git", "-C", str(root), "cat-file", "--batch")
    asked = "".join(f"{commit}:{path}\n" for path in paths).encode()
    given = subprocess.run(command, input=asked, capture_output=True, check=True).stdout
    texts, at = {}, 0
    for path in paths:
        head, _, _ = given[at:].partition(b"\n")
        start = at + len(head) + 1
        at = start + int(head.split()[-1]) + 1
        texts[path] = given[start : at - 1].decode()
    return texts


def readers_of(paths: Iterable[str]) -> set[str]:
    """Modules that stand for the readers of files that are no modules; what no proof reads has none."""
    files = [path for path in paths if not path.endswith((".py", ".md"))]
    readers = (
        next((one for start, one in READ_BY.items() if path.startswith(start)), "tests.conftest") for path in files
    )
    return {*readers} - {""}


def touched_proofs(root: Path, proofs: Iterable[Path]) -> list[Path]:
    """Those of the files of proofs that rest on something that has changed since they passed, or may have.

    Those that a change is nearest to come first: what reaches least besides it is likeliest to notice, and soonest.
    """
    proven = _commits(root / PROVEN)
    since = {path: proven.get(path.as_posix(), proven.get("proofs")) for path in proofs}
    changed = {
        (one, words): changed_definitions(root, one, words) for one in {*since.values()} for words in (True, False)
    }
    tree = Tree(root, set().union(*filter(None, changed.values())))
    touched: dict[Path, float] = {}
    for path, commit in since.items():
        rests_on = tree.proof(path)
        differs = changed[commit, reads_words(root, rests_on)]
        hit = rests_on if differs is None else rests_on & differs
        if hit:
            touched[path] = len(rests_on) / len(hit)
    return sorted(touched, key=lambda path: (touched[path], path))


def touched_on_second(root: Path, tests: Iterable[Path]) -> list[Path]:
    """Files of tests that try what has changed since all of them passed on a second Python.

    These have changed themselves, name a module that has, or ask for a fixture that names what has; what no file names
    in this way is tried by those that reach it soonest. Those that a change is nearest to come first: what all
    rest on makes none of them nearer.
    """
    files = [*tests]
    changed = changed_definitions(root, _commits(root / PROVEN).get("second"))
    if changed is None:
        return files
    tree = Tree(root, changed)
    named = {path: tree.named_by(path) for path in files}
    by_fixtures = {path: tree.handed_to(tree.begins_with(path)) for path in files}
    modules = {one.partition(":")[0] for one in changed}
    touched = {path: modules & named[path] | changed & by_fixtures[path] for path in files}
    of_all = set.intersection(*touched.values()) if touched else set()
    of_none = modules - set().union(*named.values())
    left = {one for one in changed - set().union(*by_fixtures.values()) if one.partition(":")[0] in of_none}
    for one, nearest in (tree.nearest(left, files) if left else {}).items():
        for path in nearest:
            touched[path].add(one)
    return sorted(
        (path for path in files if touched[path]),
        key=lambda path: (touched[path] <= of_all, len(named[path]) / len(touched[path]), path),
    )


def reads_words(root: Path, rests_on: set[str]) -> bool:
    """Whether a file of proofs may read sentences: of a command, a report, a window, an error, also by a helper."""
    modules = {one.partition(":")[0] for one in rests_on}
    return any(one.startswith(READERS_OF_WORDS) or _has_signs(root, one) for one in modules)


@cache
def _has_signs(root: Path, module: str) -> bool:
    path = root / (module.replace(".", "/") + ".py")
    if not module.startswith("tests.") or not path.exists():
        return False
    text = path.read_text(encoding="utf-8")
    return any(sign in text for sign in SIGNS_OF_WORDS)


def tree_to_prove(root: Path) -> str | None:
    """The commit that is checked out; None where a file differs from it, but for `PROVEN`."""
    try:
        differing = _git(root, "status", "--porcelain", "--", ".", f":!{PROVEN.as_posix()}")
        return None if differing else _git(root, "rev-parse", "HEAD").strip()
    except (OSError, subprocess.CalledProcessError):
        return None


def note_passed(root: Path, commit: str, files: dict[str, bool]) -> None:
    """Keep which files of proofs have passed at a commit, for `take_over`; one that has not is forgotten."""
    noted = {name: before for name, before in _commits(root / PASSED).items() if name not in files}
    _write_commits(root / PASSED, noted | {name: commit for name, passed in files.items() if passed})


def take_over(root: Path) -> list[str]:
    """Write into `PROVEN` the files of proofs that have passed, which are returned: one line where all have."""
    proven, passed = _commits(root / PROVEN), _commits(root / PASSED)
    names = {path.as_posix() for path in proofs_of(root)}
    passed = {name: commit for name, commit in sorted(passed.items()) if name in names}
    commits = {passed.get(name, "") for name in names}
    others = {name: one for name, one in proven.items() if "/" not in name}
    if len(commits) == 1 and "" not in commits:
        proven = {"proofs": commits.pop(), **{name: one for name, one in others.items() if name != "proofs"}}
    else:
        proven = others | {name: one for name, one in proven.items() if name in names} | passed
    _write_commits(root / PROVEN, proven)
    (root / PASSED).unlink(missing_ok=True)
    return list(passed)


def _is_compiled(path: Path) -> bool:
    """Whether a file has compiled loops, or makes them."""
    if path.suffix != ".py" or not path.exists():
        return False
    return path.name == "compiled.py" or b"from core.compiled import" in path.read_bytes()


def packing_changed(root: Path, changed: set[str] | None) -> bool:
    """Whether a wheel or a bundle could come out otherwise."""
    if changed is None:
        return True
    return any(path.startswith(PACKED_BY) or _is_compiled(root / path) for path in changed)


def proofs_of(root: Path = ROOT) -> list[Path]:
    """Every file with proofs."""
    return [path for path in files_of_tests(root) if "mark.accuracy" in (root / path).read_text(encoding="utf-8")]


def below_workbench(root: Path = ROOT) -> list[Path]:
    """Every file of tests but those of windows."""
    return [path for path in files_of_tests(root) if path.parts[1] != "workbench"]


def files_of_tests(root: Path) -> list[Path]:
    """Every file of tests, as paths within the checkout."""
    return [path.relative_to(root) for path in sorted((root / "tests").rglob("test_*.py"))]


def main() -> None:
    gc.disable()  # nothing of a syntax tree is garbage, and to look for it takes longer than to parse
    if sys.argv[1:] == ["packing"]:
        print("changed" * packing_changed(ROOT, changed_since(ROOT, _commits(ROOT / PROVEN).get("packing"))))
        return
    if sys.argv[1:] == ["passed"]:
        passed = take_over(ROOT)
        print(f"{len(passed)} files of proofs are taken over into {PROVEN}:", *passed, sep="\n  ")
        return
    second = sys.argv[1:] == ["second"]
    files = below_workbench() if second else proofs_of()
    run = touched_on_second(ROOT, files) if second else touched_proofs(ROOT, files)
    left_out = [path.as_posix() for path in files if path not in run]
    if left_out:
        kind, they = ("tests on a second Python", "try") if second else ("proofs", "rest on")
        sys.stderr.write(f"{len(left_out)} of {len(files)} files of {kind} left out, for nothing that they {they} ")
        sys.stderr.write("has changed since they passed (.ci/proven):\n" + "".join(f"  {one}\n" for one in left_out))
    print(*(path.as_posix() for path in run))


if __name__ == "__main__":
    main()
