"""Batches of recording sets: side by side on any executor, one that fails alone, stopped at once."""

import json
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from core.cli import measuring
from core.errors import Cancelled, InputError
from core.files.pictures import read_picture, write_picture
from core.image.stripes.stripe import StripeSettings
from core.pipeline import batch, executors
from core.pipeline.batch import STEP, STOP, run_batch, sets_in
from core.pipeline.executors import executor_of
from core.pipeline.run import run
from core.pipeline.set_result import SetProgress
from core.remaining import USUAL_S
from core.scan.method import Method
from core.settings.options import Options
from tests.simulated import trisect


def sets(folder, *names):
    for name in names:
        (folder / name).mkdir(parents=True)
    return [folder / name for name in names]


@pytest.fixture
def quick(monkeypatch):
    """Measuring takes no time; a set says by its name what becomes of it."""

    def run(folder, out, options, progress):
        out.mkdir(parents=True, exist_ok=True)
        if "bad" in folder.name:
            raise InputError("there is no rig.toml", where=folder)
        if "broken" in folder.name:
            raise ZeroDivisionError("nothing to divide by")
        while "endless" in folder.name:
            time.sleep(0.01)
            progress("camera", 0, 1)
        verdict = "not proven" if "doubtful" in folder.name else "conforming"
        gauge, results = SimpleNamespace(thickness_mm=50.0, U_mm=0.02), SimpleNamespace(verdict=verdict)
        frames = (SimpleNamespace(used=True), SimpleNamespace(used=False))
        return SimpleNamespace(gauge=gauge, results=results, points=1000, frames=frames)

    monkeypatch.setattr(batch, "run", run)


def test_results_come_in_the_order_of_the_sets_each_in_its_folder(quick, tmp_path):
    told = []
    with ThreadPoolExecutor(2) as executor:
        results = run_batch(
            sets(tmp_path, "b", "a", "c"), tmp_path / "out", executor, progress=lambda *what: told.append(what)
        )
    assert [result.folder.name for result in results] == ["b", "a", "c"]
    assert [result.out for result in results] == [tmp_path / "out" / name for name in "bac"]
    assert all((result.thickness_mm, result.frames_used, result.error) == (50.0, 1, None) for result in results)
    assert told[-1] == (STEP, 300, 300)
    assert not (tmp_path / "out" / STOP).exists()


def test_a_set_that_fails_does_not_end_the_others(quick, tmp_path):
    with ThreadPoolExecutor(1) as executor:
        bad, broken, good = run_batch(sets(tmp_path, "bad", "broken", "good"), tmp_path / "out", executor)
    assert "there is no rig.toml" in str(bad.error)
    assert str(broken.error) == "an error in the program: ZeroDivisionError: nothing to divide by"
    assert good.error is None
    assert good.verdict == "conforming"


def test_whoever_measures_may_die_without_ending_the_others(quick, tmp_path):
    class Dying(ThreadPoolExecutor):
        def submit(self, function, folder, *rest):
            if folder.name != "b":
                return super().submit(function, folder, *rest)
            future = Future()
            future.set_exception(RuntimeError("a process was terminated abruptly"))
            return future

    with Dying(1) as executor:
        results = run_batch(sets(tmp_path, "a", "b", "c"), tmp_path / "out", executor)
    assert [bool(result.error) for result in results] == [False, True, False]
    assert "terminated abruptly" in str(results[1].error)


def test_a_batch_that_is_cancelled_stops_what_is_under_way_and_begins_nothing_more(quick, tmp_path):
    def cancel_soon(step, done, total, began=time.monotonic()):  # noqa: B008
        if time.monotonic() - began > 0.3:
            raise Cancelled

    with ThreadPoolExecutor(1) as executor, pytest.raises(Cancelled):
        run_batch(sets(tmp_path, "endless", "next"), tmp_path / "out", executor, progress=cancel_soon)
    assert not (tmp_path / "out" / "next").exists()
    assert not (tmp_path / "out" / STOP).exists()


def test_every_set_is_told_of_when_it_is_done(quick, tmp_path):
    told = []
    with ThreadPoolExecutor(1) as executor:
        results = run_batch(sets(tmp_path, "a", "bad"), tmp_path / "out", executor, watch=told.append)
    assert dict(told) == dict(enumerate(results))


