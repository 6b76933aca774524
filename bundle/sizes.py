"""What each megabyte of the folder is."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

MB = 1_000_000
NAMES = (
    ("vtkmodules", "VTK: drawing in 3D"),
    ("vtk.libs", "VTK: drawing in 3D"),
    ("llvmlite", "LLVM: compiling the loops (llvmlite, numba)"),
    ("numba", "LLVM: compiling the loops (llvmlite, numba)"),
    ("cv2", "OpenCV, with FFmpeg"),
    ("opencv_python_headless", "OpenCV, with FFmpeg"),
    ("PySide6", "Qt: the window"),
    ("shiboken6", "Qt: the window"),
    ("scipy", "scipy"),
    ("numpy", "numpy"),
    ("cascadio", "Open CASCADE: STEP files (cascadio)"),
    ("pye57", "E57 files (pye57)"),
    ("genicam", "cameras by GenICam (harvesters)"),
    ("babel", "languages (babel)"),
    ("matplotlib", "plots of the report (matplotlib)"),
    ("core/saved_code", "compiled loops, saved"),
    ("resources", "manual, translations, icons"),
    ("trisect", "all Python code, in the program itself"),
    ("libpython", "Python"),
    ("base_library.zip", "Python"),
    ("python3", "Python"),
    ("libcrypto", "Python"),
    ("libssl", "Python"),
    ("libzstd", "Python"),
    ("libsqlite3", "Python"),
)
"""What a path within the folder begins with, and what it is told as; everything else by its own name."""


def sizes(folder: Path) -> str:
    """A table of MB by what they are, the largest first."""
    found: Counter[str] = Counter()
    counted: set[int] = set()
    for file in folder.rglob("*"):
        if file.is_file() and not file.is_symlink() and file.stat().st_ino not in counted:
            counted.add(file.stat().st_ino)
            found[_what(file.relative_to(folder).as_posix().removeprefix("_internal/"))] += file.stat().st_size
    rows = [f"{size / MB:7.1f}  {what}" for what, size in found.most_common()]
    return "\n".join([f"{sum(found.values()) / MB:7.1f}  MB unpacked, of which", *rows]) + "\n"


def _what(path: str) -> str:
    return next((told for begins, told in NAMES if path.startswith(begins)), path.split("/")[0].split(".libs")[0])
