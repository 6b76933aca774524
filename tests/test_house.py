"""Rules of the house that the syntax tree shows: what numbers say, how many arguments, no logic on shown texts."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path

import pytest

from tests.code import ROOT, modules, nodes, syntax_tree
from tests.translations import called

pytestmark = pytest.mark.usefixtures("syntax_trees")
MOST_PARAMETERS = 8
COMMANDS = ("command", "callback")
"""Decorators of typer's: the parameters of such a function are the options of a command line."""


def is_number(value: ast.expr | None) -> bool:
    """Whether it is a number, or several in a row."""
    match value:
        case ast.Constant():
            return type(value.value) in (int, float)
        case ast.UnaryOp():
            return is_number(value.operand)
        case ast.BinOp():
            return is_number(value.left) and is_number(value.right)
        case ast.Tuple():
            return bool(value.elts) and all(map(is_number, value.elts))
    return False


def names_of(statement: ast.stmt) -> list[str]:
    """The constants that a statement makes."""
    targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
    names = [node.id for target in targets if target for node in ast.walk(target) if isinstance(node, ast.Name)]
    return [name for name in names if name.strip("_").isupper()]


def unexplained(text: str, tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Line and name of every constant of numbers with neither a docstring below it nor a comment at or above it."""
    lines = ["", *text.splitlines()]
    for statement, following in zip(tree.body, [*tree.body[1:], None], strict=True):
        if not isinstance(statement, ast.Assign | ast.AnnAssign) or not is_number(statement.value):
            continue
        said = isinstance(following, ast.Expr) and isinstance(getattr(following.value, "value", None), str)
        first, last = statement.lineno - 1, statement.end_lineno or statement.lineno
        if not said and not any("#" in line for line in lines[first : last + 1]):
            yield from ((statement.lineno, name) for name in names_of(statement)[:1])


def test_every_number_at_the_top_of_a_module_says_what_it_is():
    found = [
        f"{path.relative_to(ROOT)}:{line} {name}"
        for path in modules("core", "workbench", "trisect")
        for line, name in unexplained(path.read_text(encoding="utf-8"), syntax_tree(path))
    ]
    assert found == [], "say its unit and its reason beside it"


@pytest.mark.parametrize(
    ("source", "named"),
    [
        ("A_MM = 3.0", ["A_MM"]),
        ("_A, _B = 1, -2", ["_A"]),
        ("A: float = 2 * 3\nB = 'text'", ["A"]),
        ('A = 3\n"""Why."""', []),
        ("A = 3  # why", []),
        ("# why\nA = 3", []),
        ("a = 3\nA = f(3)", []),
    ],
)
def test_a_number_is_explained_by_a_docstring_below_or_a_comment(source, named):
    assert [name for _, name in unexplained(source, ast.parse(source))] == named


def is_command(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    called = [one.func for one in function.decorator_list if isinstance(one, ast.Call)]
    return any(isinstance(one, ast.Attribute) and one.attr in COMMANDS for one in called)


def test_no_function_has_more_than_eight_parameters():
    found = []
    for path in modules("core", "workbench", "trisect", "tests"):
        for node in nodes(path):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not is_command(node):
                all_of_them = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                taken = [one for one in all_of_them if one.arg not in ("self", "cls")]
                if len(taken) > MOST_PARAMETERS:
                    found.append(f"{path.relative_to(ROOT)}:{node.lineno} {node.name} has {len(taken)}")
    assert found == [], "put together what belongs together"


RIDDLES = re.compile(r"\b(whoever|nobody|somebody)\b|\b(is|are) asked of\b|\bIt is over\b", re.IGNORECASE)
"""Ways of saying who or what is meant without naming it."""


def first_sentences(path: Path) -> Iterator[tuple[int, str]]:
    """Line and first sentence of every docstring in a module, those below fields and constants included."""
    for node in nodes(path):
        body = getattr(node, "body", None)
        for line in body if isinstance(body, list) else ():
            said = line.value.value if isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) else None
            if isinstance(said, str):
                yield line.lineno, re.split(r"(?<=\.)\s|\n\n", said.strip())[0]


def test_the_scan_step_is_read_at_a_glance():
    """What it does is a list of calls: at most 25 statements, and 15 modules of ours."""
    tree = syntax_tree(ROOT / "core" / "pipeline" / "steps" / "scan_step.py")
    ours = [node for node in tree.body if isinstance(node, ast.ImportFrom) and str(node.module).startswith("core.")]
    (step,) = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    (_, *statements) = (node for statement in step.body for node in ast.walk(statement) if isinstance(node, ast.stmt))
    assert len(statements) <= 25, "the docstring is none"
    assert len(ours) <= 15


def test_the_first_sentence_of_a_docstring_names_who_and_what_is_meant():
    found = [
        f"{path.relative_to(ROOT)}:{line} {sentence}"
        for path in modules("core", "workbench", "trisect")
        for line, sentence in first_sentences(path)
        if RIDDLES.search(sentence)
    ]
    assert found == [], "say plainly what it does or is"


CUTS = {
    "partition", "rpartition", "split", "rsplit", "removeprefix", "removesuffix", "startswith", "endswith", "replace",
    "find", "index",
}  # fmt: skip
"""Methods that look at what a text says, or take it apart."""
TELLING = frozenset(("tr", "text_of", "sentence", "words", "known", "shown_name", "headed_name", "value_line"))
"""Calls that give a text in the reader's language; so does every function that returns what one of these gives."""


def assigned_in(function: ast.AST) -> dict[str, list[ast.expr]]:
    """What each name of a function is given; nothing is known of names that a loop or a tuple gives."""
    found: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        if isinstance(node, ast.Assign | ast.AnnAssign | ast.NamedExpr) and node.value is not None:
            for target in targets:
                if isinstance(target, ast.Name):
                    found.setdefault(target.id, []).append(node.value)
    return found


def tells(value: ast.expr, telling: Collection[str], given: Mapping[str, list[ast.expr]]) -> bool:
    """Whether an expression gives a text in the reader's language."""
    match value:
        case ast.Call(func=ast.Attribute(attr="strip", value=inner)):
            return tells(inner, telling, given)
        case ast.Call():
            return called(value) in telling
        case ast.Name():
            others = {name: values for name, values in given.items() if name != value.id}
            return any(tells(one, telling, others) for one in given.get(value.id, ()))
        case ast.JoinedStr():
            parts = [one.value for one in value.values if isinstance(one, ast.FormattedValue)]
        case ast.IfExp():
            parts = [value.body, value.orelse]
        case ast.BoolOp():
            parts = value.values
        case ast.BinOp(op=ast.Add()):
            parts = [value.left, value.right]
        case ast.Subscript(value=ast.Dict(values=values)):
            parts = values
        case _:
            return False
    return any(tells(part, telling, given) for part in parts)


def telling_in(trees: Sequence[ast.Module]) -> frozenset[str]:
    """Names of all functions of some modules that return a text in the reader's language, whichever has the name."""
    returned: dict[str, list[list[tuple[ast.expr, dict[str, list[ast.expr]]]]]] = {}
    for function in chain.from_iterable(map(ast.walk, trees)):
        if isinstance(function, ast.FunctionDef):
            text = isinstance(function.returns, ast.Name) and function.returns.id == "str"
            values = (
                [one.value for one in ast.walk(function) if isinstance(one, ast.Return) and one.value] if text else []
            )
            given = assigned_in(function) if values else {}
            returned.setdefault(function.name, []).append([(value, given) for value in values])
    found = set(TELLING)
    while more := {
        name
        for name, functions in returned.items()
        if name not in found and all(any(tells(value, found, given) for value, given in each) for each in functions)
    }:
        found |= more
    return frozenset(found)


def cuts(tree: ast.Module, telling: Collection[str]) -> Iterator[tuple[int, str]]:
    """Line and source of each place where a text in the reader's language is looked at or taken apart."""
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        nodes = list(ast.walk(function))
        tried: list[ast.Attribute | ast.Subscript] = [
            node.func
            for node in nodes
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in CUTS
        ]
        tried += [node for node in nodes if isinstance(node, ast.Subscript) and "[-" in ast.unparse(node)]  # its end
        given = assigned_in(function) if tried else {}
        yield from ((one.lineno, ast.unparse(one)) for one in tried if tells(one.value, telling, given))
        for node in nodes:
            if isinstance(node, ast.Compare):
                sides = [node.left, *node.comparators]
                if any(isinstance(side, ast.Call) and called(side) in TELLING for side in sides):
                    yield node.lineno, ast.unparse(node)


def test_no_logic_looks_at_a_shown_text():
    trees = {path: syntax_tree(path) for path in modules("core", "workbench", "trisect")}
    telling = telling_in(list(trees.values()))
    found = [
        f"{path.relative_to(ROOT)}:{line} {source}"
        for path, tree in trees.items()
        for line, source in cuts(tree, telling)
    ]
    assert found == [], "in another language it says something else: keep apart what is apart"


@pytest.mark.parametrize(
    ("line", "seen"),
    [
        ("tr('a. b').partition('.')", True),
        ("self.tip().partition('.')", True),
        ("shown_name(row, words).strip().removeprefix('a')", True),
        ("text = tr('a') if x else ''; text.startswith('a')", True),
        ("f'{tr(kind)} …'.replace(' ', '')", True),
        ("x = tr('a')[-1:] in '.'", True),
        ("x = text == tr('a')", True),
        ("x = 'a' in text_of(note)", True),
        ("x = tr('a') if y == 'a' else ''", False),
        ("path.name.partition('.')", False),
        ("name.removeprefix('a')", False),
        ("tr('a').strip()", False),
        ("', '.join(tr('a').split)", False),
    ],
)
def test_a_text_that_is_cut_is_seen(line, seen):
    source = f"def tip(self) -> str:\n    first = {{1: tr('a')}}[x]\n    return f'{{first}} b'\ndef f():\n    {line}\n"
    tree = ast.parse(source)
    assert bool(list(cuts(tree, telling_in([tree])))) == seen


BY_CODE = {
    "core/messages.py": "finds the text of a message in the reader's language",
    "core/image/exclusion.py": "finds what excludes a picture in a file, which older files tell by its words",
    "core/inspect/causes.py": "finds the cause that a file names, which older files name by its words",
    "core/findings/table.py": "finds how grave a note is",
}
"""Modules that look something up by the code of a message, and what."""
LOOK_UPS = frozenset(("get", "pop", "setdefault", "index", "count"))
"""Methods that find something by what they are given."""


def has_code(*parts: ast.AST) -> bool:
    """Whether the code of a message is read anywhere in some expressions."""
    return any(isinstance(node, ast.Attribute) and node.attr == "code" for part in parts for node in ast.walk(part))


def decides_by_code(node: ast.AST) -> bool:
    """Whether what is done there depends on which code a message has."""
    match node:
        case ast.Compare():
            return has_code(node.left, *node.comparators)
        case ast.Subscript():
            return has_code(node.slice)
        case ast.Match():
            return has_code(node.subject)
        case ast.Call(func=ast.Attribute(attr=method, value=of)):
            return (method in CUTS and has_code(of)) or (method in LOOK_UPS and has_code(*node.args))
    return False


def test_no_logic_decides_by_the_code_of_a_message():
    found: dict[str, list[str]] = {}
    for path in modules("core", "workbench", "trisect"):
        for node in filter(decides_by_code, nodes(path)):
            place = f"{getattr(node, 'lineno', 0)} {ast.unparse(node)[:80]}"
            found.setdefault(path.relative_to(ROOT).as_posix(), []).append(place)
    more = {path: places for path, places in found.items() if path not in BY_CODE}
    assert more == {}, "a code is there to translate, keep, count or print a message: give the fact a field"
    assert BY_CODE.keys() - found.keys() == set(), "these look at no code any more: take them off the list"


@pytest.mark.parametrize(
    ("line", "seen"),
    [
        ("note.code == BAD", True),
        ("any(one.code != BAD.code for one in notes)", True),
        ("note.code in CODES", True),
        ("BAD in {note.code for note in notes}", True),
        ("WORDS[where.code]", True),
        ("WORDS.get(todo.code or str(todo), todo)", True),
        ("error.what.code.startswith('plan.')", True),
        ("str(error.code).endswith('.plan')", True),
        ("match note.code:\n    case 'a.b':\n        pass", True),
        ("{'code': note.code, 'text': str(note)}", False),
        ("Counter(note.code for note in notes)", False),
        ("print(note.code)", False),
        ("as_json(note) if note.code else str(note)", False),
        ("reason is LEFT_OUT", False),
        ("code == 70", False),
    ],
)
def test_a_decision_by_a_code_is_seen(line, seen):
    assert any(map(decides_by_code, ast.walk(ast.parse(line)))) == seen


MAKERS = ("Message", "plural_message", "plain", "note_of")
"""What makes a message."""
GATHERED = ("frozenset", "set", "tuple", "dict", "MappingProxyType")


def holds_message(value: ast.expr | None, known: Collection[str]) -> bool:
    """Whether it is a message, or several to be looked for; `known` names constants that are."""
    match value:
        case ast.Call():
            parts = value.args if called(value) in GATHERED else []
            return called(value) in MAKERS or any(holds_message(one, known) for one in parts)
        case ast.Tuple() | ast.List() | ast.Set():
            return any(holds_message(one, known) for one in value.elts)
        case ast.Dict():
            return any(holds_message(one, known) for one in value.keys)
        case ast.Starred():
            return holds_message(value.value, known)
        case ast.BinOp():
            return holds_message(value.left, known) or holds_message(value.right, known)
        case ast.Name():
            return value.id in known
    return False


def messages_of(trees: Mapping[str, ast.Module]) -> dict[str, set[str]]:
    """By module, the names of its constants, and of those it imports, that are messages."""
    found: dict[str, set[str]] = {name: set() for name in trees}
    imports = {name: [one for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)] for name, tree in trees.items()}
    before = -1
    while before != (before := sum(map(len, found.values()))):
        for name, tree in trees.items():
            for node in imports[name]:
                theirs = found.get(node.module or "", ())
                found[name] |= {one.asname or one.name for one in node.names if one.name in theirs}
            for statement in tree.body:
                if isinstance(statement, ast.Assign | ast.AnnAssign) and holds_message(statement.value, found[name]):
                    found[name] |= set(names_of(statement))
    return found


