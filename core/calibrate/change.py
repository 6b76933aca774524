"""What may have changed between the calibrations and the pictures that are measured, and what these say of it.

A rig is calibrated on one day and measures on another: mounts turn, lasers point elsewhere when they warm up, the
camera's picture drifts. Let z be the calibrations' independent errors in standard uncertainties
(`core.calibrate.deviations`), N(0, 1), and m the changes since then, N(0, s²) with s from the rig's stability. Pictures
taken after the calibration, of a scan or of the plane target, give normal equations N x = g of x = (z, m); the
covariance Σ of g may be larger than N, as errors hang together. With the prior P⁻¹ = diag(1, s²)::

    x̂ = (N + P)⁻¹ g,   C = (N + P)⁻¹ (P + Σ) (N + P)⁻¹

Nothing is corrected by x̂: who wants that calibrates anew. So what is measured with the calibrations as they are is off
by x, of mean square C + x̂ x̂ᵀ. With C = L Lᵀ, L lower triangular and z before m, the columns of z are what the
calibrations make uncertain, those of m what change adds when the calibrations' errors are known, and x̂ is what the
pictures have seen of both. Without pictures change adds s; a precise picture of the day leaves next to nothing.

References
----------
Koch, K.-R., Parameter Estimation and Hypothesis Testing in Linear Models (1999), 3.2 (prior information), 4.1.
JCGM 100:2008, Guide to the expression of uncertainty in measurement, F.2.4.5 (corrections that are not applied).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.special import chdtrc

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.deviations import UNEXPLAINED, Deviation, Source, moved_fan
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Fan, LightPlane
from core.model.arrays import Array

P_TOLD = 0.01
"""A change is told where chance alone would look so with a smaller probability."""
PROVES_NOTHING = 0.001
"""With a smaller probability nothing measured is proof of conformity, even where a check of the day has passed."""
LEAST_INFORMATION = 0.05
"""A change of which pictures know less, for its size by default, is not looked at: they cannot tell."""


@dataclass(frozen=True, slots=True)
class Stability:
    """Standard uncertainties of how far a rig may have changed since its calibration.

    The defaults are those of a rig of which nothing is stated, a few kelvins and days after its calibration: mounts
    and modules of lasers point elsewhere by 10 to 100 µrad for each kelvin, 150 mm of aluminium grow by 17 µm in five
    kelvins, pictures of cameras drift by 0.1 to 0.5 px while they warm up.

    Parameters
    ----------
    turn
        Of the laser against the camera, about each axis through the laser, in rad.
    shift_mm
        Of the laser against the camera, along each axis.
    centre_px
        Of the picture on the sensor, along u and v.
    focal_share
        Of the focal length, as a share of it.

    Raises
    ------
    ValueError
        If one is negative or not finite.

    References
    ----------
    Temperature compensation method for digital cameras in 2D and 3D measurement applications, Sensors 2018, 18, 3685,
    doi:10.3390/s18113685.
    """

    turn: float = 200e-6
    shift_mm: float = 0.02
    centre_px: float = 0.2
    focal_share: float = 1e-4

    def __post_init__(self) -> None:
        if not all(0 <= sd < np.inf for sd in self._each):
            raise ValueError(f"a stability is a number not below 0: {self}")

    def times(self, turn: float, shift: float, centre: float, focal: float) -> Stability:
        """Multiply the standard uncertainties of turn, shift, centre and focal length each by its own factor."""
        return Stability(turn * self.turn, shift * self.shift_mm, centre * self.centre_px, focal * self.focal_share)

    @property
    def _each(self) -> tuple[float, ...]:
        return self.turn, self.shift_mm, self.centre_px, self.focal_share

    @property
    def over_default(self) -> Array:
        """Ratios (9,) of these standard uncertainties to the default ones, in the order of `changes`."""
        share = np.array(self._each) / np.array(DEFAULT_STABILITY._each)
        return np.asarray(share[[0, 0, 0, 1, 1, 1, 2, 2, 3]], dtype=np.float64)


DEFAULT_STABILITY = Stability()
"""Of a rig of which nothing is stated."""
STABLE = Stability(0.0, 0.0, 0.0, 0.0)
"""Of a rig that nothing can change, as a simulated one."""


@dataclass(frozen=True, slots=True)
class RigSpread:
    """Factor on the default stability, by checks of a rig on `days` days from the `first` to the `last`."""

    factor: float
    days: int
    first: datetime
    last: datetime

    @property
    def stability(self) -> Stability:
        """Default standard uncertainties of a rig's change, times the factor estimated from its checks."""
        return DEFAULT_STABILITY.times(*[self.factor] * 4)


