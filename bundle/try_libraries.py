"""Load every shared library of the folder in the frozen program: one that is spoilt, or lacks another, is named.

`trisect --module bundle/try_libraries.py`
"""

import ctypes
import os
import re
import subprocess
import sys
from pathlib import Path

OF_DESKTOPS = (
    "plugins/wayland",
    "plugins/platformthemes",
    "libqwayland",
    "WaylandClient",
    "WlShellIntegration",
    "EglF",
)
"""Parts of Qt for desktops that the system may not have: Qt passes over them."""
ONE = "--one"
LIBRARY = re.compile(r"\.so(\.\d+)*$")


def main() -> int:
    """Load them in a process of their own, which may end by a library that is spoilt."""
    if sys.argv[1:2] == [ONE]:
        for path in sys.argv[2:]:
            try:
                ctypes.CDLL(path)
            except OSError as error:
                print(f"{path}: {error.__cause__ or error}", flush=True)  # the frozen program words it anew
        os._exit(0)  # what so many libraries do at their end is not tried
    folder = Path(sys.executable).resolve().parent / "_internal"
    found = (path for path in sorted(folder.rglob("*")) if LIBRARY.search(path.name) and not path.is_symlink())
    libraries = [str(path) for path in found if not any(part in path.as_posix() for part in OF_DESKTOPS)]
    ran = subprocess.run(
        [sys.executable, "--module", sys.argv[0], ONE, *libraries], capture_output=True, text=True, check=False
    )
    failed = [line for line in ran.stdout.splitlines() if "undefined symbol: _Py" not in line]
    print(
        f"{len(libraries)} libraries, {len(failed)} of them cannot be loaded (exit code {ran.returncode})",
        *failed,
        sep="\n",
    )
    return 1 if failed or ran.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
