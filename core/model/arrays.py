"""Arrays that frozen dataclasses hold: float64, contiguous, read-only."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import WrongValue
from core.messages import Message

Array = NDArray[np.float64]


def frozen_array(values: ArrayLike, shape: tuple[int | None, ...], name: str) -> Array:
    """Copy `values` to a read-only float64 array, checked to have this `shape`; None in it stands for any length.

    Raises
    ------
    WrongValue
        If the shape does not match; the message names `name`.
    """
    array = np.array(values, dtype=np.float64)
    if array.ndim != len(shape) or any(
        want is not None and have != want for have, want in zip(array.shape, shape, strict=True)
    ):
        wanted = " × ".join("n" if n is None else str(n) for n in shape)
        raise WrongValue(
            Message(
                "model.wrong_shape",
                "{name} has shape {shape}, not {wanted}",
                name=name,
                shape=str(array.shape),
                wanted=wanted,
            )
        )
    array.flags.writeable = False
    return array


def set_field(instance: object, name: str, value: Any) -> None:
    """Set the field `name` of a frozen dataclass to `value`, from its own ``__post_init__``."""
    object.__setattr__(instance, name, value)


def runs_of(chosen: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Find the unbroken runs of True in `chosen` (N,): for each the first index, and one past the last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
