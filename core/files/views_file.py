"""What the pictures of the camera's target showed, so that the camera can be solved again without them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.calibrate.seen_views import SeenView, SeenViews
from core.errors import InputError
from core.files.arrays_file import pack_texts, read_arrays, write_arrays
from core.files.views_arrays import pack_views, unpack_views

_TODO = "calibrate the camera again"


def write_views(path: Path, key: str, seen: SeenViews) -> None:
    """Write what was seen, under the `key` of what it rests on; InputError if it cannot be written."""
    arrays: dict[str, NDArray[Any]] = {
        "key": np.array(key),
        "where": np.array(seen.where),
        "names": pack_texts([one.name for one in seen.views]),
        "reasons": pack_texts([one.reason for one in seen.views]),
        "sizes": np.array([one.size or (0, 0) for one in seen.views], dtype=np.int64).reshape(-1, 2),
        **pack_views([one.view for one in seen.views]),
    }
    write_arrays(path, arrays)


def read_views(path: Path, key: str) -> SeenViews | None:
    """Read what was seen; None if it is not there, or rests on something else than `key`.

    Raises
    ------
    InputError
        If it is damaged or its arrays do not fit together.
    """
    if not path.exists():
        return None
    arrays = read_arrays(path, ("key", "names"), todo=_TODO)
    if str(arrays["key"]) != key:
        return None
    try:
        names = arrays["names"].tolist()
        columns = zip(names, unpack_views(names, arrays), arrays["reasons"].tolist(), arrays["sizes"], strict=True)
        views = tuple(
            SeenView(name, view, reason, (int(size[0]), int(size[1])) if size.any() else None)
            for name, view, reason, size in columns
        )
        return SeenViews(views, str(arrays["where"]))
    except KeyError as error:
        raise InputError(f"the array {error} is missing", where=path, todo=_TODO) from error
    except (ValueError, TypeError) as error:
        raise InputError(f"its arrays do not fit together ({error})", where=path, todo=_TODO) from error
