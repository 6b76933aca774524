"""`make translations`: every text that the code tells, put into the catalogues of all languages.

Babel's own extractor loses texts in calls within calls, in conditional expressions and in calls with any number of
texts; the syntax tree has them all.
"""

from __future__ import annotations

import argparse
import ast
import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache

from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po, write_po

from tests.code import ROOT, modules, nodes

FOLDER = ROOT / "resources" / "translations"

CODED = {"Message": slice(1, 2), "plural_message": slice(1, 3), "Finding": slice(3, 5)}
"""Calls whose first argument is a code, and which of their arguments are its texts."""
WORDS_AT = {"tr": slice(1), "label": slice(1), "words": slice(1), "fixed_text": slice(1), "section": slice(2, 3),
            "heads": slice(1, None), "progress": slice(1), "steps": slice(2, 3)}  # fmt: skip
"""Calls that tell fixed words, and which of their arguments those are."""

DESCRIBED = ("description", "help")
"""The keywords by which a field of a file says what it must be, and an option of a command what it does."""
COMMAND = "command"
"""What makes a command of a function, whose docstring is its help."""

HEAD = "# Written by `make translations`; messages stand by their code (msgctxt), fixed words by the English ones."
PLACEHOLDERS = (
    '"Project-Id-Version', '"Report-Msgid', '"POT-Creation', '"PO-Revision', '"Last-Tr', '"Language-Team', '"Generated',
    "#, python-brace-format\n",
)  # fmt: skip
"""Lines of Babel's that say nothing here, or would change with each run."""


@dataclass(frozen=True, slots=True)
class Text:
    """A text in the code: its code ("" for fixed words), the English in its one or two forms, and where it stands."""

    code: str
    english: tuple[str, ...]
    path: str
    line: int


@cache
def all_texts() -> tuple[Text, ...]:
    """Every text of the program's modules, by module and line."""
    found: list[Text] = []
    for folder in ("core", "workbench", "trisect"):
        for path in modules(folder):
            found += sorted(texts_of(nodes(path), path.relative_to(ROOT).as_posix()), key=lambda text: text.line)
    return tuple(found)


def texts(*folders: str) -> list[Text]:
    """Every text of the modules in some folders, by module and line."""
    return [text for text in all_texts() if not folders or text.path.startswith(folders)]


def texts_of(of_module: Iterable[ast.AST], path: str = "") -> Iterator[Text]:
    """Every text of one module, given all its nodes, in no particular order."""
    for node in of_module:
        if isinstance(node, ast.FunctionDef) and any(map(_makes_command, node.decorator_list)):
            yield Text("", (ast.get_docstring(node) or "",), path, node.lineno)
        if not isinstance(node, ast.Call):
            continue
        name = called(node)
        if name in CODED and (given := node.args[CODED[name]]):
            code, *english = (literals(argument) for argument in (node.args[0], *given))
            if len(code) == 1 and all(len(one) == 1 for one in english):
                yield Text(code[0], tuple(one[0] for one in english), path, node.lineno)
        for argument in node.args[WORDS_AT[name]] if name in WORDS_AT else ():
            yield from (Text("", (word,), path, node.lineno) for word in literals(argument) if word)
        for described in (keyword.value for keyword in node.keywords if keyword.arg in DESCRIBED):
            yield from (Text("", (word,), path, node.lineno) for word in literals(described))


def _makes_command(decorator: ast.expr) -> bool:
    return isinstance(decorator, ast.Call) and called(decorator) == COMMAND


def called(call: ast.Call) -> str:
    """The name of what is called, without what it belongs to."""
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def literals(argument: ast.expr) -> list[str]:
    """The texts that an argument can be."""
    if isinstance(argument, ast.IfExp):
        return literals(argument.body) + literals(argument.orelse)
    return [argument.value] if isinstance(argument, ast.Constant) and isinstance(argument.value, str) else []


def template(*folders: str) -> Catalog:
    """A catalogue of every text, without any translation: messages by their codes, then fixed words."""
    catalog = Catalog()
    for text in sorted(texts(*folders), key=lambda text: (not text.code, text.code, text.path, text.line)):
        identity = text.english if len(text.english) > 1 else text.english[0]
        catalog.add(identity, locations=[(text.path, 0)], context=text.code or None)
    return catalog


def catalogue(name: str) -> Catalog:
    """The catalogue of a language; an empty one where there is none."""
    path = FOLDER / f"{name}.po"
    if not path.exists():
        return Catalog(locale=name)
    with path.open("rb") as file:
        return read_po(file, locale=name)


def updated(old: Catalog, wanted: Catalog) -> Catalog:
    """The catalogue with what is wanted and nothing else; a message whose English changed is marked to be looked at."""
    new = Catalog(locale=old.locale, header_comment=HEAD, fuzzy=False)
    by_code = {entry.context: entry for entry in old if entry.context}
    for entry in wanted:
        if not entry.id:
            continue
        same = old.get(entry.id, entry.context)
        near = by_code.get(entry.context or "")
        known = same or (near if near is not None and type(near.id) is type(entry.id) else None)
        flags = set() if known is None else known.flags | (set() if same or not known.string else {"fuzzy"})
        added = new.add(entry.id, locations=entry.locations, context=entry.context, flags=flags)
        if known is not None:
            added.string, added.user_comments = known.string, known.user_comments
    return new


def write(name: str, catalog: Catalog) -> None:
    """Write the catalogue of a language."""
    stream = io.BytesIO()
    write_po(stream, catalog, width=110, include_lineno=False)
    lines = stream.getvalue().decode().splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith(PLACEHOLDERS)]
    (FOLDER / f"{name}.po").write_text("".join(kept), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.translations", description=__doc__)
    parser.add_argument("names", nargs="*", help="languages to add: fr, zh_CN")
    wanted = template()
    for name in sorted({*parser.parse_args().names, *(path.stem for path in FOLDER.glob("*.po"))}):
        catalog = updated(catalogue(name), wanted)
        write(name, catalog)
        lacking = sum(not entry.string or not any(entry.string) or entry.fuzzy for entry in catalog if entry.id)
        print(f"{name}: {len(catalog)} texts, {lacking} of them not translated")


if __name__ == "__main__":
    main()
