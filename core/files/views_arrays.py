"""Views of a target as plain arrays, end to end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.files.arrays_file import Arrays
from core.image.target_view import TargetView

_NO_VIEW = -1


def pack_views(views: Sequence[TargetView | None]) -> dict[str, NDArray[Any]]:
    """Arrays that hold views end to end, with how many points each has; a target that was not found has none."""
    found = [view for view in views if view is not None]
    squares = [view.covariance.ravel() for view in found if view.covariance is not None]
    return {
        "view_lengths": np.array([_NO_VIEW if view is None else len(view.uv) for view in views], np.int64),
        "view_points": np.concatenate([np.zeros((0, 3)), *(view.points for view in found)]),
        "view_uv": np.concatenate([np.zeros((0, 2)), *(view.uv for view in found)]),
        "view_sigma": np.concatenate([np.zeros(0), *(view.sigma for view in found)]),
        "view_shares_errors": np.array([view is not None and view.covariance is not None for view in views]),
        "view_covariance": np.concatenate([np.zeros(0), *squares]),
    }


def unpack_views(names: Sequence[str], arrays: Arrays) -> tuple[TargetView | None, ...]:
    """The views that `pack_views` packed, under `names`; KeyError or ValueError if the arrays do not fit together."""
    lengths = arrays["view_lengths"].tolist()
    sharing = arrays.get("view_shares_errors", np.zeros(len(lengths), dtype=np.bool_)).tolist()  # earlier versions
    views: list[TargetView | None] = []
    first = square = 0
    for name, length, shares in zip(names, lengths, sharing, strict=True):
        if length == _NO_VIEW:
            views.append(None)
            continue
        part = slice(first, first + length)
        points, uv, sigma = (arrays[f"view_{column}"][part] for column in ("points", "uv", "sigma"))
        covariance = None
        if shares:
            size = 2 * length
            covariance = arrays["view_covariance"][square : square + size**2].reshape(size, size)
            square += size**2
        views.append(TargetView(points, uv, sigma, name, covariance))
        first += length
    return tuple(views)
