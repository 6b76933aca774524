"""What a test rests on: of each module that it imports, however deep, those definitions that can be reached from it.

A definition is what a module names at its top: a function, a class as a whole, a constant, an import. A row of a table
of findings is one by its code, which is how a note on a result is made from it. Whatever else
stands there runs with the import, and has the module's own name. A text that is a module's name, or "module:name",
reaches it, as a second process starts it or a wing brings it. A module that is handed on is reached as a whole.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from functools import cache
from pathlib import Path
from string import Formatter

WORDS = {"Message": (1, 3), "Finding": (3, 4)}
"""Calls with sentences for people, and where among their arguments."""
PROGRAM = "trisect"
"""In a text it is the program's name, or a folder's; scripts import the package."""
PACKAGES = ("core", "workbench", "trisect", "resources", "tests")
ASKED_FOR_BY = {
    "core.cli.app": ("commands",),
    "core.files.project.witness": ("witness",),
    "core.files.results.export_list": ("exports",),
    "core.findings.table": ("findings",),
    "core.inspect.plan.kinds": ("feature_kinds",),
    "core.pipeline.steps.brought_sections": ("sections", "reads_study"),
}
"""Modules that import what a `core.wing.Wing` names, each with the fields it asks for: nothing else rests on that."""
HARMLESS = frozenset(
    (
        *("dataclass", "inlined", "compiled", "contextmanager", "contextlib.contextmanager", "cache", "lru_cache"),
        *("runtime_checkable", "pytest.fixture", "pytest.hookimpl"),
    )
)
"""Decorators that keep no list of what they decorate: it is reached by its name alone, or as a fixture."""


@cache
def parsed(path: Path) -> ast.Module:
    """Return a file's syntax tree."""
    return ast.parse(path.read_text(encoding="utf-8"))


def module_name(path: Path) -> str:
    """Return the module of a path within the checkout."""
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def definitions(tree: ast.Module) -> dict[str, list[ast.stmt]]:
    """Return the statements that make each name of a module; those of "" run with its import."""
    found: dict[str, list[ast.stmt]] = defaultdict(list)
    for whole in tree.body:
        rows, node = _rows_of(whole)
        found |= rows
        names, runs = _defined(node)
        for name in names:
            found[name].append(node)
        if runs or not names:
            found[""].append(node)
    return found


def _rows_of(node: ast.stmt) -> tuple[dict[str, list[ast.stmt]], ast.stmt]:
    """Rows of a table of findings by their codes, by which alone they are looked up, and what is left of the table."""
    if not (
        isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple) and ast.unparse(node.targets[0]) == "ROWS"
    ):
        return {}, node
    rows: dict[str, list[ast.stmt]] = {}
    others = []
    for one in node.value.elts:
        if isinstance(one, ast.Call) and ast.unparse(one.func) == "Finding" and isinstance(one.args[0], ast.Constant):
            rows[str(one.args[0].value)] = [ast.copy_location(ast.Expr(one), one)]
        else:
            others.append(one)
    rest = ast.Assign(node.targets, ast.copy_location(ast.Tuple(others, ast.Load()), node.value))
    return rows, ast.copy_location(rest, node)


