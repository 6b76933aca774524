"""How a sweep's light plane changes while a camera with a rolling shutter reads its rows out.

The hand goes on meanwhile, so each row of a picture sees another plane: π(v) = Σ_n P_n(t) c_n with Legendre's
polynomials P_n of the time t = −1 … 1 from the first row to the last. c_0 is the plane in the middle, c_1 what a steady
hand adds, the others are its tremor's. Every equation of a scan is linear in π, so it is linear in the stacked c: what
was r for one plane is the form (r P_0, r P_1, …) for many. Two stripes cross in one pixel, that is in one row of both
pictures.

How large c_n can be is a prior. A hand at the speed V moves the sheet by ± V T / 2 over the read-out T, and keeps its
speed over the frames that follow: exp(−|i − j| / KEPT_FRAMES) is the correlation between two. A tremor of amplitude A
and frequency f is another in each frame: A sin(2πfτ + φ) has the coefficients (2n + 1) j_n(πfT) A, times the sine or
cosine of φ, with the spherical Bessel functions j_n. A sheet that is shifted by δ mm at depth z changes by δ|π|/z in
inverse depth.

References
----------
Elble, R. J., Randall, J. E., J. Neurophysiol. 39 (1976), doi:10.1152/jn.1976.39.2.370 (tremor of 8 to 12 Hz).
NIST Digital Library of Mathematical Functions, (10.60.7) (a plane wave in Legendre's polynomials).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.sparse import csr_array
from scipy.special import spherical_jn

from core.model.arrays import Array

TREMOR_HZ = (8.0, 10.0, 12.0)
"""Frequencies of a hand's tremor."""
LEAST_SHIFT_MM = 0.01
"""Terms that move a sheet by less (RMS over the rows) are left out."""
TURNING = 0.4
"""Of a sheet's shift in the middle of the picture, by how much it is another at the edges: a hand turns little in a
picture's time."""
KEPT_FRAMES = 8.0
"""Frames over which a hand keeps its speed: most of a pass over the part."""
NO_SHIFT_MM = 1e-3
"""What stands for no motion at all."""
MOST_TERMS = 5
"""At a read-out of 100 ms no more are needed."""
SLOWEST_READOUT_MS = 71.0
"""Read-out that is tried where none is stated but sweeps are twisted: that of 10.7 MP at 14 frames/s."""


