"""Build a wheel with machine code in it, if TRISECT_SAVED_CODE names the folder of that code; else a plain one.

Such code is of one system, processor family and Python, so the wheel is tagged for these and no installer takes it for
another. The tag of the system is Python's own (`linux_x86_64`): nothing here proves a wider one (manylinux).
"""

from __future__ import annotations

import os
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SAVED_CODE = "TRISECT_SAVED_CODE"


class SavedCode(BuildHookInterface[Any]):
    """Puts saved code where `core.compiled` looks for it."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the folder and the tag; a folder that is not there is an error, never a plain wheel."""
        if not (given := os.environ.get(SAVED_CODE)):
            return
        folder = Path(given)
        if not any(folder.iterdir()):
            raise FileNotFoundError(f"no saved code in {folder}")
        system = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"cp{sys.version_info.major}{sys.version_info.minor}-none-{system}"
        build_data["force_include"][str(folder)] = f"core/saved_code/{folder.name}"
