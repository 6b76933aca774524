"""Re-adjustment: camera and fan moved to where the pictures of a check have them, on request and never else.

A check that fails says that the rig has changed and, with a prior for how, by how much (`core.calibrate.change`)::

    x̂ = (N + P)⁻¹ g,   C = (N + P)⁻¹ (P + Σ) (N + P)⁻¹

Where nothing is corrected, measurements are off by x, of mean square C + x̂ x̂ᵀ. Here x̂ is applied, and C is what stays
uncertain: of the calibrations' own errors, and of the rigid change of the fan against the camera, the drift of the
picture and the focal length. These pictures have then said what they know: they are no check of the result.

A rig that is known to have changed is not held to the changes it was expected to make: turns, shifts, drift and focal
length may each have changed by t times more, t = 1 … 16, any of them as soon as another. r being the offsets and slopes
of the stripes, E their covariance by noise, B their derivatives by x, each choice of the four t has the likelihood of::

    r ~ N(0, E + B P⁻¹ B'),   q = r' E⁻¹ r − g' (N + P)⁻¹ g  ~  χ² of as many as there are

x̂ and C are the mean and the covariance over all choices, weighed by it: what the check cannot tell apart, a drift of
the picture from a turn, stays in C. q judges whether the changes looked for are what happened at all: a target that
moved or is not flat, another target, a lens that was turned are none of them.

References
----------
Rasmussen, C. E., Williams, C. K. I., Gaussian Processes for Machine Learning (2006), 5.4.1 (marginal likelihood).
Hoeting, J. A. et al., Bayesian model averaging: a tutorial, Statist. Sci. 14 (1999) 382, doi:10.1214/ss/1009212519.
JCGM 100:2008, Guide to the expression of uncertainty in measurement, F.2.4.5 (corrections).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from itertools import product

import numpy as np
from scipy.special import chdtrc

from core.calibrate.camera.reprojection import camera_of, parameters_of
from core.calibrate.change import (
    DEFAULT_STABILITY,
    P_TOLD,
    PROVES_NOTHING,
    STABLE,
    Evidence,
    Stability,
    lasting,
)
from core.calibrate.deviations import SCALES, UNEXPLAINED, Deviation, Source, moved_fan
from core.calibrate.results import CameraCalibration, FanCalibration, Readjustment
from core.errors import InputError
from core.messages import Message
from core.model.arrays import Array

WIDER = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Factors by which more may have changed than the rig's stability has it."""
NEGLIGIBLE_SHARE = 1e-6
"""Weight of a choice that is passed by."""
LEAST_POSES = 2
"""One pose that is wrong cannot be told from a rig that has changed."""
MOST_TURNED, MOST_SHIFTED_MM, MOST_DRIFTED_PX, MOST_OF_FOCAL = 4e-3, 0.4, 4.0, 2e-3
"""Changes beyond these are no drift: something was knocked or exchanged, and is to be calibrated. A plane target whose
size differs by a thousandth looks like a laser that is 0.3 mm further away."""


@dataclass(frozen=True, eq=False, slots=True)
class CheckPictures:
    """Pictures of a check: what they are, and how far they are from the calibrations.

    `squares` is the sum of squares of the offsets and slopes of its stripes in units of their covariance by noise, of
    `freedom` of them; `poses` say something. `hashes` are SHA-256 by the pictures' names, `pictures_id` names them all.
    """

    squares: float
    freedom: int
    poses: int
    taken_at: datetime
    pictures_id: str
    hashes: Mapping[str, str] = field(default_factory=dict)


