"""Many recording sets in one call, side by side on whatever executor is handed in."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from pathlib import Path

from core.errors import Cancelled, InputError, NoThickness
from core.files.atomic import make_folder, remove
from core.files.reading import cannot_read, refused_path, resolved
from core.files.recording.recording_set import RIG
from core.messages import Message, label
from core.pipeline.executors import THREADS, executor_of, is_to_end
from core.pipeline.run import RunResult, run
from core.pipeline.set_result import SetProgress, SetResult
from core.progress import Progress, silent
from core.remaining import USUAL_S, Remaining
from core.settings.options import Options

STOP = ".stop"
"""This file in the batch's folder stops all sets that are being measured, on whatever machine that sees it."""

STEP = label("measuring sets")
PARTS_OF_A_SET = 100
"""So many parts of a set's measurement are told of to the progress of the batch."""
_LOOK_EVERY_S = 0.2
"""How often in s it is looked whether a set is done or the batch is to stop."""
_LET_END_S = 30.0
"""How long in s the sets under way may take to stop, once they are told to."""
_LONGEST_REASON = 200
"""Characters of another library's words."""


SetUpdate = tuple[int, SetProgress | SetResult | None]
"""The place of a set, and how far it is or what became of it; None when it begins."""
Watch = Callable[[SetUpdate], None]
Measure = Callable[..., SetResult]
"""Called as `measure_set`, and found by its name where the executor's workers are other processes."""


def ignore_update(told: SetUpdate) -> None:
    """Do nothing with an update on a set: the watcher of a batch that none is given for."""


def run_batch(
    sets: Sequence[Path],
    out: Path,
    executor: Executor,
    options: Options | None = None,
    progress: Progress = silent,
    watch: Watch = ignore_update,
    measure: Measure | None = None,
) -> tuple[SetResult, ...]:
    """Measure recording sets side by side in `executor`; for one that cannot be measured the result holds the error.

    Parameters
    ----------
    sets
        The recording sets. Their folders' names must differ: results go to folders of the same names in `out`.
    out
        Made if it is not there; every worker must see it and the sets under the same path.
    executor
        Any `concurrent.futures.Executor`: threads, processes, or a cluster's. It is not shut down.
    options
        Method and cuts, for all.
    progress
        Called with how much is done, in hundredths of a set; may raise Cancelled: sets being measured then stop, what
        is finished stays.
    watch
        Told of each set when it begins, as far as the executor knows, and when it is done; in threads of this process
        how far it is, too.
    measure
        What measures one set; None: `measure_set`.

    Returns
    -------
    tuple[SetResult, ...]
        In the order of `sets`.

    Raises
    ------
    InputError
        If there is no set, two have one name, or `out` cannot be written.
    """
    places = _places(sets, resolved(make_folder(out)))
    stop = resolved(out) / STOP
    remove(stop)
    chosen = options or Options()
    call: Measure = measure or measure_set
    near = {number: _UnderWay() for number in range(len(places))} if isinstance(executor, ThreadPoolExecutor) else {}
    futures = [
        executor.submit(call, folder, place, chosen, stop, *([near[number]] if near else []))
        for number, (folder, place) in enumerate(places)
    ]
    try:
        return _watched(futures, places, near, progress, watch)
    except BaseException:
        _stop(futures, stop)
        raise


def measure_sets(
    sets: Sequence[Path],
    out: Path,
    options: Options | None = None,
    progress: Progress = silent,
    watch: Watch = ignore_update,
) -> tuple[SetResult, ...]:
    """Measure recording sets side by side as `run_batch`, in threads of this process, which end with it."""
    with executor_of(THREADS) as threads:
        return run_batch(sets, out, threads, options, progress, watch)


def sets_in(folder: Path) -> tuple[Path, ...]:
    """List the recording sets in `folder`, sorted by name; `folder` alone if it is a set; InputError if none is.

    Raises
    ------
    InputError
        If none is.
    """
    try:
        inside = sorted(path.parent for path in folder.glob(f"*/{RIG}"))
    except OSError as error:
        raise cannot_read(folder, error) from error
    found = (folder,) if (folder / RIG).is_file() else tuple(inside)
    if not found:
        raise InputError(
            Message("set.none_in_folder", "neither the folder nor one in it is a recording set"),
            where=folder,
            todo=Message("advice.set_has_rig", "choose one with a rig.toml in it"),
        )
    return found


def measure_set(folder: Path, out: Path, options: Options, stop: Path, progress: Progress = silent) -> SetResult:
    """Measure one recording set into `out`, return its result or error; raise Cancelled once the file `stop` exists."""
    began = time.perf_counter()
    try:
        measured = run(folder, out, options, _stopped_by(stop, progress))
    except InputError as error:
        seconds, none_found = time.perf_counter() - began, isinstance(error, NoThickness)
        return SetResult(folder, out, seconds=seconds, error=error.message, no_thickness=none_found)
    except Cancelled:
        raise
    except Exception as error:  # noqa: BLE001  (a fault in one set must not cost the others)
        refused = refused_path(error)
        told = _fault(error) if refused is None else refused.message
        seconds = time.perf_counter() - began
        return SetResult(folder, out, seconds=seconds, error=told, fault=refused is None)
    return _measured(folder, out, measured, time.perf_counter() - began)


