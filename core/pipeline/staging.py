"""Results of several steps that replace the old ones together, or not at all."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from core.files.atomic import cannot_write, make_folder

BESIDE = ".new"
"""The folder among the results in which new ones are made."""


@contextmanager
def staged(results: Path, names: Sequence[str]) -> Iterator[Path]:
    """A folder to make new results in; if all goes well, they take the place of the old ones.

    Parameters
    ----------
    results
        Where the results belong; made if it is not there.
    names
        The files that belong together: old ones go even where there is no new one. All of them go before the first
        new one comes, so that whoever pulls the plug finds old ones or new ones, perhaps not all, but never both.

    Raises
    ------
    InputError
        If nothing can be written there.
    """
    make_folder(results)
    beside = results / BESIDE
    shutil.rmtree(beside, ignore_errors=True)  # of a run that was killed
    make_folder(beside)
    try:
        yield beside
        _replace(results, beside, names)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _replace(results: Path, beside: Path, names: Sequence[str]) -> None:
    try:
        for name in names:
            (results / name).unlink(missing_ok=True)
        for name in names:
            if (beside / name).exists():
                (beside / name).replace(results / name)
    except OSError as error:
        raise cannot_write(results, error) from error
