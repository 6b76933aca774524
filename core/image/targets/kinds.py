"""The calibration targets: what is printed on them, in mm, z = 0.

Every target's x axis runs to the right and its y axis down when it is looked at from its printed side, so z points
away from the camera.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np

from core.errors import WrongValue
from core.messages import Message, label
from core.model.arrays import Array

USUAL: Mapping[str, tuple[int, int, float]] = {
    "checkerboard": (17, 12, 10.0),
    "charuco": (12, 9, 15.0),
    "circle_grid": (13, 10, 14.0),
    "black_square": (1, 1, 60.0),
}
"""Columns, rows and size in mm where none are given: those of the simulated rig; all fit A4."""

USUAL_MARKER = 0.75
"""Side of a marker over that of its square."""


@dataclass(frozen=True, slots=True)
class Checkerboard:
    """Checkerboard with `columns` × `rows` inner corners and squares of `square_mm`.

    The first corner is the one whose square diagonally outside is black; where the board allows several (columns + rows
    even), or none, that of them nearest to the top left of the picture.
    """

    columns: int
    rows: int
    square_mm: float

    def __post_init__(self) -> None:
        _check_grid(self.columns, self.rows, 3, label("inner corners"))
        _check_length(self.square_mm, "square_mm")

    @property
    def points(self) -> Array:
        """Inner corners of the board (N, 3) in mm, row by row; the first one is the origin."""
        return _grid(self.columns, self.rows, self.square_mm)


DICTIONARIES = (
    *(f"DICT_{side}X{side}_{count}" for side in (4, 5, 6, 7) for count in (50, 100, 250, 1000)),
    *(f"DICT_APRILTAG_{family}" for family in ("16H5", "25H9", "36H10", "36H11")),
)
"""Markers that a ChArUco board may have, by OpenCV's names; an AprilTag's "h" may be small as well."""


@dataclass(frozen=True, slots=True)
class Charuco:
    """Checkerboard of `columns` × `rows` squares of `square_mm`, with markers of `marker_mm` in its white ones.

    `dictionary` is OpenCV's name of the markers, with or without "DICT_" in front. Any part of the board will do.
    `first_id` is the number of the first marker: boards that share none are told apart in one picture.
    """

    columns: int
    rows: int
    square_mm: float
    marker_mm: float
    dictionary: str = "DICT_4X4_50"
    first_id: int = 0

    def __post_init__(self) -> None:
        if self.first_id < 0:
            raise WrongValue(
                Message("target.first_id_negative", "first_id must not be negative, not {value}", value=self.first_id)
            )
        _check_grid(self.columns, self.rows, 3, label("squares"))
        _check_length(self.square_mm, "square_mm")
        _check_length(self.marker_mm, "marker_mm")
        if self.marker_mm >= self.square_mm:
            raise WrongValue(
                Message(
                    "target.marker_too_large",
                    "marker_mm ({marker_mm:g}) must be smaller than square_mm ({square_mm:g})",
                    marker_mm=self.marker_mm,
                    square_mm=self.square_mm,
                )
            )
        if not hasattr(cv2.aruco, self.dictionary_id):
            raise WrongValue(
                Message(
                    "target.dictionary_unknown",
                    "dictionary {dictionary!r} is not one of OpenCV's, such as DICT_4X4_50",
                    dictionary=self.dictionary,
                )
            )

    @property
    def dictionary_id(self) -> str:
        """OpenCV's full name of the dictionary of the board's markers."""
        name = self.dictionary.upper()
        return name if name.startswith("DICT_") else f"DICT_{name}"

    @property
    def points(self) -> Array:
        """Inner corners of the board (N, 3) in mm, row by row; the origin is the board's outer corner."""
        return _grid(self.columns - 1, self.rows - 1, self.square_mm) + [self.square_mm, self.square_mm, 0.0]


@dataclass(frozen=True, slots=True)
class CircleGrid:
    """Dark circles on a light ground, `columns` × `rows`.

    Symmetric: neighbours `pitch_mm` apart. Asymmetric: rows `pitch_mm` apart, circles of a row 2 `pitch_mm` apart,
    every second row moved by `pitch_mm` (OpenCV's asymmetric grid). A symmetric grid looks the same turned by 180° (by
    90° if square): the first circle is then the one nearest to the top left of the picture.
    """

    columns: int
    rows: int
    pitch_mm: float
    asymmetric: bool = False

    def __post_init__(self) -> None:
        _check_grid(self.columns, self.rows, 3, label("circles"))
        _check_length(self.pitch_mm, "pitch_mm")

    @property
    def points(self) -> Array:
        """Centres of the circles (N, 3) in mm, row by row; the first one is the origin."""
        points = _grid(self.columns, self.rows, self.pitch_mm)
        if self.asymmetric:
            odd = np.arange(len(points)) // self.columns % 2
            points[:, 0] = 2 * points[:, 0] + odd * self.pitch_mm
        return points


