"""The window's tests in other orders: what one test leaves behind is found by the one that comes after it.

`python -m tests.workbench.shuffled --orders 50` runs the tests of the window, each order in a process of its own; which
ones can be chosen (`tests/workbench/work tests/workbench/test_refresh.py`). Order N is the same each time; a failed one
is run again by `pytest --shuffled N` and the same places.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent


def run(order: int, places: Sequence[Path], more: Sequence[str]) -> bool:
    """Run one order; whether all was well."""
    begun = time.monotonic()
    command = [sys.executable, "-X", "faulthandler", "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    ran = subprocess.run(
        [*command, f"--shuffled={order}", *more, *map(str, places)], capture_output=True, text=True, check=False
    )
    last = ran.stdout.strip().rpartition("\n")[2]
    print(
        f"order {order}: {'well' if ran.returncode == 0 else 'FAILED'}, {time.monotonic() - begun:.0f} s: {last}",
        flush=True,
    )
    if ran.returncode != 0:
        print(ran.stdout[-20000:], ran.stderr[-3000:], sep="\n", flush=True)
    return ran.returncode == 0


def main() -> int:
    """Run as many orders as asked; 1 if one of them failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("places", nargs="*", type=Path, default=[HERE])
    parser.add_argument("--orders", type=int, default=50)
    parser.add_argument("--first", type=int, default=1, help="the number of the first order")
    parser.add_argument("--quick", action="store_true", help="without the slow proofs")
    given = parser.parse_args()
    more = ["-m", "not slow and not accuracy"] if given.quick else []
    results = [run(order, given.places, more) for order in range(given.first, given.first + given.orders)]
    print(f"{sum(results)} of {len(results)} orders were well")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
