"""What one picture shows of a calibration target: its points, or that it is not found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.errors import InputError
from core.image.targets.kinds import Target
from core.messages import Message
from core.model.arrays import Array, frozen_array, set_field


@dataclass(frozen=True, eq=False, slots=True)
class TargetView:
    """View of a target: its marked points found in one picture.

    Parameters
    ----------
    points
        (N, 3) in mm in the target's frame, z = 0.
    uv
        (N, 2) in pixels, where they were found.
    sigma
        (N,) standard uncertainty of each coordinate of `uv`, in pixels.
    name
        The picture they were found in, for messages.
    covariance
        (2N, 2N) of the stacked `uv` in square pixels, where the points share their errors (corners on common edges);
        None: independent, with `sigma`.
    placed
        False if the points are a part of a regular pattern that may as well be another part of it: they tell the
        target's plane, but neither its origin nor its shape.
    target
        Which one; None: not known.
    """

    points: Array
    uv: Array
    sigma: Array
    name: str = ""
    covariance: Array | None = None
    placed: bool = True
    target: Target | None = None

    def __post_init__(self) -> None:
        count = len(self.points)
        set_field(self, "points", frozen_array(self.points, (count, 3), "points"))
        set_field(self, "uv", frozen_array(self.uv, (count, 2), "uv"))
        set_field(self, "sigma", frozen_array(self.sigma, (count,), "sigma"))
        if self.covariance is not None:
            set_field(self, "covariance", frozen_array(self.covariance, (2 * count, 2 * count), "covariance"))

    def whitened(self, values: Array) -> Array:
        """Divide `values` (N, 2, …) in px by the points' uncertainty, to (2N, …) of unit variance."""
        stacked = values.reshape(2 * len(self.uv), *values.shape[2:])
        if self.covariance is None:
            scale = np.repeat(self.sigma, 2).reshape(-1, *(1,) * (stacked.ndim - 1))
            return np.asarray(stacked / scale, dtype=np.float64)
        return np.asarray(np.linalg.solve(np.linalg.cholesky(self.covariance), stacked), dtype=np.float64)


class TargetNotFound(InputError):
    """Error that a picture does not show the whole target; the message tells what it shows instead."""


class OtherBoard(TargetNotFound):
    """Error that a picture shows the whole of a board of another size, `counted` columns and rows.

    Both are counted as the target that was looked for counts them: corners, squares or circles.
    """

    def __init__(
        self, what: Message | str, *, where: object = "", todo: Message | str = "", counted: tuple[int, int]
    ) -> None:
        super().__init__(what, where=where, todo=todo)
        self.counted = counted

    def __reduce__(self) -> tuple[object, ...]:
        return _other_board, (self.what, self.where, self.todo, self.counted)


def _other_board(what: Message, where: Message | str, todo: Message, counted: tuple[int, int]) -> OtherBoard:
    """An OtherBoard that came from another process."""
    return OtherBoard(what, where=where, todo=todo, counted=counted)


LEAVE_OUT_OR_RETAKE = Message("advice.leave_out_or_retake", "leave the picture out or take it again")
