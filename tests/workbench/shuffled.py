"""The window's tests in other orders: what one module leaves behind is found by the one that comes after it.

`python -m tests.workbench.shuffled --orders 50` runs the test modules of the window, each order in a process of its
own; which ones can be chosen (`tests/workbench/work tests/workbench/test_refresh.py`). Order N is the same each time.
"""

from __future__ import annotations

import argparse
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent


def modules(places: Sequence[Path]) -> list[Path]:
    """All test modules of these folders and files."""
    return sorted({one for place in places for one in ([place] if place.is_file() else place.rglob("test_*.py"))})


def run(order: int, files: Sequence[Path], more: Sequence[str]) -> bool:
    """Run one order; whether all was well."""
    shuffled = random.Random(order).sample(list(files), len(files))
    begun = time.monotonic()
    command = [sys.executable, "-X", "faulthandler", "-m", "pytest", "-q", "-x", *more, *map(str, shuffled)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    print(f"order {order}: {'well' if ran.returncode == 0 else 'FAILED'}, {time.monotonic() - begun:.0f} s", flush=True)
    if ran.returncode != 0:
        print(*[path.name for path in shuffled], ran.stdout[-6000:], ran.stderr[-3000:], sep="\n", flush=True)
    return ran.returncode == 0


def main() -> int:
    """Run as many orders as asked; 1 if one of them failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("places", nargs="*", type=Path, default=[HERE])
    parser.add_argument("--orders", type=int, default=50)
    parser.add_argument("--first", type=int, default=1, help="the number of the first order")
    parser.add_argument("--quick", action="store_true", help="without the slow proofs")
    given = parser.parse_args()
    files, more = modules(given.places), ["-m", "not slow"] if given.quick else []
    results = [run(order, files, more) for order in range(given.first, given.first + given.orders)]
    print(f"{sum(results)} of {len(results)} orders of {len(files)} modules were well")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
