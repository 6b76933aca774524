"""`make fuzz`: many more cases than the tests run, each time others; says what went wrong, and which case it was.

``python -m tests.hostile [--cases N] [--seed S] [--first K]``
"""

from __future__ import annotations

import argparse
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from core.simulate.recording import simulate_set
from tests.hostile.harness import run_cases
from tests.hostile.readers import good_files
from tests.simulated import CUT, TINY, trisect

_BATCH = 2500
_SIDE_BY_SIDE = 2


def main() -> int:
    """See the module; 1 if anything went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--first", type=int, default=0)
    told = parser.parse_args()
    print(f"seed {told.seed}", flush=True)
    count = 0
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(_SIDE_BY_SIDE) as pool:
        folder = Path(name)
        simulate_set(TINY, folder / "set")
        trisect("run", folder / "set", "--out", folder / "out", *CUT)
        good_files(folder / "good", folder / "set", folder / "out")
        last = told.first + told.cases

        def batch(first: int) -> dict[int, str]:
            return run_cases(folder / "good", folder / f"work{first}", told.seed, first, min(first + _BATCH, last))

        for wrong in pool.map(batch, range(told.first, last, _BATCH)):
            count += len(wrong)
            for number, said in wrong.items():
                print(f"case {number}, {said}\n", flush=True)
    print(f"{told.cases} cases, {count} wrong")
    return int(count > 0)


if __name__ == "__main__":
    raise SystemExit(main())