def _measured(folder: Path, out: Path, measured: RunResult, seconds: float) -> SetResult:
    gauge = measured.gauge
    return SetResult(
        folder,
        out,
        thickness_mm=None if gauge is None else gauge.thickness_mm,
        U_mm=None if gauge is None else gauge.U_mm,
        verdict=measured.results.verdict,
        points=measured.points,
        frames=len(measured.frames),
        frames_used=sum(frame.used for frame in measured.frames),
        seconds=seconds,
    )


def _places(sets: Sequence[Path], out: Path) -> list[tuple[Path, Path]]:
    """Each set with the folder of its results."""
    if not sets:
        raise InputError(
            Message("set.none_to_measure", "there is no recording set to be measured"),
            where="batch",
            todo=Message("advice.name_folder_or_more", "name one folder or more"),
        )
    whole = [resolved(folder) for folder in sets]
    names = [folder.name for folder in whole]
    for number, name in enumerate(names):
        if name in names[:number]:
            first = whole[names.index(name)]
            raise InputError(
                Message(
                    "set.same_name",
                    "{first} has the same name, and both would write their results to {out}",
                    first=first,
                    out=out / name,
                ),
                where=whole[number],
                todo=Message("advice.rename_or_two_batches", "rename one of them, or measure them in two batches"),
            )
    return [(folder, out / folder.name) for folder in whole]


class _UnderWay:
    """The progress of one set, which the thread that measures it tells, and the one that waits for it asks for."""

    def __init__(self) -> None:
        self._remaining, self._telling, self._stage = Remaining(USUAL_S["measure_set"]), threading.Lock(), ""

    def __call__(self, step: str, done: int, total: int) -> None:
        with self._telling:
            self._stage = step
            self._remaining.report(step, done, total)

    def now(self) -> SetProgress:
        """How far it is."""
        with self._telling:
            return SetProgress(self._stage, (self._remaining.share or 0.0) if self._stage else 0.0)


def _watched(
    futures: Sequence[Future[SetResult]],
    places: Sequence[tuple[Path, Path]],
    near: Mapping[int, _UnderWay],
    progress: Progress,
    watch: Watch,
) -> tuple[SetResult, ...]:
    """Wait for all, telling how much is done and which; of those `near` also how far they are."""
    waiting, begun, results = dict(enumerate(futures)), set[int](), dict[int, SetResult]()
    whole = PARTS_OF_A_SET * len(futures)
    while waiting:
        under_way = {number: near[number].now() for number in begun - results.keys() if number in near}
        for told in under_way.items():
            watch(told)
        done = len(results) + sum(one.share for one in under_way.values())
        progress(STEP, int(PARTS_OF_A_SET * done), whole)
        wait(waiting.values(), _LOOK_EVERY_S, FIRST_COMPLETED)
        for number, future in list(waiting.items()):
            if future.done():
                del waiting[number]
                results[number] = _result(future, *places[number])
                watch((number, results[number]))
            elif future.running() and number not in begun:
                begun.add(number)
                watch((number, None))
    progress(STEP, whole, whole)
    return tuple(results[number] for number in range(len(futures)))


def _stop(futures: Sequence[Future[SetResult]], stop: Path) -> None:
    """Have no set begun any more, and those under way end."""
    with contextlib.suppress(OSError):
        stop.touch()
    for future in futures:
        future.cancel()
    wait(futures, _LET_END_S)
    with contextlib.suppress(InputError):
        remove(stop)


def _result(future: Future[SetResult], folder: Path, out: Path) -> SetResult:
    try:
        return future.result()
    except Exception as error:  # noqa: BLE001  (the process was killed, the cluster's worker is gone)
        return SetResult(
            folder,
            out,
            error=Message(
                "set.worker_ended",
                "{folder}: whoever measured it has ended ({fault})",
                folder=folder,
                fault=_fault(error),
            ),
        )


def _fault(error: Exception) -> Message:
    kind, reason = type(error).__name__, str(error)
    return Message("set.fault", "an error in the program: {kind}: {reason}", kind=kind, reason=reason[:_LONGEST_REASON])


def _stopped_by(stop: Path, told: Progress) -> Progress:
    """A progress that passes on what it is `told`; it cancels when `stop` appears, or this process is to end."""
    looked = time.monotonic()

    def progress(step: str, done: int, total: int) -> None:
        nonlocal looked
        told(step, done, total)
        if time.monotonic() - looked < _LOOK_EVERY_S:
            return
        looked = time.monotonic()
        if stop.exists() or is_to_end():
            raise Cancelled

    return progress
