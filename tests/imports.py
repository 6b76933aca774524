"""Import every module of the program: `python -m tests.imports` says which cannot be, and ends with 1 if any."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Iterator

PACKAGES = ("core", "workbench", "trisect", "resources")


def modules() -> Iterator[str]:
    """Names of all modules, those that start the program left out."""
    for name in PACKAGES:
        package = importlib.import_module(name)
        yield name
        for found in pkgutil.walk_packages(package.__path__, f"{name}."):
            if not found.name.endswith(("__main__", "manual.conf")):
                yield found.name


def main() -> None:
    """Import all, and tell how many were."""
    failed, count = [], 0
    for name in modules():
        try:
            importlib.import_module(name)
            count += 1
        except Exception as error:  # noqa: BLE001  whatever it is, it is told
            failed.append(f"{name}: {type(error).__name__}: {error}")
    sys.stdout.write("".join(f"{one}\n" for one in failed))
    sys.stdout.write(f"Python {sys.version.split()[0]}: {count} modules imported, {len(failed)} failed\n")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
