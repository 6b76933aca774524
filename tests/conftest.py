import faulthandler
import gc
import itertools
import os
import random
import re
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from core.files.results.rig_history import DATA
from tests import code, durations
from tests.shared import SAID_ALOUD, made_once

_TESTS = itertools.count()
_PART = pytest.StashKey[set[str]]()
_TEST = re.compile(r"^(?:def test_|class Test)", re.MULTILINE)
_PROOF = re.compile(r"^@pytest\.mark\.accuracy$", re.MULTILINE)
_ALL_PROOFS = re.compile(r"^pytestmark = .*mark\.accuracy", re.MULTILINE)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Tests in another order, so that what one leaves behind is found by the next."""
    parser.addoption(
        "--part", metavar="I/N", help="the modules of one of N parts that take alike; no other is imported"
    )
    parser.addoption("--shuffled", type=int, metavar="SEED", help="modules, and tests within them, in a random order")


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    """A crash tells of the thread that crashed, not of all: logs that are cut short lose the one that matters."""
    config.stash[SAID_ALOUD] = os.dup(2)
    own = tempfile.mkdtemp(prefix="trisect-data-")  # histories of rigs: not those of whoever runs the tests
    os.environ[DATA] = own
    os.environ["TRISECT_LANGUAGE"] = "en"  # programs started by tests: whatever the system's language
    config.add_cleanup(lambda: shutil.rmtree(own, ignore_errors=True))
    if faulthandler.is_enabled():
        faulthandler.enable(config.stash[SAID_ALOUD], all_threads=False)


@pytest.fixture(scope="module")
def syntax_trees() -> Iterator[None]:
    """Where the program's own code is read: nothing of it is garbage to look for, and it goes with the module."""
    gc.disable()
    yield
    code.forget()
    gc.enable()


@pytest.fixture(autouse=True)
def own_history(monkeypatch: pytest.MonkeyPatch) -> None:
    """No test knows the checks of another one."""
    monkeypatch.setenv(DATA, f"{os.environ[DATA]}/{next(_TESTS)}")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Whatever is imported stays: Python's garbage collector need not go through it again and again."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Files with nothing but proofs are not imported where no proof is wanted; those that are named are."""
    if "not accuracy" in config.option.markexpr and collection_path.match("test_*.py"):
        text = collection_path.read_text(encoding="utf-8")
        if _ALL_PROOFS.search(text) or 0 < len(_TEST.findall(text)) == len(_PROOF.findall(text)):
            return True
    return True if collection_path.match("test_*.py") and _in_another_part(collection_path, config) else None


def _in_another_part(path: Path, config: pytest.Config) -> bool:
    """Whether another process of `make test` runs a module: to import all takes each of them half a minute."""
    part = config.getoption("part")
    if not part:
        return False
    if _PART not in config.stash:
        ignored = {Path(one) for one in config.option.ignore or ()}
        files = (one.relative_to(config.rootpath) for one in (config.rootpath / "tests").rglob("test_*.py"))
        config.stash[_PART] = durations.part_of((one.as_posix() for one in files if one not in ignored), part)
    return path.relative_to(config.rootpath).as_posix() not in config.stash[_PART]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Long modules first, by what they took (`tests/durations.py`): one handed out last would keep a process alone.

    Proofs keep their order, as does what has a limit of time: what is nearest to a change first (`tests/changed.py`).
    """
    seed = config.getoption("shuffled")
    if seed is not None:
        _shuffle(items, random.Random(seed))
        return
    if config.option.markexpr == "accuracy" or os.environ.get("TRISECT_TRY_UNTIL"):
        return
    seconds = durations.read()
    items.sort(key=lambda item: -seconds.get(item.path.relative_to(config.rootpath).as_posix(), durations.USUAL_S))


def _shuffle(items: list[pytest.Item], chance: random.Random) -> None:
    """Modules in any order and the tests within each: a module's fixtures are made once all the same."""
    items.sort(key=lambda item: item.nodeid)
    chance.shuffle(items)
    places = sorted({item.path for item in items})
    chance.shuffle(places)
    items.sort(key=lambda item: places.index(item.path))


@pytest.fixture(scope="session")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small simulated recording set, made once for all test processes; copy it before changing it."""
    from tests.simulated import small_set

    return made_once(tmp_path_factory, "simulated", lambda folder: small_set(folder / "block")) / "block"


@pytest.fixture(scope="session")
def tiny_set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A still smaller set, for what has to go through all steps whatever they find; copy it before changing it."""
    from core.simulate.recording import simulate_set
    from tests.simulated import TINY

    return made_once(tmp_path_factory, "tiny", lambda folder: simulate_set(TINY, folder / "block")) / "block"


@pytest.fixture(scope="session")
def measured(simulated: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All results of the small set, made once for all test processes; copy them before changing them."""
    return made_once(tmp_path_factory, "measured", lambda folder: _measure(simulated, folder / "out")) / "out"


def _measure(simulated: Path, out: Path) -> None:
    from tests.simulated import CUT, trisect

    said = trisect("run", simulated, "--out", out, *CUT)
    assert said.code in (0, 1), said.err


@pytest.fixture(scope="session")
def tiny_measured(tiny_set: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All results of the tiny set but the report, made once for all test processes; copy them before changing them."""
    return made_once(tmp_path_factory, "tiny-measured", lambda folder: _measure_tiny(tiny_set, folder / "out")) / "out"


def _measure_tiny(tiny: Path, out: Path) -> None:
    from tests.simulated import CUT, trisect

    for step, words in {"camera": (), "planes": (), "scan": CUT, "gauge": ()}.items():
        said = trisect(step, tiny, "--out", out, *words)
        assert said.code in (0, 1), said.err


@pytest.fixture(scope="session")
def finished_project_folder(tiny_set: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tiny project with every step done, its pictures within, made once for all test processes; do not change it."""
    return made_once(tmp_path_factory, "finished-project", lambda folder: _finish_project(folder, tiny_set))


@pytest.fixture(scope="session")
def finished_small_project_folder(simulated: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same of the small set, for proofs that need as many pictures; do not change it."""
    return made_once(tmp_path_factory, "finished-small-project", lambda folder: _finish_project(folder, simulated))


def _finish_project(folder: Path, pictures: Path) -> None:
    from core.files.project.folder import create_project, project_from_set, stored_source
    from core.pipeline.project.sample_project import finished_project

    recordings = Path(shutil.copytree(pictures, folder / "recordings"))
    project = project_from_set(recordings, "Block")
    inside = {part: stored_source(folder, recordings / part) for part in ("camera", "planes", "scan")}
    project = replace(
        project,
        info=replace(project.info, part="Gauge block", operator="Somebody"),
        sources=replace(project.sources, **inside),
        options=replace(project.options, sigma_cut_mm=0.3),
    )
    create_project(folder, finished_project(folder, project))
