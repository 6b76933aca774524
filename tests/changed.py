"""What has changed since it was proven: `python -m tests.changed` with `proofs`, `second`, `packing` or `passed`.

`.ci/proven` names the commits at which all of `make proofs` passed, at which every test below the workbench passed on a
second Python, and at which wheel and bundle were tried; a file of proofs that has passed since has a line of its own. A
proof is left out where nothing that it rests on has
changed since: its own module, those it imports, however deep, the fixtures it asks for and what these import. Comments
and docstrings do not count. Files that are no modules count by `READ_BY`.

`proofs` prints the files to run on standard output, and lists on standard error those that are left out; so does
`second` for the tests that a second Python has to pass, all of which `make test` runs on the first.
`packing` prints "changed" where a wheel or a bundle could come out otherwise, else nothing.
`passed` writes into `.ci/proven` what has passed here since (`tests/passed_proofs.py`), and prints how much that is.
"""

from __future__ import annotations

import ast
import gc
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROVEN = Path(".ci/proven")
PASSED = Path("build/passed_proofs")
"""Files of proofs that have passed in this checkout, each with its commit, in the form of `PROVEN`."""
PROGRAM = "trisect"
"""In a text it is the program's name, or a folder's; scripts import the package."""
PACKAGES = ("core", "workbench", "trisect", "resources", "tests")

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
ASKED_FOR_BY = {
    "core.cli.app": ("commands",),
    "core.files.results.export_list": ("exports",),
    "core.findings.table": ("findings",),
    "core.inspect.plan.kinds": ("feature_kinds",),
    "core.pipeline.steps.brought_sections": ("sections", "reads_study"),
}
"""Modules that import what a `core.wing.Wing` names, each with the fields it asks for: nothing else rests on that."""
PACKED_BY = (
    "pyproject.toml", "constraints", "locks/", "bundle/", ".ci/bare_root", ".ci/matrix", "hatch_build.py", "trisect/",
    "resources/desktop/", "core/processes.py", "core/sources.py", "core/code_cache.py", "core/second_process.py",
    "core/pipeline/compile_ahead.py", "core/pipeline/executors.py", "workbench/app.py", "workbench/views/scene/",
)  # fmt: skip
"""How the paths of files begin that decide what is packed and how it is tried, beside the compiled loops."""


class Tree:
    """The modules of a checkout, and what each imports of the others and of those that are `gone`."""

    def __init__(self, root: Path, gone: Iterable[str] = ()) -> None:
        self.root = root
        self.files = {
            _module_name(path.relative_to(root)): path for name in PACKAGES for path in (root / name).rglob("*.py")
        }
        self._names = {*self.files, *gone}
        self._named = cache(self._named_in_module)

    def names_in(self, name: str) -> set[str]:
        """Modules of ours that a module names itself."""
        return self._named(name)

    def closure(self, names: Iterable[str]) -> set[str]:
        """Modules that are imported when the modules of these names are, themselves among them."""
        found: set[str] = set()
        waiting = set(names)
        while waiting:
            name = waiting.pop()
            found.add(name)
            packages = {name.rsplit(".", depth)[0] for depth in range(1, name.count(".") + 1)}
            waiting |= ((self._named(name) | self._brought(name) | packages) & self._names) - found
        return found

    def proof(self, path: Path) -> set[str]:
        """Modules that a file of proofs rests on: what it imports, and what the fixtures it asks for import."""
        own = _module_name(path)
        asked = _asked_for(ast.walk(_parsed(self.root / path)))
        found = self.closure([own])
        for folder in path.parents:
            conftest = _module_name(folder / "conftest.py")
            if conftest in self.files:
                found |= self.closure(self._named_by_fixtures(conftest, asked)) | {conftest}
        return found

    def _brought(self, name: str) -> set[str]:
        """Modules that a module imports by way of wings: their own where it is a folder of them, or what it asks for.

        See `core.door.by_folders` and `ASKED_FOR_BY`.
        """
        if name.endswith(".wings"):
            return self._wings(name)
        return {
            named
            for field in ASKED_FOR_BY.get(name, ())
            for wing in self._wings("core.wings")
            for node in self._given_to_wing(wing, field)
            for named in self._named_in(ast.walk(node), wing)
        }

    def _wings(self, folder: str) -> set[str]:
        return {one for one in self.files if one.startswith(f"{folder}.") and one.endswith(".wing")}

    def _given_to_wing(self, module: str, *fields: str) -> list[ast.keyword]:
        """Arguments of these fields in the calls of `Wing` in a module."""
        nodes = ast.walk(_parsed(self.files[module]))
        calls = [node for node in nodes if isinstance(node, ast.Call) and ast.unparse(node.func) == "Wing"]
        return [given for call in calls for given in call.keywords if given.arg in fields]

    def _named_in_module(self, name: str) -> set[str]:
        if (path := self.files.get(name)) is None:
            return set()
        nodes = list(ast.walk(_parsed(path)))
        if name in self._wings("core.wings"):
            asked_for = (field for fields in ASKED_FOR_BY.values() for field in fields)
            given = self._given_to_wing(name, *asked_for)
            left_out = {id(node) for one in given for node in ast.walk(one)}
            nodes = [node for node in nodes if id(node) not in left_out]
        return self._named_in(nodes, name)

    def _named_by_fixtures(self, conftest: str, asked: set[str]) -> set[str]:
        """Modules named in a conftest outside functions, and in those functions that the tests or pytest itself call.

        `asked` is extended by the fixtures that these ask for in turn.
        """
        functions, waiting = {}, []
        for node in _parsed(self.files[conftest]).body:
            if isinstance(node, ast.FunctionDef):
                functions[node.name] = node
                by_pytest = node.name.startswith("pytest_") or "autouse=True" in map(ast.unparse, _keywords(node))
                if by_pytest or node.name in asked:
                    waiting.append(node.name)
        outside = [node for node in _parsed(self.files[conftest]).body if not isinstance(node, ast.FunctionDef)]
        named = self._named_in((one for node in outside for one in ast.walk(node)), conftest)
        while waiting:
            function = functions.pop(waiting.pop(), None)
            if function is None:
                continue
            nodes = list(ast.walk(function))
            named |= self._named_in(nodes, conftest)
            asked |= _asked_for(nodes)
            waiting += [node.id for node in nodes if isinstance(node, ast.Name)] + list(asked & functions.keys())
        return named

    def _named_in(self, nodes: Iterable[ast.AST], module: str) -> set[str]:
        """Modules of ours that are imported, or named in a text, also as "module:function": what is started by name."""
        named: set[str] = set()
        for node in nodes:
            if isinstance(node, ast.Import):
                named |= {one.name for one in node.names}
            elif isinstance(node, ast.ImportFrom):
                base = (
                    ".".join([*module.split(".")[: -node.level], node.module or ""]).rstrip(".") if node.level else ""
                )
                base = base or node.module or ""
                named |= {base, *(f"{base}.{one.name}" for one in node.names)}
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                named |= {node.value.partition(":")[0]} - {PROGRAM}
        return named & self._names


