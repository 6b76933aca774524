"""How long each module of tests takes, in seconds: by this they are handed out, the longest first.

`pytest -p tests.durations` writes those of the modules that have run anew into `tests/durations.txt`, at the end of it.
What takes less than `SHORT_S` has no line: where it stands does not matter.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from heapq import heappop, heappush
from pathlib import Path

import pytest

FILE = Path(__file__).with_suffix(".txt")
SHORT_S = 2.0
USUAL_S = 1.0
"""Of a module that nobody has measured: among the short ones."""


def read(file: Path = FILE) -> dict[str, float]:
    """Seconds by module; nothing where there is no such file."""
    if not file.exists():
        return {}
    lines = (line.split() for line in file.read_text(encoding="utf-8").splitlines())
    return {module: float(seconds) for seconds, module in lines}


def part_of(modules: Iterable[str], part: str, seconds: Mapping[str, float] | None = None) -> set[str]:
    """The modules of part "I/N": of N parts that take alike, each module, the longest first, into the shortest one."""
    which, count = map(int, part.split("/"))
    took = read() if seconds is None else seconds
    parts: list[tuple[float, int, list[str]]] = [(0.0, number, []) for number in range(count)]
    for module in sorted(modules, key=lambda one: (-took.get(one, USUAL_S), one)):
        long, number, those = heappop(parts)
        heappush(parts, (long + took.get(module, USUAL_S), number, [*those, module]))
    return {module for _, number, those in parts if number == which - 1 for module in those}


def write(took: dict[str, float], file: Path = FILE) -> None:
    """Put modules that have run in place of what is known of them; the others keep theirs, unless they are gone."""
    known = {module: seconds for module, seconds in {**read(file), **took}.items() if seconds >= SHORT_S}
    there = ((seconds, module) for module, seconds in known.items() if (file.parents[1] / module).is_file())
    rows = sorted(there, reverse=True)
    file.write_text("".join(f"{seconds:.0f} {module}\n" for seconds, module in rows), encoding="utf-8")


def pytest_configure(config: pytest.Config) -> None:
    """Listen in the process that hears of all tests."""
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Heard())


class Heard:
    """What the tests of each module have taken together, their fixtures with them."""

    def __init__(self) -> None:
        self.took: Counter[str] = Counter()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add a part of a test."""
        self.took[report.nodeid.split("::")[0]] += report.duration  # type: ignore[assignment]

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Write it down, unless the run was cut short."""
        if exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
            write(dict(self.took))
