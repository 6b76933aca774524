"""What each direct dependency costs: `python -m tests.dependencies` prints the table of the manual's page on speed.

Size: of its own files, in MB. Import: processor time of a fresh process in ms, the smallest of three, with all that it
imports itself.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib.metadata import distribution
from pathlib import Path

ROOT = Path(__file__).parents[1]
IMPORTED = {
    "opencv-python-headless": "cv2",
    "pillow": "PIL.Image",
    "pyyaml": "yaml",
    "PySide6-Essentials": "PySide6.QtWidgets",
    "fast-simplification": "fast_simplification",
    "matplotlib": "matplotlib.figure",
    "scipy": "scipy.sparse.linalg",
    "reportlab": "reportlab.pdfgen.canvas",
    "babel": "babel.messages",
    "fonttools": "fontTools.ttLib",
    "typer": "typer",
    "rich": "rich.progress",
}
"""What we import of a package that has another name, or of which we need a part."""

_IMPORT = """
import importlib, sys, time
began = time.process_time()
importlib.import_module(sys.argv[1])
print(1000 * (time.process_time() - began))
"""


def size_mb(name: str) -> float:
    """The files of an installed package, in MB."""
    files = distribution(name).files or []
    return sum(Path(str(file.locate())).stat().st_size for file in files if Path(str(file.locate())).is_file()) / 1e6


def import_ms(module: str) -> float:
    """Processor time that importing takes in a fresh process."""

    def once() -> float:
        words = [sys.executable, "-c", _IMPORT, module]
        return float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)

    return min(once() for _ in range(3))


def main() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    window = project["optional-dependencies"]["window"]
    for wanted in (project["dependencies"], window):
        for requirement in wanted:
            name = re.split(r"[<>=]", requirement)[0]
            print(f"| {name} | {size_mb(name):.1f} | {import_ms(IMPORTED.get(name, name)):.0f} |", flush=True)


if __name__ == "__main__":
    main()