def compares_message(node: ast.AST, known: Collection[str]) -> bool:
    """Whether something is compared with a message, or looked for among some."""
    return isinstance(node, ast.Compare) and any(holds_message(side, known) for side in (node.left, *node.comparators))


def test_no_logic_compares_with_a_message():
    paths = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in modules("core", "workbench")}
    known = messages_of({name: syntax_tree(path) for name, path in paths.items()})
    found = [
        f"{name}:{getattr(node, 'lineno', 0)} {ast.unparse(node)[:80]}"
        for name, path in paths.items()
        for node in nodes(path)
        if compares_message(node, known[name])
    ]
    assert found == [], "a message is there to be told: decide by a field, as core.image.exclusion.Exclusion"


@pytest.mark.parametrize(
    ("line", "seen"),
    [
        ("row.source == BAD", True),
        ("row.source is not BAD", True),
        ("any(one in (GOOD, BAD) for one in notes)", True),
        ("one not in ALL", True),
        ("one in {*ALL}", True),
        ("one in BY_NOTE", True),
        ("one in frozenset((BAD,))", True),
        ("note == Message('a.b', 'bad')", True),
        ("row.source is Cause.BAD", False),
        ("note is None", False),
        ("kind in WORDS", False),
    ],
)
def test_a_comparison_with_a_message_is_seen(line, seen):
    its = "BAD = Message('a.b', 'bad')\nALL: Final = (BAD,)\nBY_NOTE = {BAD: 1}\nWORDS = {1: BAD}\n"
    trees = {"its": ast.parse(its), "mine": ast.parse(f"from its import ALL, BAD, BY_NOTE, WORDS\n{line}\n")}
    known = messages_of(trees)["mine"]
    assert any(compares_message(node, known) for node in ast.walk(trees["mine"])) == seen


