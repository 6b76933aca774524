"""profile.json: the step that each picture of the fan alone gives; profiles.csv: all profiles, point by point."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from core import __version__
from core.files.atomic import write_bytes
from core.files.complaints import checked_json
from core.files.json_text import write_json
from core.files.reading import read_json
from core.files.results.gauge_file import gauge_summary
from core.files.tables import RESULT, Finite, OptionalMessage, OrNan, kept
from core.inspect.results import GaugeResult
from core.messages import Command, Message
from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud

_TODO = Message(
    "advice.measure_profiles_first",
    "measure the profiles first{command}",
    command=Command("trisect profile SET --out DIR"),
)


@dataclass(frozen=True, slots=True)
class PictureStep:
    """Result of one picture: its thickness and its own standard uncertainty in mm; or the reason why it has none."""

    index: int
    name: str
    thickness_mm: OrNan
    own_mm: OrNan
    points: tuple[int, int]
    reason: OptionalMessage = None
    __pydantic_config__ = RESULT

    @property
    def used(self) -> bool:
        """Whether the picture gave a thickness: it has no reason against it."""
        return self.reason is None

    @classmethod
    def none(cls, index: int, name: str, reason: Message) -> PictureStep:
        """Make the entry of picture `index` that gave no thickness, for this `reason`."""
        return cls(index, name, math.nan, math.nan, (0, 0), reason)


@dataclass(frozen=True, slots=True)
class ProfileFile:
    """Content of profile.json: the thickness with its U in mm, each picture's step, and which picture is shown."""

    thickness_mm: Finite
    U_mm: Finite
    pictures: tuple[PictureStep, ...]
    shown: int
    calibration_id: str = ""
    __pydantic_config__ = RESULT


def write_profiles(path: Path, gauge: GaugeResult, pictures: Sequence[PictureStep], shown: int, of: str) -> None:
    """Write a profile's thickness, and what each of its pictures gave, as profile.json; InputError if that fails.

    `shown` is the index of the picture whose faces gauge.json has, `of` the calibration's id.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    rows = [{**asdict(one), "reason": kept(one.reason)} for one in pictures]
    summary = gauge_summary(gauge)
    told = {"rule": kept(gauge.rule), "notes": [kept(note) for note in gauge.notes]}
    rest = {"pictures": rows, "shown": shown, "calibration_id": of, "version": __version__}
    write_json(path, {**summary, **told, **rest})


def read_profiles_file(path: Path) -> ProfileFile:
    """Read what each picture of a profile gave from profile.json; InputError if it is missing or wrong."""
    return checked_json(ProfileFile, read_json(path, todo=_TODO), path)


_COLUMNS = {
    "picture": "%d",
    "line": "%d",
    "position_mm": "%.4f",
    "height_mm": "%.4f",
    "sigma_mm": "%.4f",
    "x_mm": "%.4f",
    "y_mm": "%.4f",
    "z_mm": "%.4f",
    "image_u_px": "%.3f",
    "image_v_px": "%.3f",
}


def write_profiles_csv(path: Path, cloud: Cloud, position: Array, height: Array) -> None:
    """Write a profile's points as CSV, a line each: picture, line, position, height, σ of its depth, coordinates.

    `position` and `height` (N,) are in mm. InputError if it cannot be written.
    """
    columns = np.column_stack(
        [cloud.frame, FAN + 1 - cloud.sweep, position, height, cloud.sigma, cloud.points, cloud.uv]
    )
    text = io.StringIO()
    text.write(",".join(_COLUMNS) + "\n")
    np.savetxt(text, columns, fmt=list(_COLUMNS.values()), delimiter=",")
    write_bytes(path, text.getvalue().encode())
