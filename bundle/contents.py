"""What goes into the one folder: which packages, which of their modules and which shared libraries."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
EXTRAS = ("window", "e57", "step", "dxf", "genicam")
"""Left out: `basler`, whose SDK takes 239 MB and is proprietary (its cameras speak GenTL, too); `console`, 80 MB, half
of it a debugger; `cluster`, whose workers need Python anyway."""

NOT_NEEDED = (
    "tkinter", "IPython", "ipykernel", "jupyter_client", "qtconsole", "zmq", "pytest", "_pytest", "setuptools", "pip",
    "sphinx", "mypy", "docutils", "dask", "distributed", "pandas", "pypylon",
    "matplotlib.tests", "mpl_toolkits.tests", "numpy.tests", "scipy.tests", "numba.tests", "numba.cuda",
    "numba.np.ufunc.tbbpool", "numba.np.ufunc.omppool", "readline",
    "llvmlite.tests",
    "PySide6.QtQml", "PySide6.QtQuick", "PySide6.QtDesigner", "PySide6.QtSql", "PySide6.QtHelp",
    "PySide6.QtTest", "PIL.AvifImagePlugin", "PIL._avif", "PIL.ImageQt",
    "lxml.html", "lxml.isoschematron", "lxml.objectify",
    "pyqtgraph.examples", "pyqtgraph.opengl", "trame", "vtk",
)  # fmt: skip
"""Modules that some library would import if asked for what this program never asks for. readline is GPL-3.0."""
UNSEEN = ("resources", "numba._devicearray", "PySide6.QtOpenGL")
"""Modules that are imported where no reading of the code shows it."""

QT_PLUGINS = (
    "platforms",
    "xcbglintegrations",
    "egldeviceintegrations",
    "wayland-",
    "styles",
    "imageformats",
    "iconengines",
)
"""Kinds of Qt's plugins that a window of widgets loads; and what begins with one of them."""
QT_PLUGINS_LEFT_OUT = (
    "qpdf",
    "qvnc",
    "qlinuxfb",
    "qeglfs",
    "qvkkhrdisplay",
    "qminimalegl",
    "qtiff",
    "qwebp",
    "qicns",
    "qtga",
    "qwbmp",
)
"""Of those, platforms without a desktop and formats that no picture of the program has."""

SYSTEM = ("/lib/", "/usr/lib/")
"""Where the libraries of a Linux system are."""
PYTHONS_OWN = (
    "libpython", "libssl", "libcrypto", "libffi", "libsqlite3", "libbz2", "liblzma", "libz.", "libexpat", "libuuid",
    "libmpdec", "libzstd",
)  # fmt: skip
"""Of the system's libraries, those that Python's own modules need. The rest the system keeps: a second C++ library or
OpenGL loader beside the graphics driver's own is what such folders usually break by."""


LANGUAGES = ("root", "en", *sorted({file.name[:2] for file in (ROOT / "resources" / "translations").glob("*.po")}))
"""How the names of babel's data begin for the languages that the program speaks: a tenth of all."""


def packages() -> list[str]:
    """The distributions that are needed at run time, the program itself first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = ["trisect"]
    waiting = [*project["dependencies"], *(one for name in EXTRAS for one in project["optional-dependencies"][name])]
    while waiting:
        asked = Requirement(waiting.pop())
        name = canonicalize_name(asked.name)
        if name not in found and (not asked.marker or asked.marker.evaluate({"extra": ""})):
            found.append(name)
            waiting += distribution(name).requires or []
    return found


def vtk_modules() -> tuple[list[str], list[str]]:
    """VTK's modules that are imported where the program has drawn a picture in 3D, tried in a process; and the others.

    pyvista imports them when they are asked for, which no reading of its code shows.
    """
    code = (
        "import json, sys; from workbench.views.scene import surfaces; "
        "assert surfaces.works(), 'nothing can be drawn here'; import pyvistaqt; "
        "print(json.dumps(sorted(name for name in sys.modules if name.startswith('vtkmodules.'))))"
    )
    ran = subprocess.run([sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    needed = json.loads(ran.stdout.splitlines()[-1])
    import vtkmodules

    files = (file for file in Path(vtkmodules.__path__[0]).glob("vtk*") if file.suffix in (".so", ".pyd"))
    others = {f"vtkmodules.{file.name.split('.')[0]}" for file in files}.difference(needed)
    return needed, [*sorted(others), *(f"vtkmodules.{name}" for name in ("all", "web", "tk", "wx", "test"))]


def wanted_binaries(binaries: list[tuple[str, str, str]]) -> Iterator[tuple[str, str, str]]:
    """Of the shared libraries that were found needed, those that go into the folder: (place, source, kind)."""
    for place, source, kind in binaries:
        parts, name = Path(place).parts, Path(place).name
        if (
            sys.platform == "linux"
            and kind != "EXTENSION"  # a system's Python keeps its own modules beside the system's libraries
            and str(Path(source).resolve()).startswith(SYSTEM)
            and not name.startswith(PYTHONS_OWN)
        ):
            continue
        if "plugins" in parts and "PySide6" in parts:
            plugin = parts[parts.index("plugins") + 1]
            if not plugin.startswith(QT_PLUGINS) or any(one in name for one in QT_PLUGINS_LEFT_OUT):
                continue
        yield place, source, kind


def wanted_data(data: list[tuple[str, str, str]]) -> Iterator[tuple[str, str, str]]:
    """Of the files beside the modules, those that go into the folder."""
    for place, source, kind in data:
        path = Path(place).as_posix()
        if "/sample_data/" in path or "/tests/" in path or "/qml/" in path:
            continue
        if "/Qt/translations/" in path and not Path(path).name.startswith("qtbase_"):
            continue
        if path.startswith("babel/locale-data/") and not Path(path).name.startswith((*LANGUAGES, "LICENSE")):
            continue
        if ".dist-info/" in path and path.rsplit("/", 1)[1] in ("RECORD", "INSTALLER", "REQUESTED", "direct_url.json"):
            continue
        yield place, source, kind