def readjusted(
    known: tuple[CameraCalibration, FanCalibration, str],
    deviations: Sequence[Deviation],
    evidence: Evidence,
    pictures: CheckPictures,
    stability: Stability | None,
) -> tuple[CameraCalibration, FanCalibration]:
    """Compute camera and fan re-adjusted to the pictures of an interim check; InputError where that is not justified.

    Parameters
    ----------
    known
        The calibrations the check was made with, and the id that names them.
    deviations, evidence
        K deviations of calibrations and then `core.calibrate.change.changes`, and what the check says of them.
    pictures
        Those of the check.
    stability
        How far the rig may change: the prior's shape, and its least size. None: the default one.

    Returns
    -------
    The camera and the fan, whose `readjusted` says what was done and holds what stays uncertain.

    Raises
    ------
    InputError
        If nothing has changed, the rig is stated not to change, the poses are too few, or the changes looked for are
        not what happened.
    """
    camera, fan, id_ = known
    before = float(chdtrc(pictures.freedom, _quadratic(pictures, evidence, deviations, STABLE)))
    found = _averaged(pictures, evidence, deviations, stability or DEFAULT_STABILITY)
    if pictures.poses < LEAST_POSES:
        raise _refused(
            Message(
                "readjust.too_few_poses",
                "the check has {n} pose of the plane target that says something, and a re-adjustment needs {least}",
                n=pictures.poses,
                least=LEAST_POSES,
            )
        )
    if stability is not None and not stability.over_default.any():
        raise _refused(Message("readjust.stated_stable", "[stability] in rig.toml says that nothing can change"))
    if found.p < PROVES_NOTHING:
        raise _refused(
            Message(
                "readjust.does_not_fit",
                "no turn or shift of the laser and no drift of the picture makes these pictures fit (probability "
                "{p:.1g}): the target moved, is not the one of the calibration or not flat, or the camera's lens was "
                "turned",
                p=found.p,
            )
        )
    estimate, covariance = found.estimate, found.covariance
    m = np.array([one.source == "change" for one in deviations], dtype=np.bool_)
    size = np.array([*[DEFAULT_STABILITY.turn] * 3, *[DEFAULT_STABILITY.shift_mm] * 3,
                     *[DEFAULT_STABILITY.centre_px] * 2, DEFAULT_STABILITY.focal_share])  # fmt: skip
    change, sd = size * estimate[m], size * np.sqrt(np.diag(covariance)[m])
    _check_plausible(change)
    steps = np.array([_vector(one) for one in deviations])
    steps -= np.concatenate([parameters_of(camera.camera), fan.fan.pis.ravel()])
    lasts = np.array([one.source != UNEXPLAINED for one in deviations], dtype=np.bool_)
    values, sources = _independent(covariance[np.ix_(lasts, lasts)], [d for d in deviations if d.source != UNEXPLAINED])
    record = Readjustment(
        of=id_,
        taken_at=pictures.taken_at,
        pictures_id=pictures.pictures_id,
        hashes=dict(pictures.hashes),
        poses=pictures.poses,
        change=change,
        sd=sd,
        widened=found.widened,
        p_before=before,
        p_after=found.p,
        deviations=values @ steps[lasts],
        sources=sources,
        before=fan.readjusted,
    )
    return _moved(camera, fan, estimate @ steps, record)


@dataclass(frozen=True, eq=False, slots=True)
class _Averaged:
    """x̂ (K,) and C (K, K) over all priors, probability of what the check shows by them, and the mean factors (4,)."""

    estimate: Array
    covariance: Array
    p: float
    widened: Array


def _averaged(
    pictures: CheckPictures, evidence: Evidence, deviations: Sequence[Deviation], stability: Stability
) -> _Averaged:
    """Over all choices of factors on turn, shift, drift and focal length."""
    factors = np.array(list(product(WIDER, repeat=4)))
    priors = [stability.times(*one) for one in factors]
    squares = np.array([_quadratic(pictures, evidence, deviations, prior) for prior in priors])
    volumes = [
        np.linalg.slogdet(np.eye(len(sd)) + evidence.information * np.outer(sd, sd))[1]
        for sd in (_sd(deviations, prior) for prior in priors)
    ]
    log = -0.5 * (squares + np.array(volumes))
    weight = np.exp(log - log.max())
    weight /= weight.sum()
    count = len(deviations)
    estimate, second = np.zeros(count), np.zeros((count, count))
    for share, prior in zip(weight, priors, strict=True):
        if share > NEGLIGIBLE_SHARE:
            mean, covariance = lasting(deviations, evidence, prior)
            estimate += share * mean
            second += share * (covariance + np.outer(mean, mean))
    p = float(weight @ chdtrc(pictures.freedom, squares))
    return _Averaged(estimate, second - np.outer(estimate, estimate), p, np.exp(weight @ np.log(factors)))


