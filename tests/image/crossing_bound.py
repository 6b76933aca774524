"""How well a crossing can be known at all: Cramér–Rao, by numerical Fisher information.

A line is seen as the offset of each pixel of its length across itself, with white noise of a given density: N0, the
error of one pixel of stripe, so that a mean over L px has N0/√L. Which bound is meant depends on what is known of the
lines before: that they are straight, that they are parabolas, or that their curvature is a random process of known
standard deviation and correlation length (then it is the Bayesian bound, and kriging that knows them reaches it).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEP = 1e-4


@dataclass(frozen=True)
class Line:
    """What is known of one line: N0 in px·√px, its ends in px from the crossing, degree of the curve."""

    density: float
    first: float
    last: float
    degree: int = 1

    @property
    def along(self) -> Array:
        """Middles of its pixels."""
        count = round(self.last - self.first)
        return self.first + (np.arange(count) + 0.5) * (self.last - self.first) / count


def section_density(height: float, width: float, read: float, grey_per_electron: float) -> float:
    """N0 of a stripe of Gaussian section in pixels with read and shot noise, its other parameters known."""
    x = np.linspace(-8 * width, 8 * width, 4001)
    section = height * np.exp(-0.5 * (x / width) ** 2)
    information = np.trapezoid((x / width**2 * section) ** 2 / (read**2 + grey_per_electron * section), x)
    return float(1 / np.sqrt(information))


def crossing_bound(a: Line, b: Line, angle: float) -> Array:
    """Least covariance (2, 2) in px² of the place where two lines meet at `angle` (rad); a lies along u."""
    information = np.zeros((2 + a.degree + b.degree,) * 2)
    for line, direction, own in ((a, 0.0, slice(2, 2 + a.degree)), (b, angle, slice(2 + a.degree, None))):
        size = len(information)
        columns = []
        for which in range(size):
            step = np.zeros(size)
            step[which] = STEP
            columns.append((_offsets(line, direction, step, own) - _offsets(line, direction, -step, own)) / (2 * STEP))
        jacobian = np.column_stack(columns)
        per_pixel = (line.last - line.first) / len(line.along)
        information += jacobian.T @ jacobian * per_pixel / line.density**2
    return np.asarray(np.linalg.inv(information)[:2, :2])


def _offsets(line: Line, direction: float, parameters: Array, own: slice) -> Array:
    """Offset of each pixel across the line. Parameters: (u, v) of the crossing, then tilt, bend, … of each line."""
    normal = np.array([-np.sin(direction), np.cos(direction)])
    x = line.along / 100.0
    powers = np.column_stack([x ** (k + 1) for k in range(line.degree)])
    return np.asarray(parameters[:2] @ normal + powers @ parameters[own])


def curvature_integral(x: Array) -> Array:
    """(N, N): from y'' at the places `x` to y, both y and y' being zero in the middle."""
    middle = len(x) // 2
    integral = np.zeros((len(x), len(x)))
    for i in range(len(x)):
        between = slice(middle, i) if i > middle else slice(i + 1, middle + 1)
        integral[i, between] = np.abs(x[i] - x[between])
    return integral * (x[1] - x[0])


def kriging_bound(density: float, x: Array, curvature: float, length: float) -> float:
    """Least σ in px of the middle of a line whose curvature is an Ornstein–Uhlenbeck process."""
    integral = curvature_integral(x)
    process = curvature**2 * np.exp(-np.abs(x[:, None] - x) / length)
    covariance = integral @ process @ integral.T + density**2 / (x[1] - x[0]) * np.eye(len(x))
    free = np.column_stack([np.ones(len(x)), x])
    return float(np.sqrt(np.linalg.inv(free.T @ np.linalg.solve(covariance, free))[0, 0]))
