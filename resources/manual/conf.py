"""How Sphinx builds the manual: `make docs`. Offline, and strict: a dead link is an error."""

from core import __version__

project = "Trisect"
release = version = __version__
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 3
exclude_patterns = ["conf.py", "de", "zh_CN"]  # the window shows these
html_theme = "furo"
html_title = f"Trisect {version}"
html_favicon = "../icons/trisect.svg"
html_copy_source = False
html_show_sphinx = False