def row_forms(rays: Array, v: Array, rows: int, size: int) -> Array:
    """Compute the factors (N, `size`) that give π·r at `rays` (N, 3), rows `v` (N,), from a plane's coefficients.

    `rows` is how many the picture has.
    """
    if size == 3:
        return rays
    basis = legvander(_time(v, rows), size // 3 - 1)
    return np.asarray((basis[:, :, None] * rays[:, None, :]).reshape(len(rays), size))


def row_planes(coefficients: Array, v: Array, rows: int) -> Array:
    """Compute the planes π (N, 3) in 1/mm that hold in rows `v` (N,), from stacked `coefficients` (N, 3·(1 + K)).

    `coefficients` (1, …) are of one sweep for all rows `v`; `rows` is how many the picture has.
    """
    size = coefficients.shape[1]
    if size == 3:
        return coefficients
    basis = legvander(_time(v, rows), size // 3 - 1)
    return np.asarray((basis[:, :, None] * coefficients.reshape(len(coefficients), -1, 3)).sum(axis=1))


def _time(v: Array, rows: int) -> Array:
    return np.asarray((2 * v + 1) / rows - 1)


def change_per_mm(pis: Array, inverse_depths: Array, rays: Array) -> tuple[float, float, float]:
    """Compute by how much in 1/mm each component of a plane π changes when its sheet of light shifts by 1 mm.

    Of sweeps `pis` (S, 3) that are crossed at `inverse_depths` (M,) on `rays` (M, 3). The shift at the picture's edges
    differs from that in its middle by TURNING of it.
    """
    middle = float(np.median(np.linalg.norm(pis, axis=1)) * np.median(inverse_depths))
    x, y = TURNING * middle / np.abs(rays[:, :2]).max(axis=0)
    return float(x), float(y), middle


@dataclass(frozen=True, slots=True)
class Hand:
    """Motion of a hand that sweeps at about `speed_mm_s`, one way or the other, and trembles by about `tremor_mm`."""

    speed_mm_s: float
    tremor_mm: float

    def steady_mm(self, time_s: float) -> float:
        """Compute the standard deviation in mm of how far a steady hand moves a sheet from mid read-out to its end."""
        return self.speed_mm_s * time_s / 2

    def tremor_terms_mm(self, terms: int, time_s: float) -> Array:
        """Compute the standard deviations (terms,) in mm that tremor adds to the Legendre terms of a sheet's path."""
        n = np.arange(1, terms + 1)
        waves = np.abs([spherical_jn(n, np.pi * f * time_s) for f in TREMOR_HZ]).max(axis=0)
        return np.asarray((2 * n + 1) * waves * self.tremor_mm / np.sqrt(2))


FASTEST = Hand(80.0, 0.5)
"""Faster and less steady than hands are that sweep."""


@dataclass(frozen=True, slots=True)
class ReadOut:
    """Read-out of pictures of `rows` rows, one after another over `time_ms`, and how a hand moves the sheet meanwhile.

    `shifts_mm` (K,) standard deviation of what each term beyond the first moves a sheet of light by tremor, `steady_mm`
    that of the second by the hand's speed; no terms: every row sees the same plane. `per_mm` is the change (3,) in 1/mm
    of a plane by a shift of 1 mm, see `change_per_mm`.
    """

    rows: int = 1
    time_ms: float = 0.0
    shifts_mm: tuple[float, ...] = ()
    steady_mm: float = 0.0
    per_mm: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @classmethod
    def of(cls, rows: int, time_ms: float, hand: Hand) -> ReadOut:
        """Make the read-out of pictures of `rows` rows over `time_ms`, in which `hand` moves; `per_mm` is not set."""
        n = np.arange(1, MOST_TERMS + 1)
        size = hand.tremor_terms_mm(MOST_TERMS, time_ms / 1000) + hand.steady_mm(time_ms / 1000) * (n == 1)
        used = int(n[size > LEAST_SHIFT_MM * np.sqrt(2 * n + 1)].max(initial=0))
        return cls(rows, time_ms, (0.0,) * used).by(hand)

    def by(self, hand: Hand) -> ReadOut:
        """Replace the motion of the hand, keeping the number of terms."""
        shifts = hand.tremor_terms_mm(len(self.shifts_mm), self.time_ms / 1000)
        steady = hand.steady_mm(self.time_ms / 1000)
        return replace(self, shifts_mm=tuple(np.maximum(shifts, NO_SHIFT_MM).tolist()), steady_mm=steady)

    @property
    def size(self) -> int:
        """Number of unknowns of the plane of one sweep."""
        return 3 * (1 + len(self.shifts_mm))

    def forms(self, rays: Array, v: Array) -> Array:
        """Compute the factors (N, size) that give π·r at `rays` (N, 3) in rows `v` (N,) from a sweep's coefficients."""
        return row_forms(rays, v, self.rows, self.size)

    def planes(self, coefficients: Array, v: Array) -> Array:
        """Compute the planes π (N, 3) in 1/mm that hold in rows `v` (N,), from a sweep's stacked `coefficients`."""
        return row_planes(coefficients, v, self.rows)

    @property
    def moves(self) -> bool:
        """Whether different rows of one picture see different light planes."""
        return bool(self.shifts_mm)

    def weight(self, sweeps: int) -> csr_array:
        """Make the prior's weight matrix for the unknowns of `sweeps` in order of time; 0 for the middle planes.

        It is the inverse of the covariance of how the hand moves the planes within a read-out.
        """
        frame = np.arange(sweeps)
        kept = np.exp(-np.abs(frame[:, None] - frame) / KEPT_FRAMES)
        of_term = [np.zeros((sweeps, sweeps))]
        for n, shift in enumerate(self.shifts_mm):
            steady = self.steady_mm**2 * kept if n == 0 else 0.0
            of_term.append(np.linalg.inv(shift**2 * np.eye(sweeps) + steady))
        blocks = np.array(of_term)
        per = np.array(self.per_mm)
        at = [(n, i) for n in range(1, len(blocks)) for i in range(3)]
        rows = [np.repeat(self.size * frame + 3 * n + i, sweeps) for n, i in at]
        columns = [np.tile(self.size * frame + 3 * n + i, sweeps) for n, i in at]
        values = [blocks[n].ravel() / per[i] ** 2 for n, i in at]
        shape = (self.size * sweeps, self.size * sweeps)
        return csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def log_det_weight(self, sweeps: int) -> float:
        """Compute log det of the prior's weight matrix for `sweeps` sweeps, up to what no hand changes."""
        frame = np.arange(sweeps)
        kept = np.exp(-np.abs(frame[:, None] - frame) / KEPT_FRAMES)
        first = self.shifts_mm[0] ** 2 * np.eye(sweeps) + self.steady_mm**2 * kept
        others = 2 * sweeps * float(np.sum(np.log(self.shifts_mm[1:])))
        return -3 * (float(np.linalg.slogdet(first)[1]) + others)


AT_ONCE = ReadOut()
"""All rows at once: a global shutter."""
