"""What the manual names exists: links, folders and modules, message codes."""

import itertools
import re
from pathlib import Path

import pytest

from tests.translations import texts

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "resources" / "manual").glob("*.md"))]
LINK = re.compile(r"\]\((?!https?:)([^)#]+)")
PLACE = re.compile(r"`((?:core|workbench|tests|resources)/[\w/{},.-]*)`")
CODE = re.compile(r"^\| `([a-z_]+\.[a-z_]+)` \|", re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    assert not [link for link in links if not (page.parent / link).exists()]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_folders_and_modules_that_are_named_exist(page):
    named = [place for found in PLACE.findall(page.read_text(encoding="utf-8")) for place in spelled_out(found)]
    assert not [place for place in named if "NAME" not in place and not exists(place)]


def test_message_codes_that_are_explained_exist():
    explained = CODE.findall((ROOT / "resources" / "manual" / "troubleshooting.md").read_text(encoding="utf-8"))
    assert explained
    assert not set(explained) - {text.code for text in texts()}


def test_places_are_spelled_out():
    assert spelled_out("core/scan/{features,network}") == ["core/scan/features", "core/scan/network"]


def spelled_out(place: str) -> list[str]:
    """core/{a,b} as core/a and core/b."""
    parts = [part.split(",") for part in re.split(r"[{}]", place)]
    return ["".join(each) for each in itertools.product(*parts)]


def exists(place: str) -> bool:
    path = ROOT / place
    return path.exists() or path.with_suffix(".py").exists()