def _defined(node: ast.stmt) -> tuple[list[str], bool]:
    """Names that a statement of a module makes, and whether it may do more than that."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        called = (ast.unparse(one.func if isinstance(one, ast.Call) else one) for one in node.decorator_list)
        return [node.name], not HARMLESS.issuperset(called)
    if isinstance(node, ast.Import | ast.ImportFrom):
        return [one.asname or one.name.partition(".")[0] for one in node.names], False
    if isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        parts = [part for one in targets for part in (one.elts if isinstance(one, ast.Tuple) else [one])]
        named = [one.id for one in parts if isinstance(one, ast.Name)]
        return named, len(named) < len(parts)
    inner = [one for one in ast.walk(node) if isinstance(one, ast.stmt) and one is not node]
    return [name for one in inner for name in _defined(one)[0]], True


def differing(before: str, now: str, words: bool = True) -> set[str]:
    """Return names of a module whose definitions do not do the same in two versions, "" for what runs with its import.

    Docstrings and comments do not count; without `words` nor do those of sentences for people.

    Raises
    ------
    SyntaxError
        If one of them is no module.
    """
    versions = [_version(text) for text in (before, now)]
    texts = [
        {
            name: ["\n".join(lines[_first_line(one) - 1 : one.end_lineno]) for one in nodes]
            for name, nodes in known.items()
        }
        for lines, known in versions
    ]
    other = {name for name in texts[0].keys() | texts[1].keys() if texts[0].get(name) != texts[1].get(name)}
    old, new = ({name: _meaning(name, known.get(name, []), words) for name in other} for _, known in versions)
    return {name for name in other if old[name] != new[name]}


@cache
def _version(text: str) -> tuple[list[str], dict[str, list[ast.stmt]]]:
    """Lines and definitions of a module: it is compared with several, and with and without words."""
    return text.split("\n"), definitions(ast.parse(text))


def _first_line(node: ast.stmt) -> int:
    return min([node.lineno, *(one.lineno for one in getattr(node, "decorator_list", []))])


def _meaning(name: str, statements: list[ast.stmt], words: bool) -> str:
    """What the statements that make a name of a module do."""
    return "\n".join(
        _imported_as(one, name) or ast.dump(_bare(deepcopy(one), words)) for one in statements if not _is_text(one)
    )


def _bare(statement: ast.stmt, words: bool) -> ast.stmt:
    """Take docstrings out of a statement, and unless `words` are wanted those of sentences."""
    for node in ast.walk(statement):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
        if not words and isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            for argument in node.args[slice(*WORDS.get(node.func.id, (0, 0)))]:
                if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                    places = {place for _, place, *_ in Formatter().parse(argument.value) if place is not None}
                    argument.value = " ".join(sorted(places))
    return statement


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _imported_as(node: ast.stmt, name: str) -> str:
    """What an import makes of one of its names, whatever it imports besides."""
    if not isinstance(node, ast.Import | ast.ImportFrom):
        return ""
    base = f"{node.level} {node.module} " if isinstance(node, ast.ImportFrom) else ""
    taken = [one for one in node.names if (one.asname or one.name.partition(".")[0]) == name]
    return base + " ".join(ast.unparse(one) for one in taken)


class Tree:
    """The definitions of a checkout, and which of the others each of them reaches, with those that are `gone`.

    A definition is "module:name", and a module itself what runs with its import.
    """

    def __init__(self, root: Path, gone: Iterable[str] = ()) -> None:
        self.root = root
        self.files = {
            module_name(path.relative_to(root)): path for name in PACKAGES for path in (root / name).rglob("*.py")
        }
        self._names = {*self.files, *(one.partition(":")[0] for one in gone)}
        self._wings = {one for one in self.files if one.startswith("core.wings.") and one.endswith(".wing")}
        self._definitions = cache(self._definitions_of)
        self._aliases = cache(self._aliases_of)
        self._reached = cache(self._reached_by)
        self._given_to_wing = cache(self._arguments_of_wing)
        self._brought = cache(self._brought_to)
        self._begun = cache(self._begins_with)
        self._codes: dict[str, str] = {}
        for module in self.files:
            if "findings" in module:
                self._codes |= {code: f"{module}:{code}" for code in self._definitions(module) if "." in code}

    def named_by(self, path: Path) -> set[str]:
        """Modules that a file of tests names itself, also by way of another one that hands a name on, and its own."""
        return {one.partition(":")[0] for one in self.handed_to(self._whole(module_name(path)))}

    def imported_names(self, module: str) -> dict[str, str]:
        """What the names that a module imports at its top stand for: a module, or a definition of one."""
        return dict(self._aliases(module))

    def handed_to(self, begins: Iterable[str]) -> set[str]:
        """Definitions and those that they name, of a name that a package hands on also the one it stands for."""
        found = {*begins}
        waiting = set().union(*map(self._reached, found)) - found
        while waiting:
            one = waiting.pop()
            found.add(one)
            if self._is_import(one):
                waiting |= self._reached(one) - found
        return found

    def _is_import(self, definition: str) -> bool:
        module, _, name = definition.partition(":")
        made_by = self._definitions(module).get(name, []) if name else []
        return any(isinstance(one, ast.Import | ast.ImportFrom) for one in made_by)

    def reached(self, definition: str) -> set[str]:
        """Definitions that one names itself."""
        return self._reached(definition)

    def closure(self, names: Iterable[str]) -> set[str]:
        """Definitions that are reached from these, themselves among them; a module's name stands for all of its."""
        return self._closure({one for name in names for one in (self._whole(name) if ":" not in name else {name})})

    def proof(self, path: Path) -> set[str]:
        """Definitions that a file of tests rests on: what it reaches, and what the fixtures it asks for reach."""
        return self._closure({*self.begins_with(path)})

    def who_reach(self, wanted: Iterable[str], paths: Iterable[Path]) -> dict[str, list[Path]]:
        """Of files of tests those that rest on each of some definitions: by the arrows taken back, all at once."""
        begins = {path: self.begins_with(path) for path in paths}
        back = self._back_to(begins.values())
        found = {}
        for one in wanted:
            reaching, waiting = {one}, [one]
            while waiting:
                more = back.get(waiting.pop(), set()) - reaching
                reaching |= more
                waiting += more
            found[one] = [path for path, begun in begins.items() if not begun.isdisjoint(reaching)]
        return found

    def nearest(self, wanted: Iterable[str], paths: Iterable[Path]) -> dict[str, list[Path]]:
        """For each definition the files of tests from which the fewest arrows lead to it."""
        begins = {path: self.begins_with(path) for path in paths}
        back = self._back_to(begins.values())
        found = {}
        for one in wanted:
            reaching, waiting, nearest = {one}, {one}, list[Path]()
            while waiting and not nearest:
                nearest = [path for path, begun in begins.items() if not begun.isdisjoint(waiting)]
                waiting = set().union(*(back.get(name, ()) for name in waiting)) - reaching
                reaching |= waiting
            found[one] = nearest
        return found

    def _back_to(self, begins: Iterable[set[str]]) -> dict[str, set[str]]:
        """Of all that is reached from these the arrows taken back."""
        back: dict[str, set[str]] = defaultdict(set)
        for one in self._closure(set().union(*begins)):
            for reached in self._reached(one):
                back[reached].add(one)
        return back

    def begins_with(self, path: Path) -> set[str]:
        """Definitions of a file of tests itself, and of the fixtures that it asks for."""
        return self._begun(path)

    def _begins_with(self, path: Path) -> set[str]:
        own = module_name(path)
        conftests = [module_name(folder / "conftest.py") for folder in path.parents]
        asked = _asked_for(ast.walk(parsed(self.root / path)))
        return self._whole(own) | self._fixtures([own, *(one for one in conftests if one in self.files)], asked)

    def _closure(self, waiting: set[str]) -> set[str]:
        found: set[str] = set()
        while waiting:
            name = waiting.pop()
            found.add(name)
            waiting |= self._reached(name) - found
        return found

    def _definitions_of(self, module: str) -> dict[str, list[ast.stmt]]:
        return definitions(parsed(self.files[module])) if module in self.files else {}

    def _whole(self, module: str) -> set[str]:
        return {module} | {f"{module}:{name}" for name in self._definitions(module) if name and name not in self._codes}

    def _reached_by(self, definition: str) -> set[str]:
        """What one definition reaches at once."""
        module, _, name = definition.partition(":")
        known = self._definitions(module)
        if module not in self.files:
            return set()
        if not name:
            return self._imported(module) | self._brought(module) | self.named_in(known.get("", []), module)
        if name not in known:  # of the module's own making, or gone
            return self._whole(module)
        return {module} | self._brought(module) | self._by_name(name, module)

    def _by_name(self, name: str, module: str) -> set[str]:
        """What the statements that make a name of a module reach; of those that import it, what it stands for."""
        statements = self._definitions(module)[name]
        imports = [one for one in statements if isinstance(one, ast.Import | ast.ImportFrom)]
        found = self.named_in([one for one in statements if one not in imports], module)
        for one in imports:
            target = self._imports(one, module).get(name, "")
            found |= {target} - {""} if isinstance(one, ast.ImportFrom) else self._of_import(one, module)
        return found

    def _imported(self, module: str) -> set[str]:
        """Modules that run with the import of one: its packages and what it imports at its top."""
        packages = {module.rsplit(".", depth)[0] for depth in range(1, module.count(".") + 1)}
        within = (one for node in self._definitions(module).get("", []) for one in ast.walk(node))
        imports = [one for one in within if isinstance(one, ast.Import | ast.ImportFrom)]
        targets = {target for one in imports for target in self._imports(one, module).values()}
        targets.update(self._aliases(module).values())
        return (packages & self._names) | {target.partition(":")[0] for target in targets}

    def _imports(self, node: ast.Import | ast.ImportFrom, module: str) -> dict[str, str]:
        """What each name of an import of ours stands for: a module, or a definition of one."""
        if isinstance(node, ast.Import):
            whole = {one.asname or one.name: one.name for one in node.names}
            return {name: target for name, target in whole.items() if target in self._names}
        base = node.module or ""
        if node.level:
            package = module.split(".") if self._is_package(module) else module.split(".")[:-1]
            base = ".".join([*package[: len(package) + 1 - node.level], *filter(None, [node.module])])
        found = {}
        for one in node.names:
            if f"{base}.{one.name}" in self._names:
                found[one.asname or one.name] = f"{base}.{one.name}"
            elif base in self._names:
                found[one.asname or one.name] = base if one.name == "*" else f"{base}:{one.name}"
        return found

    def _is_package(self, module: str) -> bool:
        return module in self.files and self.files[module].name == "__init__.py"

    def named_in(self, statements: Sequence[ast.AST], module: str) -> set[str]:
        """What some statements of a module name: by an import, by a name of the module, in a text."""
        left_out = self._left_to_who_asks(module)
        nodes = [one for statement in statements for one in _walk(statement, left_out)]
        known, aliases = self._definitions(module), dict(self._aliases(module))
        for node in nodes:
            if isinstance(node, ast.Import | ast.ImportFrom):
                aliases |= self._imports(node, module)
        found: set[str] = set()
        parts_of_modules = set()
        for node in nodes:
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                target = aliases.get(node.value.id, "")
                if target and ":" not in target:
                    found.add(f"{target}:{node.attr}")
                    parts_of_modules.add(id(node.value))
        for node in nodes:
            if isinstance(node, ast.Name):
                if node.id in known:
                    found.add(f"{module}:{node.id}")
                if (target := aliases.get(node.id, "")) and id(node) not in parts_of_modules:
                    found |= {target} if ":" in target else self._whole(target)
            elif isinstance(node, ast.Import | ast.ImportFrom):
                found |= self._of_import(node, module)
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                found |= self._in_text(node.value)
        return found

    def _aliases_of(self, module: str) -> dict[str, str]:
        """What the imports at the top of a module stand for, by name."""
        statements = {id(node): node for nodes in self._definitions(module).values() for node in nodes}.values()
        imports = (one for one in statements if isinstance(one, ast.Import | ast.ImportFrom))
        return {name: target for one in imports for name, target in self._imports(one, module).items()}

    def _of_import(self, node: ast.Import | ast.ImportFrom, module: str) -> set[str]:
        """What an import reaches by itself: the names that it takes, or that which runs with a module."""
        taken = self._imports(node, module)
        found = set(taken.values())
        as_a_path = isinstance(node, ast.Import) and not all(one.asname for one in node.names)
        if as_a_path or "*" in taken:  # of the first, "package.module.name" may be used
            return {one for target in found for one in self._whole(target)}
        return found

    def _in_text(self, text: str) -> set[str]:
        if text in self._codes:
            return {self._codes[text]}
        name, _, function = text.partition(":")
        if name not in self._names or name == PROGRAM:
            return set()
        if name.endswith(".wings"):
            return {
                one
                for wing in self.files
                if wing.startswith(f"{name}.") and wing.endswith(".wing")
                for one in self._whole(wing)
            }
        return {name, f"{name}:{function}"} if function else self._whole(name)

    def _brought_to(self, module: str) -> set[str]:
        """What a module reaches by way of wings: what it asks them for. See `core.door.by_folders`, `ASKED_FOR_BY`."""
        fields = ASKED_FOR_BY.get(module, ())
        given = [node for wing in self._wings for node in self._given_to_wing(wing) if node.arg in fields]
        texts = (one.value for node in given for one in ast.walk(node) if isinstance(one, ast.Constant))
        return {one for text in texts if isinstance(text, str) for one in self._in_text(text)}

    def _left_to_who_asks(self, module: str) -> set[int]:
        if module not in self._wings:
            return set()
        asked_for = {field for fields in ASKED_FOR_BY.values() for field in fields}
        return {id(node) for node in self._given_to_wing(module) if node.arg in asked_for}

    def _arguments_of_wing(self, module: str) -> list[ast.keyword]:
        """Arguments of the calls of `Wing` in a module."""
        nodes = ast.walk(parsed(self.files[module]))
        calls = [node for node in nodes if isinstance(node, ast.Call) and ast.unparse(node.func) == "Wing"]
        return [given for call in calls for given in call.keywords]

    def _fixtures(self, modules: Sequence[str], asked: set[str]) -> set[str]:
        """Modules' own statements, and those of their functions that the tests or pytest itself call.

        A fixture may be imported. `asked` is extended by those that they ask for in turn, of whichever module.
        """
        functions = {
            f"{module}:{name}": node
            for module in modules
            for name in self._definitions(module)
            if (node := self._fixture(module, name))
        }
        found, before = {*modules}, 0
        while len(found) > before:
            before = len(found)
            for one in functions.keys() - found:
                if (name := one.partition(":")[2]) in asked or _called_by_pytest(name, functions[one]):
                    found.add(one)
                    asked |= _asked_for(ast.walk(functions[one]))
        return found

    def _fixture(self, module: str, name: str) -> ast.FunctionDef | None:
        """The function that is a fixture or a hook of pytest by a name of a module, wherever it stands."""
        for node in self._definitions(module).get(name, []):
            if isinstance(node, ast.FunctionDef):
                is_one = any("fixture" in ast.unparse(one) for one in node.decorator_list)
                return node if is_one or name.startswith("pytest_") else None
            if isinstance(node, ast.ImportFrom):
                target, _, known_as = self._imports(node, module).get(name, "").partition(":")
                return self._fixture(target, known_as)
        return None


def _walk(statement: ast.AST, left_out: set[int]) -> Iterator[ast.AST]:
    """All of a statement but parts that are left out."""
    waiting = [statement]
    while waiting:
        node = waiting.pop()
        if id(node) not in left_out:
            yield node
            waiting += ast.iter_child_nodes(node)


def _called_by_pytest(name: str, function: ast.FunctionDef) -> bool:
    """Whether a function of a conftest is called without being asked for."""
    given = (one for node in function.decorator_list if isinstance(node, ast.Call) for one in node.keywords)
    return name.startswith("pytest_") or "autouse=True" in map(ast.unparse, given)


def _asked_for(nodes: Iterable[ast.AST]) -> set[str]:
    """Names that may be those of fixtures: arguments of functions, and texts."""
    names = set()
    for node in nodes:
        if isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.add(node.value)
    return names
