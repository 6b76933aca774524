"""What files of results are checked by."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Maybe = Finite | None
Row3 = Annotated[list[Finite], Field(min_length=3, max_length=3)]
Row2 = Annotated[list[Finite], Field(min_length=2, max_length=2)]


class ResultFile(BaseModel):
    """A file of results: keys may be added by others, and are then ignored."""

    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


def number(value: float | None) -> float:
    """A number of a file, NaN where the file has none."""
    return math.nan if value is None else value