@dataclass(frozen=True, slots=True)
class BlackSquare:
    """Plane target of the paper: one black square of `side_mm` on a light plate.

    A plain square looks the same turned by 90°. The convention: corner 1 is the corner nearest to the top left of the
    picture (smallest u + v), and corners 1 … 4 run clockwise in the picture; in the target's frame they are (0, 0),
    (s, 0), (s, s), (0, s). A square that is turned about its normal between two pictures may so change its numbering:
    nothing that rests on the plane alone (the fan's calibration) depends on it.
    """

    side_mm: float

    def __post_init__(self) -> None:
        _check_length(self.side_mm, "side_mm")

    @property
    def points(self) -> Array:
        """The four corners (4, 3) of the square in mm."""
        s = self.side_mm
        return np.array([[0.0, 0.0, 0.0], [s, 0.0, 0.0], [s, s, 0.0], [0.0, s, 0.0]])


@dataclass(frozen=True, slots=True)
class Rectangle:
    """Printed rectangle on a light ground: dark throughout, or drawn as an outline of `line_mm`.

    Its frame begins at its outer corner. A rectangle looks the same turned by 180°: its first corner is that of the two
    nearer to the top left of the picture.

    Parameters
    ----------
    width_mm, height_mm
        Of its outer edges.
    line_mm
        Width of the outline; 0: dark throughout.
    corners_px
        Where in the picture its four outer corners are about, [u, v] each, in any order; None: they are searched for.
    """

    width_mm: float
    height_mm: float
    line_mm: float = 0.0
    corners_px: tuple[tuple[float, float], ...] | None = None

    def __post_init__(self) -> None:
        _check_length(self.width_mm, "width_mm")
        _check_length(self.height_mm, "height_mm")
        if not 0 <= 2 * self.line_mm < min(self.width_mm, self.height_mm):
            raise WrongValue(
                Message(
                    "target.line_too_wide",
                    "line_mm must be from 0 to less than half of the shorter side, not {line_mm:g}",
                    line_mm=self.line_mm,
                )
            )

    @property
    def points(self) -> Array:
        """The four outer corners in mm, then the four inner ones if it is an outline: (4, 3) or (8, 3)."""
        rims = (0.0, self.line_mm) if self.line_mm else (0.0,)
        return np.array(
            [
                [x, y, 0.0]
                for rim in rims
                for x, y in (
                    (rim, rim),
                    (self.width_mm - rim, rim),
                    (self.width_mm - rim, self.height_mm - rim),
                    (rim, self.height_mm - rim),
                )
            ]
        )


Target = Checkerboard | Charuco | CircleGrid | BlackSquare | Rectangle


def _grid(columns: int, rows: int, step: float) -> Array:
    """Points (columns · rows, 3) of a grid, row by row."""
    y, x = np.divmod(np.arange(columns * rows), columns)
    return np.column_stack([x * step, y * step, np.zeros(columns * rows)])


_MOST = 500
"""In a row or column: as many as rig.toml may state."""
_SHORTEST_MM, _LONGEST_MM = 1e-3, 5000.0
"""From a photomask's to the largest that rig.toml may state."""


def _check_grid(columns: int, rows: int, least: int, what: str) -> None:
    if min(columns, rows) < least:
        raise WrongValue(
            Message(
                "target.grid_too_small",
                "{columns} × {rows} {what} are too few: at least {least} × {least}",
                columns=columns,
                rows=rows,
                what=what,
                least=least,
            )
        )
    if max(columns, rows) > _MOST:
        raise WrongValue(
            Message(
                "target.grid_too_large",
                "{columns} × {rows} {what} are too many: at most {most} in a row",
                columns=columns,
                rows=rows,
                what=what,
                most=_MOST,
            )
        )


def _check_length(value: float, name: str) -> None:
    if not (np.isfinite(value) and value > 0):
        raise WrongValue(
            Message("target.length_not_positive", "{name} must be positive, not {value}", name=name, value=value)
        )
    if not _SHORTEST_MM <= value <= _LONGEST_MM:
        raise WrongValue(
            Message(
                "target.length_absurd",
                "{name} must be from {shortest_mm:g} to {longest_mm:g} mm, not {value_mm:g}",
                name=name,
                shortest_mm=_SHORTEST_MM,
                longest_mm=_LONGEST_MM,
                value_mm=value,
            )
        )
