"""2,000 files of strangers: each is read, or refused in one sentence."""

import pytest

from tests.hostile.child import case_name
from tests.hostile.harness import run_cases
from tests.hostile.readers import all_readers, good_files

CASES = 500
SEED = 17


@pytest.fixture(scope="module")
def good(simulated, measured, tmp_path_factory):
    folder = tmp_path_factory.mktemp("hostile") / "good"
    good_files(folder, simulated, measured)
    return folder


def test_every_good_file_is_read(good):
    for reader in all_readers().values():
        reader.read(good / reader.file)


@pytest.mark.accuracy
def test_no_file_causes_a_trace_a_crash_or_a_wait(good, tmp_path):
    wrong = run_cases(good, tmp_path / "work", SEED, 0, CASES)
    assert not wrong, "\n\n".join(f"case {number}, {said}" for number, said in list(wrong.items())[:5])


@pytest.mark.accuracy
def test_what_ends_its_process_is_found_and_the_others_go_on(good, tmp_path, monkeypatch):
    monkeypatch.setenv("TRISECT_HOSTILE_ABORT", "3")
    wrong = run_cases(good, tmp_path / "work", SEED, 0, 6)
    assert list(wrong) == [3]
    assert case_name(3) in wrong[3]
    assert "the process ended" in wrong[3]