def _keywords(function: ast.FunctionDef) -> Iterator[ast.keyword]:
    for one in function.decorator_list:
        if isinstance(one, ast.Call):
            yield from one.keywords


def _asked_for(nodes: Iterable[ast.AST]) -> set[str]:
    """Names that may be those of fixtures: arguments of functions, and texts."""
    names = set()
    for node in nodes:
        if isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.add(node.value)
    return names


def _module_name(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


@cache
def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _meaning(text: str) -> str:
    """What a module does: its syntax tree without docstrings."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


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
    return {path for path in paths if path and _differs(root, commit or "", path)}


def _differs(root: Path, commit: str, path: str) -> bool:
    if not path.endswith(".py"):
        return True
    try:
        before = _git(root, "show", f"{commit}:{path}")
        return _meaning(before) != _meaning((root / path).read_text(encoding="utf-8"))
    except (OSError, subprocess.CalledProcessError, SyntaxError):
        return True  # new, gone, or not to be read


def touched_modules(changed: set[str]) -> set[str]:
    """Modules that have changed, or read a file that has."""
    modules = {_module_name(Path(path)) for path in changed if path.endswith(".py")}
    readers = {_reader(path) for path in changed if not path.endswith((".py", ".md"))}
    return modules | (readers - {""})


def _reader(path: str) -> str:
    """The module whose readers depend on a file that is none; what nobody has thought of counts for every proof."""
    return next((reader for start, reader in READ_BY.items() if path.startswith(start)), "tests.conftest")


def touched_proofs(root: Path, proofs: Iterable[Path]) -> list[Path]:
    """Those of the files of proofs that rest on something that has changed since they passed, or may have."""
    proven = _commits(root / PROVEN)
    return _touched(root, {path: proven.get(path.as_posix(), proven.get("proofs")) for path in proofs})


def touched_on_second(root: Path, tests: Iterable[Path]) -> list[Path]:
    """The same of files of tests since all of them passed on a second Python."""
    return _touched(root, dict.fromkeys(tests, _commits(root / PROVEN).get("second")))


def _touched(root: Path, since: Mapping[Path, str | None]) -> list[Path]:
    changed = {commit: changed_since(root, commit) for commit in set(since.values())}
    touched = {commit: touched_modules(files) for commit, files in changed.items() if files is not None}
    tree = Tree(root, set().union(*touched.values()))
    return [path for path, commit in since.items() if commit not in touched or tree.proof(path) & touched[commit]]


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
        kind = "tests on a second Python" if second else "proofs"
        sys.stderr.write(f"{len(left_out)} of {len(files)} files of {kind} left out, for nothing that they rest on ")
        sys.stderr.write("has changed since they passed (.ci/proven):\n" + "".join(f"  {one}\n" for one in left_out))
    print(*(path.as_posix() for path in run))


if __name__ == "__main__":
    main()
