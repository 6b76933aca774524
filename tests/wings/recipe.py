"""The package of the manual's recipe for a wing, taken from the page as it stands there."""

from __future__ import annotations

import re
import textwrap
import tomllib

from tests.code import ROOT
from tests.wings.strangers import Install

PAGE = ROOT / "resources" / "manual" / "recipes.md"
HEADING = "## Add a wing"


def install_recipe(install: Install) -> None:
    """Install it as the recipe says."""
    text = PAGE.read_text(encoding="utf-8")
    recipe = text[text.index(HEADING) :].split("\n## ")[0]
    steps = re.findall(r"`(lab_\w+)\.py`: .*?```python\n(.*?)```", recipe, re.DOTALL)
    sources = {name: textwrap.dedent(code) for name, code in steps}
    (declared,) = re.findall(r"```toml\n(.*?)```", recipe, re.DOTALL)
    points = tomllib.loads(textwrap.dedent(declared))["project"]["entry-points"]
    install("lab-wear", sources, points)
