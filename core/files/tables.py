"""Kinds of values that the tables of several files have in common, checked by pydantic."""

from __future__ import annotations

import math
from collections.abc import Mapping
from datetime import date, datetime
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    WrapValidator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from core.calibrate.results import PlanePose, ViewQuality
from core.files.complaints import Clash
from core.files.limits import LARGEST
from core.inspect.causes import Source, known_cause
from core.inspect.results import Contribution
from core.messages import Message, as_json, from_json, label
from core.model import Pose


def _aware(value: object) -> object:
    if not isinstance(value, str):
        return value
    time = datetime.fromisoformat(value)
    if time.tzinfo is None:
        raise ValueError("no time zone")
    return time


TIME_WORDS = label("a date and time with its zone, as in 2025-01-31T12:00:00+00:00")
Time = Annotated[datetime, BeforeValidator(_aware), Field(description=TIME_WORDS)]


def _date(value: object) -> object:
    return date.fromisoformat(value) if isinstance(value, str) else value


OptionalDay = Annotated[date | None, BeforeValidator(_date), Field(description=label("a date, as 2028-03-01"))]

ShortText = Annotated[str, Field(max_length=100, description=label("a text of at most 100 letters"))]


def _bounded(value: float) -> float:
    if abs(value) > LARGEST:
        raise PydanticCustomError("finite_number", "a finite number")
    return value


Finite = Annotated[float, Field(allow_inf_nan=False), AfterValidator(_bounded)]
OrNan = Annotated[Finite, WrapValidator(lambda value, check: math.nan if value is None else check(value))]
"""A number, NaN where the file has none: null, or nothing at all."""
OrInfinite = Annotated[Finite, WrapValidator(lambda value, check: math.inf if value is None else check(value))]
"""A number, infinity where the file has none."""
Probability = Annotated[Finite, Field(ge=0, le=1, description="a probability, 0 to 1")]
LengthAbove0 = Annotated[Finite, Field(gt=0, description="a length in mm above 0")]
Row3 = Annotated[list[Finite], Field(min_length=3, max_length=3)]
Row2 = Annotated[list[Finite], Field(min_length=2, max_length=2)]


def _message(kept: object) -> Message:
    if isinstance(kept, (str, Mapping)):
        try:
            return from_json(kept)
        except (KeyError, TypeError, AttributeError):
            pass
    raise ValueError("is neither a text nor a message with code, text and values")


KeptMessage = Annotated[Message, PlainValidator(_message)]
"""A message in a file: as `core.messages.as_json` writes it, or the bare sentence of an older file."""
OptionalMessage = Annotated[Message | None, PlainValidator(lambda kept: _message(kept) if kept else None)]
"""The same, or nothing: null, or '' in older files."""


KeptCause = Annotated[Source, PlainValidator(lambda kept: known_cause(_message(kept)))]
"""What a row of a budget comes from; the file has its code and words, older ones the English words alone."""


def kept(message: Message | None) -> dict[str, Any] | str | None:
    """Convert a message to what JSON holds: a table, a bare text if it has no code, None for None."""
    if message is None:
        return None
    return as_json(message) if message.code else str(message)


RESULT = ConfigDict(extra="ignore", strict=True, frozen=True)
"""Of a file of results: keys may be added by others, and are then ignored."""


class ResultFile(BaseModel):
    """File of results, or a table in one."""

    model_config = RESULT


_VECTOR = label("three finite numbers, not all zero")


class PlaneRow(ResultFile):
    """Row of a plane π·X = 1, with all else that is stored of it."""

    pi: Row3 = Field(description=_VECTOR)

    @model_validator(mode="after")
    def _is_a_plane(self) -> Self:
        if not any(self.pi):
            raise Clash("pi", Message("fan.zero_vector", "is [0, 0, 0], not {vector}", vector=_VECTOR))
        return self


class CountedPose(ResultFile):
    """Picture of a target: whether it counts, and where the target was in the camera's frame."""

    name: str
    used: bool
    reason: OptionalMessage = None
    rotation_vector: Row3
    translation_mm: Row3

    def pose(self) -> Pose:
        """Make the pose of the target in the camera frame from the row's numbers."""
        return Pose.from_vector([*self.rotation_vector, *self.translation_mm])


def counted_pose(view: ViewQuality | PlanePose, **figures: Any) -> dict[str, Any]:
    """Make the row of a view or pose for a file: name, whether and why not used, `figures`, and the target's pose."""
    vector = view.pose.vector
    head = {"name": view.name, "used": view.used, "reason": kept(view.reason)}
    return head | figures | {"rotation_vector": vector[:3], "translation_mm": vector[3:]}


class BudgetRow(ResultFile):
    """Row of a budget without its contribution, which each file calls by a key of its own."""

    source: KeptCause
    point_mm: Finite | None = None
    distribution: str = "normal"
    dof: Finite | None = Field(default=None, ge=1, description="a number of at least 1, or null for infinitely many")
    value: Finite | None = None
    unit: str = "mm"

    def contributing(self, u: float) -> Contribution:
        """Make the budget's contribution that this row describes, `u` being its standard uncertainty."""
        dof = math.inf if self.dof is None else self.dof
        return Contribution(self.source, u, self.point_mm, self.distribution, dof, self.value, self.unit)


def row_tables(row: Contribution, key: str) -> dict[str, Any]:
    """Make the table of a contribution to a budget, its standard uncertainty in mm under `key`."""
    return {
        "source": kept(row.words),
        key: row.u_mm,
        "point_mm": row.point_mm,
        "distribution": row.distribution,
        "dof": row.dof,
        "value": row.value,
        "unit": row.unit,
        "sensitivity": row.sensitivity,
    }
