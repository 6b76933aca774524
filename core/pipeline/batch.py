"""Many recording sets in one call, side by side on whatever executor is handed in."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path

from core.errors import Cancelled, InputError
from core.files.atomic import cannot_write, make_folder
from core.files.reading import refused_path, resolved
from core.files.recording.options import Options
from core.messages import Message, label
from core.pipeline.run import RunResult, run
from core.progress import Progress, silent

STOP = ".stop"
"""This file in the batch's folder stops all sets that are being measured, on whatever machine that sees it."""

STEP = label("measuring sets")
_LOOK_EVERY_S = 0.5
"""How often in s it is looked whether a set is done or the batch is to stop."""
_LET_END_S = 30.0
"""How long in s the sets under way may take to stop, once they are told to."""
FAULT = "set.fault"
"""Code of what a set failed by when the program was at fault, not the set."""
_LONGEST_REASON = 200
"""Characters of another library's words."""


@dataclass(frozen=True, slots=True)
class SetResult:
    """What became of one recording set.

    Parameters
    ----------
    folder, out
        The set, and where its results are.
    thickness_mm, U_mm, verdict
        None and "" where no thickness was measured or no verdict asked for.
    points, frames, frames_used
        Of the scan.
    seconds
        Time taken.
    error
        Why it could not be measured; None if it could.
    """

    folder: Path
    out: Path
    thickness_mm: float | None = None
    U_mm: float | None = None
    verdict: str = ""
    points: int = 0
    frames: int = 0
    frames_used: int = 0
    seconds: float = 0.0
    error: Message | None = None


def run_batch(
    sets: Sequence[Path], out: Path, executor: Executor, options: Options | None = None, progress: Progress = silent
) -> tuple[SetResult, ...]:
    """Measure recording sets side by side; one that cannot be measured does not keep the others from it.

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
        Called with how many are done; may raise Cancelled: sets being measured then stop, what is finished stays.

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
    _remove(stop)
    chosen = options or Options()
    futures = [executor.submit(measure_set, folder, place, chosen, stop) for folder, place in places]
    try:
        _watch(futures, progress)
    except BaseException:
        _stop(futures, stop)
        raise
    return tuple(_result(future, *place) for future, place in zip(futures, places, strict=True))


def measure_set(folder: Path, out: Path, options: Options, stop: Path) -> SetResult:
    """Measure one set, in whatever process this is; `stop` is a file that ends it with Cancelled when it appears."""
    began = time.perf_counter()
    try:
        measured = run(folder, out, options, _stopped_by(stop))
    except InputError as error:
        return SetResult(folder, out, seconds=time.perf_counter() - began, error=error.message)
    except Cancelled:
        raise
    except Exception as error:  # noqa: BLE001  (a fault in one set must not cost the others)
        refused = refused_path(error)
        told = _fault(error) if refused is None else refused.message
        return SetResult(folder, out, seconds=time.perf_counter() - began, error=told)
    return _measured(folder, out, measured, time.perf_counter() - began)


def _measured(folder: Path, out: Path, measured: RunResult, seconds: float) -> SetResult:
    gauge = measured.gauge
    return SetResult(
        folder,
        out,
        thickness_mm=None if gauge is None else gauge.thickness_mm,
        U_mm=None if gauge is None else gauge.U_mm,
        verdict="" if gauge is None else gauge.verdict,
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


def _watch(futures: Sequence[Future[SetResult]], progress: Progress) -> None:
    """Wait for all, telling how many are done."""
    waiting = set(futures)
    while waiting:
        progress(STEP, len(futures) - len(waiting), len(futures))
        waiting = wait(waiting, _LOOK_EVERY_S, FIRST_COMPLETED).not_done
    progress(STEP, len(futures), len(futures))


def _stop(futures: Sequence[Future[SetResult]], stop: Path) -> None:
    """Have no set begun any more, and those under way end."""
    with contextlib.suppress(OSError):
        stop.touch()
    for future in futures:
        future.cancel()
    wait(futures, _LET_END_S)
    with contextlib.suppress(InputError):
        _remove(stop)


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


def _remove(stop: Path) -> None:
    try:
        stop.unlink(missing_ok=True)
    except OSError as error:
        raise cannot_write(stop, error) from error


def _stopped_by(stop: Path) -> Progress:
    """A progress that cancels when the file `stop` appears."""
    looked = time.monotonic()

    def progress(step: str, done: int, total: int) -> None:
        nonlocal looked
        if time.monotonic() - looked < _LOOK_EVERY_S:
            return
        looked = time.monotonic()
        if stop.exists():
            raise Cancelled

    return progress
