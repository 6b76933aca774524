"""`pytest -p tests.passed_proofs`: which files of proofs have passed whole, and at which commit, for `make proven`.

Only a run of whole files counts, on a tree without changes that stays as it is, and of these files only those of which
every proof has passed: what is skipped proves nothing.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.changed import ROOT, note_passed, tree_to_prove


def pytest_configure(config: pytest.Config) -> None:
    """Listen where whole files are proven; of several processes, in the one that hears of all tests."""
    chosen = config.option.markexpr != "accuracy" or config.option.keyword or any("::" in one for one in config.args)
    commit = tree_to_prove(ROOT)
    if commit and not chosen and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Passed(ROOT, commit))


class Passed:
    """What has passed of a run of proofs, by file."""

    def __init__(self, root: Path, commit: str) -> None:
        self.root, self.commit = root, commit
        self.files: dict[str, bool] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A file has passed while each part of each of its proofs has."""
        file = report.nodeid.split("::")[0]
        expected = report.passed and not hasattr(report, "wasxfail")
        self.files[file] = self.files.get(file, True) and expected

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """A run that was ended early has not tried all of a file."""
        ended = exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
        if ended and tree_to_prove(self.root) == self.commit:
            note_passed(self.root, self.commit, self.files)