def _quadratic(
    pictures: CheckPictures, evidence: Evidence, deviations: Sequence[Deviation], stability: Stability
) -> float:
    """q: how far the stripes are from where they were, in units of all that may have moved them."""
    sd = _sd(deviations, stability)
    scaled = sd * evidence.gradient
    gain = np.linalg.solve(np.eye(len(sd)) + evidence.information * np.outer(sd, sd), scaled)
    return max(float(pictures.squares - scaled @ gain), 0.0)


def _sd(deviations: Sequence[Deviation], stability: Stability) -> Array:
    """(K,) of the prior."""
    sd = np.array([one.source != UNEXPLAINED for one in deviations], dtype=np.float64)
    sd[[one.source == "change" for one in deviations]] = stability.over_default
    return sd


def _check_plausible(change: Array) -> None:
    """InputError if a change is larger than drift."""
    turn, shift, drift, focal = (float(np.linalg.norm(part)) for part in np.split(change, [3, 6, 8]))
    if (np.array([turn, shift, drift, focal]) <= [MOST_TURNED, MOST_SHIFTED_MM, MOST_DRIFTED_PX, MOST_OF_FOCAL]).all():
        return
    raise _refused(
        Message(
            "readjust.not_plausible",
            "the laser would have turned by {turn_mrad:.1f} mrad and moved by {shift_mm:.2f} mm, and the picture by "
            "{drift_px:.1f} px: that is no drift, something was knocked or exchanged",
            turn_mrad=1e3 * turn,
            shift_mm=shift,
            drift_px=drift,
        )
    )


def _refused(reason: Message) -> InputError:
    return InputError(
        Message("readjust.refused", "nothing was re-adjusted: {reason}", reason=reason),
        todo=Message(
            "advice.calibrate_instead", "check again with the target held in two or three poses, or calibrate"
        ),
    )


def _independent(covariance: Array, deviations: Sequence[Deviation]) -> tuple[Array, tuple[Source, ...]]:
    """Rows R with R'R = C, upper triangular: those of the calibrations first, then what change leaves uncertain."""
    values, vectors = np.linalg.eigh(covariance)
    rows = np.linalg.qr(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T, mode="r")
    sources: tuple[Source, ...] = tuple("readjusted" if one.source == "change" else one.source for one in deviations)
    return np.asarray(rows, dtype=np.float64), sources


def _moved(
    camera: CameraCalibration, fan: FanCalibration, step: Array, record: Readjustment
) -> tuple[CameraCalibration, FanCalibration]:
    """Camera and fan a step further, with the covariance that is left, in the forms that files have."""
    here = parameters_of(camera.camera)
    count = len(here)
    moved = camera_of(here + step[:count], camera.camera.image_size)
    of_calibrations = record.deviations[[source not in SCALES for source in record.sources]]
    joint = of_calibrations.T @ of_calibrations
    of_camera, both = joint[:count, :count], joint[count:, :count]
    by_camera = both @ np.linalg.pinv(of_camera, rcond=1e-10, hermitian=True)
    of_fan = joint[count:, count:] - by_camera @ both.T
    planes = replace(moved_fan(fan.fan, step[count:]), covariance=(of_fan + of_fan.T) / 2)
    adjusted = replace(
        fan, fan=planes, by_camera=by_camera, camera=moved, camera_covariance=of_camera, readjusted=record
    )
    return replace(camera, camera=moved, covariance=of_camera), adjusted


def _vector(one: Deviation) -> Array:
    return np.concatenate([parameters_of(one.camera), one.fan.pis.ravel()])


def nothing_changed(p: float) -> InputError | None:
    """Make the error that a check of probability `p` shows no change to adjust to; None if it shows one."""
    if p < P_TOLD:
        return None
    return _refused(
        Message(
            "readjust.nothing_changed",
            "camera and laser are where they were calibrated as far as the check can tell, and adjusting to its noise "
            "would make them worse",
        )
    )
