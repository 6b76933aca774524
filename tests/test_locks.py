"""Locked versions: with hashes, from nowhere in particular, and the same wherever one is named."""

import re
import tomllib

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.code import ROOT

LOCKS = ("dev", "bundle", "tools")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def locked(name):
    """Version of each package in a lock, by its name; a hash at least of each is asked for."""
    entries = re.split(r"\n(?=\S)", (ROOT / "locks" / f"{name}.txt").read_text(encoding="utf-8").strip())
    assert all("--hash=sha256:" in entry for entry in entries)
    return pinned(entry.split("\\")[0] for entry in entries)


def pinned(lines):
    asked = [Requirement(line) for line in lines if line.strip() and not line.startswith("#")]
    return {canonicalize_name(one.name): str(one.specifier) for one in asked}


CONSTRAINTS = pinned((ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines())


def test_constraints_are_the_locked_versions_without_hashes():
    assert locked("dev") == CONSTRAINTS, "write them with `make lock`"


@pytest.mark.parametrize("name", ["bundle", "tools"])
def test_other_locks_agree_with_them(name):
    assert {one: version for one, version in locked(name).items() if CONSTRAINTS.get(one, version) != version} == {}


@pytest.mark.parametrize("path", ["constraints.txt", *(f"locks/{name}.txt" for name in LOCKS)])
def test_no_lock_names_where_its_packages_were_found(path):
    text = (ROOT / path).read_text(encoding="utf-8")
    assert not re.search(r"://|index|find-links", re.sub(r"^[\w.-]+==", "", text, flags=re.MULTILINE))


def test_every_requirement_is_locked_within_its_bounds():
    extras = [one for some in PROJECT["project"]["optional-dependencies"].values() for one in some]
    groups = PROJECT["dependency-groups"]
    asked = {
        "dev": [*PROJECT["project"]["dependencies"], *extras],
        "bundle": groups["bundle"],
        "tools": groups["tools"],
    }
    for name, wanted in asked.items():
        versions = locked(name)
        for one in map(Requirement, wanted):
            if one.name != "trisect":
                version = versions[canonicalize_name(one.name)].removeprefix("==")
                assert one.specifier.contains(version, prereleases=True), one


def test_what_builds_the_wheel_is_pinned_to_the_locked_version():
    (build,) = map(Requirement, PROJECT["build-system"]["requires"])
    assert str(build.specifier) == locked("tools")[build.name]
