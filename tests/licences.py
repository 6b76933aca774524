"""`make notice`: whose work the program stands on and under what licence, from what the installed packages say.

The walk begins at the requirements of pyproject.toml, extras included and `dev` left out, and follows those of this
system. A licence that binds the whole program is refused, and so is one that nobody states.
"""

from __future__ import annotations

import re
import sys
import tomllib
from dataclasses import dataclass
from importlib.metadata import PackageMetadata, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
NOTICE = ROOT / "NOTICE"
WRITTEN_ON = (3, 11)
"""The Python that NOTICE is written on: the oldest one, which needs some packages that are part of later ones."""

REASONS = {
    "certifi": "MPL-2.0 binds its own files only; they are used unchanged",
    "pikepdf": "MPL-2.0 binds its own files only; they are used unchanged",
    "pyside6-essentials": "used under LGPL-3.0 by dynamic linking: installed as a package of its own, replaceable",
    "shiboken6": "used under LGPL-3.0 by dynamic linking: installed as a package of its own, replaceable",
}
"""Packages under a licence that binds changes to themselves, each with why that is kept."""

_COPYLEFT = re.compile(r"\b([AL]?GPL|GNU|MPL|Mozilla|EUPL|CDDL|EPL|Eclipse|CeCILL|SSPL|OSL|CC-BY-SA)", re.IGNORECASE)
_LINE = 100
"""Characters of a licence's name; what is longer is its text, which begins with its name."""

HEAD = """Trisect is under the MIT licence: see LICENSE.

It stands on the packages below, installed beside it, each under its own licence, whose text is installed with it.
Written by `make notice`.

Some of them carry shared libraries of others, linked dynamically and unchanged: opencv-python-headless FFmpeg
(LGPL-2.1); numpy, scipy and opencv-python-headless libquadmath (LGPL-2.1) and libgfortran, fast-simplification libgomp,
pikepdf those of GCC (GPL-3.0 with the GCC runtime library exception, which binds no program that uses them), cascadio
Open CASCADE (LGPL-2.1 with its own exception), pyzmq libzmq (MPL-2.0) and libsodium (ISC). debugpy, which ipykernel
asks for and the console does not use, holds pydevd (EPL-1.0, which binds changes to itself), unchanged.
"""


@dataclass(frozen=True, slots=True)
class Licence:
    """What one package is under, in its own words; "" if it does not say."""

    package: str
    words: str

    @property
    def refusal(self) -> str:
        """Why the program may not stand on the package; "" if it may."""
        if not self.words:
            return f"{self.package} states no licence"
        if _COPYLEFT.search(self.words) and self.package not in REASONS:
            return f"{self.package} is under {self.words}"
        return ""


def runtime_licences() -> list[Licence]:
    """Of every package that the program needs at run time, by name."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [one for name, some in project["optional-dependencies"].items() if name != "dev" for one in some]
    found: dict[str, Licence] = {}
    waiting = [*project["dependencies"], *extras]
    while waiting:
        asked = Requirement(waiting.pop())
        name = canonicalize_name(asked.name)
        if name in found or (asked.marker and not asked.marker.evaluate({"extra": ""})):
            continue
        package = distribution(name)
        found[name] = licence(name, package.metadata)
        waiting += package.requires or []
    return [found[name] for name in sorted(found)]


def licence(name: str, said: PackageMetadata) -> Licence:
    """By its SPDX expression, else its classifiers, else the first line of its licence field."""
    classifiers = [one.split(" :: ")[-1] for one in said.get_all("Classifier") or [] if one.startswith("License")]
    fields = {field: said[field] for field in ("License", "License-Expression") if field in said}
    written = next((line.strip() for line in fields.get("License", "").splitlines() if line.strip(" =")), "")
    words = fields.get("License-Expression") or ", ".join(classifiers) or written[:_LINE]
    return Licence(name, words)


def notice() -> str:
    """The text of NOTICE."""
    lines = []
    for one in runtime_licences():
        lines.append(f"{one.package}: {one.words}")
        if one.package in REASONS:
            lines.append(f"  {REASONS[one.package]}")
    return HEAD + "\n" + "\n".join(lines) + "\n"


if __name__ == "__main__":
    if sys.version_info[:2] != WRITTEN_ON:
        sys.exit("NOTICE is written on Python {}.{}, which needs most packages.".format(*WRITTEN_ON))
    NOTICE.write_text(notice(), encoding="utf-8")