def changes(camera: Camera, fan: Fan) -> tuple[Deviation, ...]:
    """Make nine deviations of a rig, each changed in one way by one default standard uncertainty.

    Three turns of the fan about the laser and three shifts of it, two shifts of the picture, and the focal length.
    Where there is no fan the first six change nothing.
    """
    size = DEFAULT_STABILITY
    pivot = laser_of(fan) if fan.lines else np.zeros(3)
    turned = (displaced_fan(fan, size.turn * axis, pivot) for axis in np.eye(3))
    shifted = (displaced_fan(fan, np.zeros(3), pivot, size.shift_mm * axis) for axis in np.eye(3))
    here = parameters_of(camera)
    steps = np.zeros((3, len(here)))
    steps[0, 3] = steps[1, 4] = size.centre_px
    steps[2, :2] = size.focal_share * here[:2]
    cameras = (camera_of(here + step, camera.image_size) for step in steps)
    return (
        *(Deviation("change", camera, one) for one in (*turned, *shifted)),
        *(Deviation("change", one, fan) for one in cameras),
    )


def displaced_fan(fan: Fan, turn: Array, pivot: Array, shift_mm: Array | None = None) -> Fan:
    """Turn a fan by the vector `turn` (3,) in rad about `pivot` (3,) in mm, and then shift it by `shift_mm`."""
    rotation = Rotation.from_rotvec(turn).as_matrix()
    moved = pivot if shift_mm is None else pivot + shift_mm
    planes = []
    for plane in fan.planes:
        normal = rotation @ plane.normal
        foot = rotation @ (plane.normal * plane.d_mm - pivot) + moved
        planes.append(LightPlane(normal / (normal @ foot)))
    return Fan(tuple(planes))


@dataclass(frozen=True, eq=False, slots=True)
class Evidence:
    """Normal equations of pictures for K deviations x.

    `information` (K, K) is N, `scatter` (K, K) Σ, `gradient` (K,) g.
    """

    information: Array
    scatter: Array
    gradient: Array

    @classmethod
    def none(cls, count: int) -> Self:
        """Make normal equations of `count` deviations that no picture has contributed to: all zero."""
        return cls(np.zeros((count, count)), np.zeros((count, count)), np.zeros(count))

    def __add__(self, other: Evidence) -> Evidence:
        """Of independent pictures together."""
        return Evidence(
            self.information + other.information, self.scatter + other.scatter, self.gradient + other.gradient
        )


@dataclass(frozen=True, eq=False, slots=True)
class Change:
    """Judgement of whether the rig has changed since its calibration.

    Parameters
    ----------
    deviations
        Of calibrations and changes, one standard uncertainty each, in place of those of the calibrations alone.
    p
        Probability that chance alone would set pictures and calibrations this far apart; 1 where they cannot tell.
    times
        How many times further apart they are than calibrations and noise let one expect; infinite where the fan is so
        far from where it was calibrated that its lines are not known again.
    left_out
        Why pictures of an interim check say nothing.
    spread
        What the rig's own checks say of how much it changes, where that is reckoned with.
    checked
        Whether pictures of the day, of a check or a re-adjustment, agree with the calibrations by themselves.
    stability
        What was reckoned with.
    sitting_hours
        How many hours ago the planes were calibrated, where that was in the sitting of the scan.
    """

    deviations: tuple[Deviation, ...]
    p: float
    times: float
    left_out: tuple[Message, ...] = ()
    spread: RigSpread | None = None
    checked: bool = False
    stability: Stability = DEFAULT_STABILITY
    sitting_hours: float | None = None

    @property
    def surely(self) -> bool:
        """Whether camera or laser surely differ from their calibration, beyond chance."""
        return self.p < PROVES_NOTHING

    @property
    def seemingly(self) -> bool:
        """Whether camera or laser seem to differ from their calibration, and no check of the day has passed.

        Who has no passed check has only the scan to go by, which sees little of most changes: what shows in it at all
        may be far larger than U allows for.
        """
        return PROVES_NOTHING <= self.p < P_TOLD and not self.checked

    @property
    def notes(self) -> tuple[Message, ...]:
        """Notes that the rig has surely changed, and on check pictures that tell nothing; () if neither."""
        return (*self._changed, *self.left_out)

    @property
    def _changed(self) -> tuple[Message, ...]:
        if self.p >= P_TOLD:
            return ()
        if np.isinf(self.times):
            return (note_of("scan.fan_is_elsewhere"),)
        told = self.surely or self.seemingly
        return (note_of("scan.fan_has_moved" if told else "scan.fan_seems_moved", times=self.times, p=self.p),)


def stability_in_use(
    stated: Stability | None, charted: RigSpread | None, assumed: Stability = DEFAULT_STABILITY
) -> tuple[Stability, Source]:
    """Choose the rig's stability, and the name of its source: `charted` by checks, else `stated`, else `assumed`."""
    if charted is not None:
        return charted.stability, "charted change"
    return (assumed, "assumed change") if stated is None else (stated, "change")