def test_a_set_is_told_of_when_it_begins(quick, tmp_path):
    told = []

    def cancel_once_begun(step, done, total):
        if told:
            raise Cancelled

    with ThreadPoolExecutor(1) as executor, pytest.raises(Cancelled):
        some = sets(tmp_path, "endless", "next")
        run_batch(some, tmp_path / "out", executor, progress=cancel_once_begun, watch=told.append)
    assert told[0] == (0, None)


@pytest.mark.parametrize(("begun", "seen"), [(1, [0]), (2, [0, 1])])
def test_how_far_sets_are_that_are_being_measured_is_told_as_a_share_of_each_and_of_all(
    begun, seen, monkeypatch, tmp_path
):
    go_on = threading.Event()

    def run(folder, out, options, progress):
        for stage in USUAL_S["measure_set"]:
            progress(stage, 0, 1)
            time.sleep(0.02)
            if stage == "network":
                assert go_on.wait(10)
        return SimpleNamespace(gauge=None, points=0, frames=())

    def told_all(step, done, total):
        whole.append(done / total)
        if len({number for number, what in told if isinstance(what, SetProgress) and what.stage == "network"}) == begun:
            go_on.set()

    monkeypatch.setattr(batch, "run", run)
    told, whole = [], []
    with ThreadPoolExecutor(begun) as executor:
        run_batch(sets(tmp_path, "a", "b")[:begun], tmp_path / "out", executor, progress=told_all, watch=told.append)
    shares = {number: what.share for number, what in told if isinstance(what, SetProgress) and what.stage == "network"}
    assert sorted(shares) == seen and all(0.1 < share < 1 for share in shares.values())
    assert whole == sorted(whole) and any(0 < share < 1 for share in whole) and whole[-1] == 1


def test_the_sets_of_a_folder_are_itself_or_those_in_it(tmp_path):
    some = sets(tmp_path, "b", "a", "no set")
    for folder in some[:2]:
        (folder / "rig.toml").touch()
    assert sets_in(tmp_path) == (tmp_path / "a", tmp_path / "b")
    assert sets_in(some[0]) == (some[0],)
    with pytest.raises(InputError, match=r"no set: neither .* rig.toml"):
        sets_in(some[2])


def test_two_sets_of_one_name_are_refused(quick, tmp_path):
    same = [*sets(tmp_path / "monday", "part1"), *sets(tmp_path / "tuesday", "part1")]
    with ThreadPoolExecutor(1) as executor, pytest.raises(InputError, match=r"same name.*rename one of them"):
        run_batch(same, tmp_path / "out", executor)


@pytest.mark.parametrize(
    ("names", "code"), [(("a", "b"), 0), (("a", "doubtful"), 1), (("doubtful", "bad"), 2)], ids=["0", "1", "2"]
)
def test_the_command_leaves_with_the_worst_code_of_its_sets(quick, tmp_path, names, code):
    said = trisect("batch", *sets(tmp_path, *names), "--out", tmp_path / "out", "--executor", "threads", "--json")
    assert said.code == code
    rows = json.loads(said.out)["sets"]
    assert [Path(row["folder"]).name for row in rows] == list(names)
    assert [bool(row["error"]) for row in rows] == ["bad" in name for name in names]
    assert [bool(row["code"]) for row in rows] == ["bad" in name for name in names]


def test_the_command_tells_all_sets_width_and_contrast_of_their_stripes(tmp_path, monkeypatch):
    told = []

    def run(folder, out, options, progress):
        told.append((options.stripe, options.plane_stripe, options.channel))
        raise InputError("enough", where=folder)

    monkeypatch.setattr(batch, "run", run)
    words = ("--executor", "threads", "--stripe-width", "9", "--contrast", "30", "--channel", "green")
    trisect("batch", *sets(tmp_path, "a"), "--out", tmp_path / "out", *words)
    assert told == [(StripeSettings(9.0, 30.0), StripeSettings(9.0, 30.0), "green")]


def test_the_table_names_every_set_and_what_kept_one_from_being_measured(quick, tmp_path):
    said = trisect("batch", *sets(tmp_path, "a", "bad"), "--out", tmp_path / "out", "--executor", "threads")
    lines = said.out.splitlines()
    assert lines[1].split()[:5] == ["a", "50.000", "mm", "0.020", "mm"]
    assert "not measured" in lines[2]
    assert "there is no rig.toml" in lines[3]


