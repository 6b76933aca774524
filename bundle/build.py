"""`make bundle`: one folder to double-click, packed, and as a package for Debian; all in build/bundle.

Run by the Python of an environment that holds the program and PyInstaller, and nothing that tests it.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

from contents import EXTRAS, ROOT
from deb import build_deb
from icons import write_icons
from libraries import lessen
from sizes import sizes

from core import __version__, compiled, sources
from core.pipeline.compile_ahead import compile_ahead

BUILD = ROOT / "build" / "bundle"
FOLDER = BUILD / "dist" / "trisect"
"""The folder itself."""
INSIDE = FOLDER / "_internal"
"""Where PyInstaller puts all but the two programs."""

NOTE = """
This folder was built by PyInstaller, whose start program is in it: GPL-2.0-or-later with an exception that allows to
pass on programs built with it under any licence. Python's own licence (PSF-2.0) is in licences/python.txt, those of the
packages are in _internal/NAME.dist-info. sbom.cdx.json lists every package with its version (CycloneDX).

It holds Qt with PySide6 and shiboken6 (LGPL-3.0), FFmpeg (LGPL-2.1) and Open CASCADE Technology (LGPL-2.1 with its own
exception), on whose facilities the reading of STEP files is based; the texts are in licences. They lie in _internal as
libraries of their own and may be replaced there. Qt brings ICU (licence of Unicode, Inc.:
_internal/babel/locale-data/LICENSE.unicode).
"""
CHANGED = """
On Linux the libraries differ from those of the packages, by `bundle/libraries.py` of the source of this program: names
for a debugger are taken out, and links to libraries that are left out, as nothing of them is used; from ICU's data, the
languages that the program does not speak.
"""
LICENCES = Path(__file__).with_name("licences")
"""Texts that the packages do not bring, though their terms ask for them."""


def main() -> None:
    """Build the folder, say what is in it, and pack it."""
    os.umask(0o022)  # everybody may read what is packed
    save_code()
    write_icons(BUILD)
    spec = str(Path(__file__).with_name("trisect.spec"))
    places = ("--distpath", str(BUILD / "dist"), "--workpath", str(BUILD / "work"))
    run(sys.executable, "-m", "PyInstaller", "--noconfirm", "--log-level", "WARN", *places, spec)
    put_notices()
    if sys.platform == "linux":
        lessen(INSIDE, BUILD)
        (FOLDER / "trisect-workbench").hardlink_to(FOLDER / "trisect")
    (BUILD / "sizes.txt").write_text(sizes(FOLDER), encoding="utf-8")
    pack()


def run(*command: str) -> None:
    """Run a program in the checkout; it must succeed."""
    subprocess.run(command, cwd=ROOT, check=True)


def save_code() -> None:
    """Compile what a measurement needs, measure once, and take along all that was compiled."""
    compile_ahead()
    run(sys.executable, "-m", "core.cli", "demo", "--quick", "--out", str(BUILD / "first"))
    kept = BUILD / "saved_code"
    shutil.rmtree(kept, ignore_errors=True)
    shutil.copytree(compiled.FOLDER, kept / compiled.FOLDER.name)
    (kept / sources.BUILT.name).write_text(sources.to_be_built(compiled._FILES), encoding="utf-8")


def put_notices() -> None:
    """Version, licences and the list of packages, where somebody finds them who looks into the folder."""
    (FOLDER / "VERSION").write_text(f"trisect {__version__} ({', '.join(EXTRAS)})\n", encoding="utf-8")
    shutil.copy(ROOT / "LICENSE", FOLDER)
    notice = (ROOT / "NOTICE").read_text(encoding="utf-8")
    changed = CHANGED if sys.platform == "linux" else ""
    (FOLDER / "NOTICE").write_text(notice + NOTE + changed, encoding="utf-8")
    shutil.copy(BUILD / "sbom.cdx.json", FOLDER)
    licences = FOLDER / "licences"
    shutil.copytree(LICENCES, licences, dirs_exist_ok=True)
    (licences / "python.txt").write_text(pythons_licence(), encoding="utf-8")


def pythons_licence() -> str:
    """The licence of Python as it comes with it."""
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    for path in (
        Path(sys.base_prefix, "lib", version, "LICENSE.txt"),
        Path(sys.base_prefix, "LICENSE.txt"),
        Path("/usr/share/doc", version, "copyright"),
    ):
        if path.exists():
            return path.read_text(encoding="utf-8", errors="replace")
    raise SystemExit("bundle: Python's own licence was not found beside it")


def pack() -> None:
    """The folder as one file for each way to install it."""
    name = f"trisect-{__version__}-{sys.platform}-{platform.machine().lower()}"
    if sys.platform == "linux":
        build_deb(FOLDER, BUILD, __version__)
        packed = BUILD / f"{name}.tar.xz"
        packed.unlink(missing_ok=True)
        tar = ("tar", "--owner=0", "--group=0", "--sort=name", "-C", str(FOLDER.parent), "-I", "xz -T0 -6", "-cf")
        run(*tar, str(packed), FOLDER.name)
    else:
        shutil.make_archive(
            str(BUILD / name), "zip", FOLDER.parent, "Trisect.app" if sys.platform == "darwin" else "trisect"
        )


if __name__ == "__main__":
    main()