def unguarded(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and source of each place where a path is renamed, or a tree removed, past `core.held_files`."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute | ast.Name):
            continue
        name, arguments = called(node), len(node.args) + len(node.keywords)
        owner = ast.unparse(node.func.value) if isinstance(node.func, ast.Attribute) else ""
        cleans = any(one.arg in ("ignore_errors", "ignore_cleanup_errors") for one in node.keywords)
        if (
            (owner == "os" and name in ("rename", "renames", "replace"))
            or (owner == "shutil" and name == "move")
            or (name in ("rmtree", "TemporaryDirectory") and not cleans)
            or (name == "rename" and owner not in ("", "os", "held_files"))
            or (name == "replace" and owner not in ("", "os", "dataclasses") and arguments == 1 and len(node.args) == 1)
        ):
            yield node.lineno, ast.unparse(node)


def test_every_rename_waits_for_another_program_that_holds_the_file():
    found = [
        f"{path.relative_to(ROOT)}:{line} {source}"
        for path in modules("core", "workbench")
        if path != ROOT / "core" / "held_files.py"
        for line, source in unguarded(syntax_tree(path))
    ]
    assert found == [], "call core.held_files, or say ignore_errors where what is left does no harm"


@pytest.mark.parametrize(
    ("line", "seen"),
    [
        ("beside.replace(path)", True),
        ("(a / 'b').replace(a / 'c')", True),
        ("path.rename(to)", True),
        ("os.replace(a, b)", True),
        ("os.rename(a, b)", True),
        ("shutil.move(a, b)", True),
        ("shutil.rmtree(a)", True),
        ("tempfile.TemporaryDirectory()", True),
        ("rename(a, b)", False),
        ("text.replace('a', 'b')", False),
        ("when.replace(microsecond=0)", False),
        ("replace(project, name='a')", False),
        ("shutil.rmtree(a, ignore_errors=True)", False),
        ("tempfile.TemporaryDirectory(ignore_cleanup_errors=True)", False),
    ],
)
def test_a_rename_past_the_rule_is_seen(line, seen):
    assert bool(list(unguarded(ast.parse(line)))) == seen


def test_one_function_says_how_many_cores_there_are():
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in modules("core", "workbench")
        for node in nodes(path)
        if isinstance(node, ast.Call) and called(node) in ("cpu_count", "process_cpu_count", "sched_getaffinity")
        if path != ROOT / "core" / "threads.py"
    ]
    assert found == [], "call core.threads.cores: an administrator may leave this process some of them only"