def judge(
    camera: Camera,
    fan: Fan,
    deviations: Sequence[Deviation],
    evidence: Evidence,
    stated: Stability | None,
    charted: RigSpread | None = None,
    assumed: Stability = DEFAULT_STABILITY,
    planes: Array | None = None,
) -> Change:
    """Estimate what has changed of a rig since its calibration, from the normal equations `evidence` of its pictures.

    The K `deviations` are first those of the calibrations, then the nine `changes`. `camera` and `fan` are those
    calibrated, `planes` (P, 3) the known planes of a scan, if the deviations hold them. The stability is that by the
    rig's checks, `charted`, where they say it; else that `stated`, else that `assumed`; what change adds says so.
    """
    stability, source_of_change = stability_in_use(stated, charted, assumed)
    bent = tuple(one for one in deviations if one.source == UNEXPLAINED)  # no parameter of camera and fan
    m = np.array([one.source == "change" for one in deviations], dtype=np.bool_)
    squares, freedom = _squares(evidence, m)
    p = _by_chance(squares, freedom)
    times = float(np.sqrt(squares / max(freedom, 1)))
    if not stability.over_default.any():
        return Change(
            tuple(one for one in deviations if one.source != "change"), p, times, spread=charted, stability=stability
        )
    x, estimate, root = _lasting(deviations, evidence, stability)
    free = [one for one, there in zip(deviations, x, strict=True) if there]
    here = Deviation("camera", camera, fan, np.zeros((0, 3)) if planes is None else planes)
    steps = np.array([_vector(one) for one in free]) - _vector(here)
    sources = [source_of_change if one.source == "change" else one.source for one in free] + [source_of_change]
    displaced = np.vstack([np.linalg.qr(root.T, mode="r"), estimate]) @ steps  # R of the root's transpose is Lᵀ
    told = (_displaced(here, source, step) for source, step in zip(sources, displaced, strict=True))
    return Change((*told, *bent), p, times, spread=charted, stability=stability)


def agrees(deviations: Sequence[Deviation], evidence: Evidence) -> bool:
    """Whether pictures, by their normal equations, agree with a rig's calibrations; False if they tell nothing."""
    squares, freedom = _squares(evidence, np.array([one.source == "change" for one in deviations], dtype=np.bool_))
    return freedom > 0 and _by_chance(squares, freedom) >= P_TOLD


def lasting(deviations: Sequence[Deviation], evidence: Evidence, stability: Stability) -> tuple[Array, Array]:
    """Estimate the K deviations of a rig, (K,), with their covariance (K, K); 0 for those that cannot change."""
    x, estimate, root = _lasting(deviations, evidence, stability)
    everywhere, square = np.zeros(len(x)), np.zeros((len(x), len(x)))
    everywhere[x], square[np.ix_(x, x)] = estimate, root @ root.T
    return everywhere, square


def _lasting(
    deviations: Sequence[Deviation], evidence: Evidence, stability: Stability
) -> tuple[NDArray[np.bool_], Array, Array]:
    """Which deviations (K,) may be other than 0; x̂ of these, and a root of their C."""
    sd = np.array([one.source != UNEXPLAINED for one in deviations], dtype=np.float64)
    sd[[one.source == "change" for one in deviations]] = stability.over_default
    x = sd > 0
    size, square = sd[x], np.ix_(x, x)
    prior, scale = np.eye(len(size)), np.outer(size, size)
    gain = np.linalg.inv(prior + evidence.information[square] * scale)
    estimate = size * (gain @ (size * evidence.gradient[x]))
    root = size[:, None] * (gain @ np.linalg.cholesky(prior + evidence.scatter[square] * scale))
    return x, estimate, root


def _displaced(here: Deviation, source: Source, step: Array) -> Deviation:
    """Camera, fan and known planes displaced by a step of their parameters."""
    parameters, lines = parameters_of(here.camera), 3 * here.fan.lines
    of_camera, of_fan, of_planes = np.split(step, [len(parameters), len(parameters) + lines])
    return Deviation(
        source,
        camera_of(parameters + of_camera, here.camera.image_size),
        moved_fan(here.fan, of_fan),
        here.planes + of_planes.reshape(-1, 3),
    )


def _squares(evidence: Evidence, m: NDArray[np.bool_]) -> tuple[float, int]:
    """Sum of squares of g of the changes `m` in units of its covariance if nothing has changed; how many are seen."""
    z = ~m
    information = evidence.information[np.ix_(m, m)]
    values, vectors = np.linalg.eigh(information)
    seen = vectors[:, values > LEAST_INFORMATION]
    mz = evidence.information[np.ix_(m, z)]
    expected = mz @ mz.T + evidence.scatter[np.ix_(m, m)]
    part = seen.T @ evidence.gradient[m]
    return float(part @ np.linalg.solve(seen.T @ expected @ seen, part)), len(part)


def _by_chance(squares: float, freedom: int) -> float:
    """Probability that so many squares are as large by chance; 1 where none are seen."""
    return float(chdtrc(freedom, squares)) if freedom else 1.0


def _vector(one: Deviation) -> Array:
    return np.concatenate([parameters_of(one.camera), one.fan.pis.ravel(), one.planes.ravel()])


def laser_of(fan: Fan) -> Array:
    """Find the point (3,) in mm, nearest to the camera, where the light planes meet: the laser.

    Of a single plane its nearest point.

    Planes at small angles meet along a line that is well known but for noise, which is taken for none.
    """
    normals = np.array([plane.normal for plane in fan.planes])
    distances = np.array([plane.d_mm for plane in fan.planes])
    return np.asarray(np.linalg.lstsq(normals, distances, rcond=1e-3)[0], dtype=np.float64)