@pytest.mark.parametrize(("cores", "workers", "begun"), [(2, None, 2), (128, None, 61), (4, 100, 61), (128, 3, 3)])
def test_no_more_processes_are_made_than_windows_waits_for(monkeypatch, cores, workers, begun):
    asked = []
    monkeypatch.setattr(executors, "cores", lambda: cores)
    monkeypatch.setattr(executors, "ProcessPoolExecutor", lambda count, *_, **__: asked.append(count) or nullcontext())
    with executor_of("processes", workers):
        assert asked == [begun]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--executor", "tractor"), "'tractor' is none of processes, threads and dask://HOST:PORT"),
        (("--workers", "0"), "give 1 or more"),
    ],
)
def test_absurd_executors_are_refused(quick, tmp_path, words, sentence):
    said = trisect("batch", *sets(tmp_path, "a"), "--out", tmp_path / "out", *words)
    assert said.code == 2
    assert sentence in said.sentence


def test_nothing_is_begun_if_the_folder_of_one_set_is_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr(measuring, "executor_of", lambda *_: pytest.fail("processes were made"))
    out = tmp_path / "out"
    said = trisect("batch", *sets(tmp_path, "a"), tmp_path / "typing error", "--out", out)
    assert said.code == 2 and not out.exists()
    assert said.sentence.removeprefix("trisect: ") == (
        f"{tmp_path / 'typing error'}: there is no such folder; name the folder of a recording set."
    )


def test_without_dask_one_sentence_says_what_to_install(quick, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    said = trisect("batch", *sets(tmp_path, "a"), "--out", tmp_path / "out", "--executor", "dask://localhost:1")
    assert said.code == 2
    assert "pip install -e '.[cluster]'" in said.sentence


QUICK = Options(method=Method.THREE_CROSSINGS, sigma_cut_mm=0.5)
SAME = ("camera.json", "planes.json", "cloud.ply", "mesh.ply", "gauge.json")


@pytest.fixture(scope="module")
def tiny(tiny_set, tmp_path_factory):
    """A set that is quickly measured, what a run makes of it, and the same set with its frames recorded as PGM."""
    folder = tmp_path_factory.mktemp("tiny")
    shutil.copytree(tiny_set, folder / "png")
    run(folder / "png", folder / "out", QUICK)
    shutil.copytree(folder / "png", folder / "pgm")
    frames = sorted((folder / "pgm" / "scan").glob("frame*.png"))
    assert len(frames) == 8
    for frame in frames:
        write_picture(frame.with_suffix(".pgm"), read_picture(frame))
        frame.unlink()
    return folder


def measures_what_a_run_measures(executor, tiny, out):
    """A set of PGM frames and an empty folder, as a batch."""
    block, empty = run_batch([tiny / "pgm", *sets(out, "empty")], out / "results", executor, QUICK)
    assert block.error is None
    assert block.frames == 8
    assert "rig.toml" in str(empty.error)
    for name in SAME:
        assert (block.out / name).read_bytes() == (tiny / "out" / name).read_bytes(), name


@pytest.mark.accuracy
def test_a_run_measures_pgm_frames_as_png_frames(tiny, tmp_path):
    said = trisect("run", tiny / "pgm", "--out", tmp_path, "--method", QUICK.method, "--sigma-cut", QUICK.sigma_cut_mm)
    assert said.code in (0, 1), said.err
    for name in SAME:
        assert (tmp_path / name).read_bytes() == (tiny / "out" / name).read_bytes(), name


@pytest.mark.accuracy
def test_processes_measure_the_very_same_as_a_run_and_pgm_frames_as_png_frames(tiny, tmp_path):
    with executor_of("processes", 1) as executor:
        measures_what_a_run_measures(executor, tiny, tmp_path)


@pytest.mark.accuracy
def test_a_dask_cluster_of_separate_processes_measures_the_very_same_as_a_run(tiny, tmp_path):
    distributed = pytest.importorskip("distributed", reason="pip install -e '.[cluster]'")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(tmp_path)
    ) as cluster:
        address = cluster.scheduler_address.removeprefix("tcp://")
        with executor_of(f"dask://{address}") as executor:
            measures_what_a_run_measures(executor, tiny, tmp_path)


@pytest.mark.accuracy
def test_ctrl_c_ends_all_processes_with_its_own_code(tiny_set, tmp_path):
    copies = [Path(shutil.copytree(tiny_set, tmp_path / f"set{n}")) for n in range(3)]
    command = [sys.executable, "-m", "core.cli", "batch", *map(str, copies), "--out", str(tmp_path / "out")]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    while not any((tmp_path / "out").glob("set*")):
        time.sleep(0.1)
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted" in said
