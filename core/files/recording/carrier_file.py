"""carrier.toml: the reference marks of a carrier, as calibrated, read and written.

radius_mm = 3.5               # of the discs
scaled_by_target = true       # calibrated by the rig's own plane target; left out: it was not
as_printed = false            # nobody has measured the marks
celsius = 21.5                # of the carrier while the views are taken; positions are at 20 °C
u_celsius = 0.5
alpha_per_K = 23e-6
u_alpha_per_K = 1e-6
covariance_mm2 = [[...], ...] # of all coordinates, mark by mark; or u_mm at each mark, if nothing is shared

[[mark]]
number = 0
side = "A"
position_mm = [-85.0, 65.0, 2.0]
u_mm = [0.003, 0.003, 0.006]
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from core.errors import InputError
from core.files.atomic import write_text
from core.files.complaints import checked, fitting
from core.files.reading import read_toml
from core.files.recording.rig import WARMTH, Table, require_pairs
from core.files.tables import ShortText
from core.files.toml_text import toml_text
from core.image.targets.coded_rings import code_words
from core.inspect.uncertainty.part import TargetTemperature
from core.messages import Message, label
from core.model.arrays import Array
from core.views.carrier import Carrier

_SIDES = "AB"
_AN_ALPHA = label("an expansion coefficient in 1/K, as 11.5e-6")
_MISSING = Message("views.carrier_missing", "there is no carrier.toml, which says where the carrier's marks are")
_CALIBRATE = Message(
    "views.advice_calibrate_carrier", "have the marks on both sides of the carrier measured, and put the file there"
)


_Place = Annotated[float, Field(ge=-1e4, le=1e4)]
_Length = Annotated[float, Field(gt=0, le=100)]
_Squared = Annotated[float, Field(ge=-1e4, le=1e4)]


class _Mark(Table):
    """A mark."""

    number: int = Field(ge=0, le=999, description=label("a whole number from 0 to 999"))
    side: Literal["A", "B"] = "A"
    position_mm: list[_Place] = Field(min_length=3, max_length=3, description=label("three places in mm within 10 m"))
    u_mm: list[_Length] = Field(min_length=3, max_length=3, description=label("three lengths in mm above 0, up to 100"))


class _CarrierTables(Table):
    """carrier.toml."""

    kind: Literal["ring"] = Field("ring", description=label('"ring": balls are not found in views yet'))
    radius_mm: float = Field(gt=0, le=100, allow_inf_nan=False, description=label("a length in mm above 0"))
    scaled_by_target: bool = False
    as_printed: bool = False
    celsius: float | None = Field(None, ge=-50, le=200, description=label("a temperature in °C from −50 to 200"))
    u_celsius: float | None = Field(None, ge=0, le=200, description=label("a temperature, 0 to 200 K"))
    alpha_per_K: float | None = Field(None, ge=-1e-4, le=1e-3, description=_AN_ALPHA)  # noqa: N815
    u_alpha_per_K: float | None = Field(None, ge=0, le=1e-3, description=_AN_ALPHA)  # noqa: N815
    name: ShortText = ""
    covariance_mm2: list[list[_Squared]] = Field(
        default_factory=list, description=label("rows of numbers in mm² from -10,000 to 10,000")
    )
    mark: list[_Mark] = Field(min_length=1)

    @model_validator(mode="after")
    def _with_u(self) -> _CarrierTables:
        require_pairs(self, WARMTH)
        return self


def read_carrier(path: Path) -> Carrier:
    """Read and check the carrier in a carrier.toml; InputError if it is missing or wrong."""
    tables = checked(_CarrierTables, read_toml(path, missing=_MISSING, todo=_CALIBRATE), path)
    marks = tables.mark
    if tables.kind == "ring" and (missing := [mark.number for mark in marks if mark.number >= len(code_words())]):
        raise InputError(
            Message("views.no_such_ring", "there is no coded ring {number}: their numbers are 0 to {last}",
                    number=missing[0], last=len(code_words()) - 1),
            where=path,
            todo=_CALIBRATE,
        )  # fmt: skip
    with fitting(path):
        return Carrier(
            np.array([mark.number for mark in marks]),
            np.array([_SIDES.index(mark.side) for mark in marks]),
            np.array([mark.position_mm for mark in marks]),
            _covariance(tables, path),
            tables.radius_mm,
            tables.scaled_by_target,
            tables.name,
            TargetTemperature(tables.celsius, tables.u_celsius, tables.alpha_per_K, tables.u_alpha_per_K),
            tables.as_printed,
        )


def _covariance(tables: _CarrierTables, path: Path) -> Array:
    """That of the file, or by each mark's own u; InputError if it is none."""
    own = np.array([mark.u_mm for mark in tables.mark]).ravel()
    if not tables.covariance_mm2:
        return np.diag(own**2)
    rows = tables.covariance_mm2
    if len(rows) != len(own) or any(len(row) != len(own) for row in rows):
        raise InputError(
            Message("views.carrier_covariance_size", "covariance_mm2 is not {n} × {n} for {marks} marks",
                    n=len(own), marks=len(tables.mark)),
            where=path,
            todo=_CALIBRATE,
        )  # fmt: skip
    covariance = np.array(rows)
    smallest = float(np.linalg.eigvalsh((covariance + covariance.T) / 2).min())
    no_variance = float(np.diag(covariance).min()) <= 0
    if (
        no_variance
        or not np.allclose(covariance, covariance.T)
        or smallest < -1e-9 * max(float(np.trace(covariance)), 1e-12)
    ):
        raise InputError(
            Message("views.no_covariance", "covariance_mm2 is no covariance: it is not symmetric and positive"),
            where=path,
            todo=_CALIBRATE,
        )
    return covariance


def write_carrier(path: Path, carrier: Carrier) -> None:
    """Write a carrier as a file carrier.toml for `read_carrier`; InputError if it cannot be written."""
    marks = [
        {
            "number": int(number),
            "side": _SIDES[side],
            "position_mm": [round(float(value), 6) for value in position],
            "u_mm": [float(f"{value:.4g}") for value in u],
        }
        for number, side, position, u in zip(
            carrier.numbers, carrier.sides, carrier.positions, carrier.sigma, strict=True
        )
    ]
    warmth = carrier.temperature
    stated = zip(
        ("celsius", "u_celsius", "alpha_per_K", "u_alpha_per_K"),
        (warmth.celsius, warmth.u_celsius, warmth.alpha, warmth.u_alpha),
        strict=True,
    )
    tables = {
        "name": carrier.name,
        "radius_mm": carrier.radius_mm,
        "scaled_by_target": carrier.scaled_by_target,
        "as_printed": carrier.as_printed,
        **{name: value for name, value in stated if value is not None},
        "covariance_mm2": [[float(f"{value:.7g}") for value in row] for row in carrier.covariance],
        "mark": marks,
    }
    write_text(path, toml_text(tables), sync=False)
