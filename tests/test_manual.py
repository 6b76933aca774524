"""What the manual names exists: links, folders and modules, message codes."""

import ast
import itertools
import re
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from tests import message_page
from tests.translations import texts

pytestmark = pytest.mark.usefixtures("syntax_trees")

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "resources" / "manual").glob("*.md"))]
LINK = re.compile(r"\]\((?!https?:)([^)#]+)")
PLACE = re.compile(r"`((?:core|workbench|tests|resources)/[\w/{},.-]*)`")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    assert not [link for link in links if not (page.parent / link).exists()]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_folders_and_modules_that_are_named_exist(page):
    named = [place for found in PLACE.findall(page.read_text(encoding="utf-8")) for place in spelled_out(found)]
    assert not [place for place in named if "NAME" not in place and not exists(place)]


def test_message_codes_that_are_explained_exist_and_are_on_the_page_of_all():
    explained = message_page.explained()
    assert explained
    assert not explained.keys() - set(message_page.codes())


def test_every_error_says_what_to_do_beside_it_or_on_the_page_on_troubleshooting():
    explained = message_page.explained()
    assert not [code for code, advice in message_page.errors().items() if not advice and code not in explained]


def test_every_error_and_warning_is_on_the_page_of_all_and_nothing_else():
    assert message_page.PAGE.read_text(encoding="utf-8") == message_page.page(), "write it with `make messages`"


def test_what_is_left_off_the_page_of_all_is_there_and_no_error():
    codes = {text.code for text in texts()}
    assert not [name for name in message_page.NAMES if not any(fnmatchcase(code, name) for code in codes)]
    assert not [code for code in message_page.errors() if message_page.is_name(code)]


def test_every_room_of_messages_says_what_helps_and_no_other_does():
    assert set(message_page.rooms()) == {code.partition(".")[0] for code in message_page.codes()}


def test_what_to_do_about_an_error_stands_beside_it_in_a_constant_or_in_a_function():
    source = """
_ASK = Message("advice.ask", "ask {whom}")
raise InputError(Message("a.b", "one", why=Message("a.why", "inner")), todo=_ASK)
raise WrongValue(Message("a.c", "two") if x else Message("a.d", "three"))
raise InputError(Message("a.e", "four"), todo=SHARED if x else which_way(3))
def which_way(n): return Message("advice.way", "this way")
tell(Message("a.note", "no error"))
from core.other import SHARED
"""
    shared = {"SHARED": [("advice.shared", "share")], "_ASK": [("advice.other", "not this module's")]}
    found = list(message_page.errors_of(list(ast.walk(ast.parse(source))), shared))
    assert found == [("a.b", ["ask {whom}"]), ("a.c", []), ("a.d", []), ("a.e", ["share", "this way"])]


def test_places_are_spelled_out():
    assert spelled_out("core/scan/{features,network}") == ["core/scan/features", "core/scan/network"]


def spelled_out(place: str) -> list[str]:
    """core/{a,b} as core/a and core/b."""
    parts = [part.split(",") for part in re.split(r"[{}]", place)]
    return ["".join(each) for each in itertools.product(*parts)]


def exists(place: str) -> bool:
    path = ROOT / place
    return path.exists() or path.with_suffix(".py").exists()
