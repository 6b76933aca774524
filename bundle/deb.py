"""The folder as a package for Debian and its kin: /opt/trisect, an entry in the menu, `trisect` on the PATH."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from workbench.pages.project.double_click import entries

PLACE = Path("/opt/trisect")
PROGRAMS = ("trisect", "trisect-workbench")
DEPENDS = (
    "libc6", "libstdc++6", "libgcc-s1", "libegl1", "libgl1", "libopengl0", "libfontconfig1", "libfreetype6",
    "libdbus-1-3",
    "libglib2.0-0 | libglib2.0-0t64", "libx11-6", "libx11-xcb1", "libxext6", "libxrender1", "libsm6", "libice6",
    "libgssapi-krb5-2",
    "libxcb1", "libxcb-cursor0", "libxcb-icccm4", "libxcb-image0", "libxcb-keysyms1", "libxcb-randr0",
    "libxcb-render-util0", "libxcb-render0", "libxcb-shape0", "libxcb-shm0", "libxcb-sync1", "libxcb-xfixes0",
    "libxcb-xkb1", "libxkbcommon0", "libxkbcommon-x11-0",
)  # fmt: skip
"""What the window and the 3D view need of the system: X11, OpenGL, fonts."""
LEVEL = "-z12"

CONTROL = """Package: trisect
Version: {version}
Architecture: {architecture}
Maintainer: The Trisect authors <trisect@localhost>
Installed-Size: {kilobytes}
Depends: {depends}
Section: science
Priority: optional
Description: 3D inspection with one camera and two lasers
 Window and command line in one folder, with all they need but X11 and OpenGL.
"""


def build_deb(folder: Path, into: Path, version: str) -> Path:
    """Build the package of the folder; returns its path."""
    architecture = subprocess.run(
        ["dpkg", "--print-architecture"], check=True, capture_output=True, text=True
    ).stdout.strip()
    root = into / "deb"
    shutil.rmtree(root, ignore_errors=True)
    put = root / PLACE.relative_to("/")
    put.parent.mkdir(parents=True)
    shutil.copytree(folder, put, symlinks=True, copy_function=os.link)
    for name, text in entries((str(PLACE / "trisect-workbench"),)).items():
        _write(root / "usr" / "share" / name, text)
    _write(root / "usr/share/doc/trisect/copyright", (folder / "LICENSE").read_text() + (folder / "NOTICE").read_text())
    for program in PROGRAMS:
        link = root / "usr" / "bin" / program
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(PLACE / program)
    kilobytes = (
        sum({file.stat().st_ino: file.stat().st_size for file in folder.rglob("*") if file.is_file()}.values()) // 1024
    )
    control = CONTROL.format(
        version=version, architecture=architecture, kilobytes=kilobytes, depends=", ".join(DEPENDS)
    )
    _write(root / "DEBIAN" / "control", control)
    package = into / f"trisect_{version}_{architecture}.deb"
    subprocess.run(["dpkg-deb", "--root-owner-group", "-Zzstd", LEVEL, "--build", str(root), str(package)], check=True)
    shutil.rmtree(root)
    return package


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
