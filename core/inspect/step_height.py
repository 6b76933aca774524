"""Thickness of a part by the step between two parallel faces on light profiles, without any sweep.

In each picture the fan's lines lie over the part and over what it stands on. Two parallel planes fitted jointly to the
stretches on both faces (`core.inspect.fit.plane_fit`) give one thickness a picture; where the part was moved between
pictures, each gives that thickness once more. What the calibrations do is common to all of them; noise and form are
not, unless the part stood still: then all pictures show the same speckle, and their misfits are alike.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from core.findings.table import note_of
from core.inspect.causes import FROM_BELOW, Cause
from core.inspect.faces import FacePair
from core.inspect.fit.judged_form import LOWER_FACE, UPPER_FACE
from core.inspect.fit.judged_profiles import FacesInPicture, notes_on_profiles
from core.inspect.fit.plane_fit import FittedFaces, ParallelPlaneFit, fit_faces, fit_parallel_planes
from core.inspect.fit.plane_search import FEWEST_POINTS
from core.inspect.free_faces import angle_of, free_faces
from core.inspect.gauge import doubted
from core.inspect.profile_faces import faces_of, level_limit, stretches
from core.inspect.results import Contribution, GaugeResult
from core.inspect.uncertainty.budget import Effect, budget_of, combined, effects
from core.inspect.uncertainty.coverage import student_factor
from core.inspect.uncertainty.point_errors import PointErrors
from core.inspect.uncertainty.skewed_light import doubts_of_light
from core.messages import Message
from core.model.arrays import Array
from core.scan.surface.cloud import FAN, Cloud

RULE = Message(
    "gauge.rule_profiles",
    "distance of two parallel planes fitted jointly to both faces on the fan's light profiles; mean of all pictures",
)
RULE_ONE_LINE = Message(
    "gauge.rule_one_profile",
    "distance of two parallel lines fitted jointly to one light profile, along the normal of the faces as it was "
    "given; mean of all pictures",
)
NO_FACES = Message("profile.no_faces", "no two parallel faces lie on one line's profile")
NO_TILT = Message(
    "profile.no_tilt", "its stretches lie on one line each, so nothing in the picture says how the faces are tilted"
)
NOT_PLANE = Message(
    "profile.not_plane", "other lines lie on the part at other heights than those on its upper face: it is no plane"
)
_LEAST_SIGMA_MM = 1e-6
"""Smallest σ of a step in mm: one of 0, of pictures without noise, would have an infinite weight."""


@dataclass(frozen=True, slots=True)
class KnownTilt:
    """Tilt of the faces, used where one line does not show it.

    Parameters
    ----------
    normal
        (3,) unit normal of the faces in the camera frame; None: it is taken to lie in the light plane, which then
        stands at right angles on the faces.
    sd
        Standard uncertainty in rad of its tilt about the profile's lines.
    """

    normal: tuple[float, float, float] | None
    sd: float


@dataclass(frozen=True, eq=False, slots=True)
class Step:
    """Thickness that one picture gives.

    `pair` counts in that picture's `cloud`; `effects` are what makes it uncertain, `by_tilt_mm` what the tilt of its
    faces does, as far as that was taken from elsewhere; `errors` are those of its points.
    """

    frame: int
    cloud: Cloud
    errors: PointErrors
    pair: FacePair
    faces: FittedFaces
    effects: tuple[Effect, ...]
    by_tilt_mm: float

    @property
    def thickness_mm(self) -> float:
        """Distance in mm between the two parallel planes fitted in this picture."""
        return self.faces.planes.thickness

    @property
    def own_mm(self) -> float:
        """Standard uncertainty in mm of this picture's own, by noise and form, which other pictures do not share."""
        return float(math.hypot(*(float(np.linalg.norm(one.factor)) for one in self.effects if not one.shared)))


def step_of(cloud: Cloud, errors: PointErrors, tilt: KnownTilt | None = None) -> Step | Message:
    """Measure the step between two faces in one picture; return a message instead if it shows none.

    Parameters
    ----------
    cloud
        The fan's own points in that picture, in order along each line.
    errors
        How their errors hang together.
    tilt
        Used where the picture's own lines do not show how the faces are tilted; None: such a picture gives nothing.
    """
    # bent light draws arcs on plane faces, and at different heights: they are looked for within what it may do
    bent = replace(cloud, sigma=np.hypot(cloud.sigma, errors.bent_light(cloud)))
    found = sorted(stretches(bent, errors.speckle_px), key=lambda one: -one.length_mm)
    lines = {one.line for one in found}
    pair = faces_of(bent, found, None) if len(lines) > 1 else None
    hint: Array | None = None
    if pair is None and tilt is not None and found:
        hint = _hint(cloud, found[0].line, found[0].along, tilt)
        pair = faces_of(bent, found, hint)
    if pair is None:
        return NO_FACES if tilt is not None or len(lines) > 1 else NO_TILT
    upper, lower = cloud.select(pair.upper), cloud.select(pair.lower)
    robust = fit_parallel_planes(upper.points, lower.points, upper.sigma, lower.sigma, reference_normal=hint)
    if not robust.tilt_determined and hint is None:
        if tilt is None:
            return NO_TILT
        hint = _hint(cloud, found[0].line, found[0].along, tilt)
        robust = fit_parallel_planes(upper.points, lower.points, upper.sigma, lower.sigma, reference_normal=hint)
    if robust.thickness <= 0:
        return NO_FACES
    if _others_on_part(bent, found[0].along, pair, robust):
        return NOT_PLANE
    faces = fit_faces(upper, lower, robust, errors)
    of_step = effects(
        faces.gains[None, :], faces.sources, own=faces.fit.own, form_mm=faces.fit.form_mm,
        calibrations=errors.calibrations,
    )  # fmt: skip
    by_tilt = 0.0 if robust.tilt_determined or tilt is None else _by_tilt(upper, lower, faces, tilt)
    return Step(int(cloud.frame[0]), cloud, errors, pair, faces, tuple(map(_as_one, of_step)), by_tilt)


def profile_axes(step_normal: Array, cloud: Cloud) -> tuple[Array, Array]:
    """Compute two unit vectors (3,): along the profiles, to the right in the picture, and up, against the normal."""
    points = cloud.points - cloud.points.mean(axis=0)
    flat = points - np.outer(points @ step_normal, step_normal)
    along = np.linalg.svd(flat, full_matrices=False)[2][0]
    return np.asarray(along if along[0] > 0 else -along), -np.asarray(step_normal)


def _others_on_part(cloud: Cloud, along: Array, pair: FacePair, planes: ParallelPlaneFit) -> bool:
    """Whether a line that does not meet the upper face has points beside it that are clearly above the lower one."""
    upper = pair.upper
    position = cloud.points @ along
    beside = (position > position[upper].min()) & (position < position[upper].max())
    height = planes.lower_distance - cloud.points @ planes.normal
    above = (height > _PART_SHARE * planes.thickness) & (np.abs(height - planes.thickness) > level_limit(cloud))
    others = ~np.isin(cloud.sweep, cloud.sweep[upper])
    return int(np.count_nonzero(beside & above & others)) >= FEWEST_POINTS


_PART_SHARE = 0.5
"""A point higher than this share of the step is on the part, and not on what it stands on."""


def _hint(cloud: Cloud, line: int, along: Array, tilt: KnownTilt) -> Array:
    """The faces' normal, away from the camera: as given, or the one in the light plane of a line."""
    if tilt.normal is not None:
        normal = np.array(tilt.normal)
    else:
        mine = cloud.points[cloud.sweep == FAN - line]
        plane = np.linalg.svd(mine - mine.mean(axis=0), full_matrices=False)[2][2]
        normal = np.cross(plane, along)
    return np.asarray(normal if normal @ cloud.points.mean(axis=0) > 0 else -normal, dtype=np.float64)


def _by_tilt(upper: Cloud, lower: Cloud, faces: FittedFaces, tilt: KnownTilt) -> float:
    """What an error of the given tilt does to the thickness, to second order.

    Turned by φ about the lines, n becomes n cos φ + m sin φ with m across, and t = n·Δ becomes t cos φ + (m·Δ) sin φ:
    with φ of standard deviation σ that is (m·Δ) σ, and √3/2 t σ² about t itself.
    """
    apart = lower.points.mean(axis=0) - upper.points.mean(axis=0)
    normal = faces.planes.normal
    centred = upper.points - upper.points.mean(axis=0)
    along = np.linalg.svd(centred, full_matrices=False)[2][0]
    across = np.cross(along, normal)
    first = float(across @ apart) * tilt.sd
    return math.hypot(first, math.sqrt(3) / 2 * faces.planes.thickness * tilt.sd**2)


def _as_one(effect: Effect) -> Effect:
    """What is not shared, as one number: it is added to that of other pictures by its size alone.

    Light from below the two faces is shared: all pictures show the same ones.
    """
    if effect.source in FROM_BELOW:
        return replace(effect, shared=True)
    if effect.shared:
        return effect
    return replace(effect, factor=np.array([[float(np.linalg.norm(effect.factor))]]))


def measure_steps(
    steps: Sequence[Step],
    *,
    one_line: bool = False,
    nominal_mm: float | None = None,
    tolerance_mm: float | None = None,
    k: float = 2.0,
) -> GaugeResult:
    """Combine the thicknesses of several pictures into one, with its uncertainty and verdict.

    Parameters
    ----------
    steps
        One or more.
    one_line
        Whether the faces' tilt was taken from elsewhere.
    nominal_mm, tolerance_mm
        What the part should be, ±; without both of them there is no verdict.
    k
        Coverage factor where u is known.

    Returns
    -------
    GaugeResult
        Faces and flatness are those of the picture nearest to the mean, their indices into its cloud.

    Raises
    ------
    ValueError
        If there is no step.
    """
    if not steps:
        raise ValueError("no picture gives a step")
    values, own = np.array([(one.thickness_mm, max(one.own_mm, _LEAST_SIGMA_MM)) for one in steps]).T
    weights = own**-2.0 / np.sum(own**-2.0)
    thickness = float(weights @ values)
    alike = _alikeness(steps)
    parts = [
        (np.array([weight]), [half for one in step.effects for half in _halves(one, alike)])
        for weight, step in zip(weights, steps, strict=True)
    ]
    rows = list(budget_of(parts))
    by_tilt = float(weights @ [one.by_tilt_mm for one in steps])
    if by_tilt > 0:
        rows.append(Contribution(Cause.FACE_TILT, by_tilt))
    rows += _observed(values, own, weights, alike)
    budget = tuple(rows)
    u, factor = combined(budget), student_factor(k, budget)
    shown = steps[int(np.argmin(np.abs(values - thickness)))]
    planes = shown.faces.planes
    upper, lower = free_faces(
        shown.cloud, shown.pair, lambda: planes, shown.errors, tilt_determined=planes.tilt_determined
    )
    gauge = GaugeResult(
        thickness_mm=thickness,
        u_mm=u,
        k=factor,
        upper=upper,
        lower=lower,
        parallelism=angle_of(upper, lower),
        budget=budget,
        nominal_mm=nominal_mm,
        tolerance_mm=tolerance_mm,
        normal=shown.faces.planes.normal,
        rule=RULE_ONE_LINE if one_line else RULE,
        notes=(*_notes(len(steps), alike), *_notes_on_form(steps if alike < _STOOD_STILL else [shown])),
        doubts=(),
    )
    return doubted(gauge, (*shown.errors.doubts, *doubts_of_light(budget)))


def _halves(effect: Effect, alike: float) -> tuple[Effect, ...]:
    """An effect that is a picture's own, as the part that all pictures have in common and the rest."""
    if effect.shared:
        return (effect,)
    together, alone = math.sqrt(alike) * effect.factor, math.sqrt(1 - alike) * effect.factor
    return replace(effect, factor=together, shared=True), replace(effect, factor=alone)


def _alikeness(steps: Sequence[Step]) -> float:
    """How far the misfits of neighbouring pictures are the same, pixel by pixel: 0 for independent ones, 1 for one.

    A part that stands still shows the same speckle in every picture. Misfits are compared where both pictures have a
    point of the same line on the same pixel; without any such place nothing is alike.
    """
    found = []
    for one, other in pairwise(steps):
        first, second = (_misfits(step) for step in (one, other))
        common = sorted(first.keys() & second.keys())
        if len(common) >= _FEWEST_ALIKE:
            a, b = (np.array([of[key] for key in common]) for of in (first, second))
            found.append(float(np.corrcoef(a, b)[0, 1]))
    alike = max(float(np.median(found)), 0.0) if found else 0.0
    return 1.0 if alike >= _STOOD_STILL else alike


_FEWEST_ALIKE = 30
"""Places at which two pictures are compared, at least: fewer correlate by chance."""
_STOOD_STILL = 0.3
"""From this alikeness on the pictures show one and the same place, and count as one. On the simulated rig it is 0.5
for a part at rest, where the camera's noise is all that differs, and 0.0 for one that is moved by 2 mm."""


def _misfits(step: Step) -> dict[tuple[int, int, int], float]:
    """Misfit in mm at each pixel (line, u, v) of both faces."""
    planes = step.faces.planes
    found = {}
    for indices, residuals in zip((step.pair.upper, step.pair.lower), planes.residuals, strict=True):
        pixel = np.rint(step.cloud.uv[indices]).astype(np.int64)
        for line, (u, v), residual in zip(step.cloud.sweep[indices], pixel, residuals, strict=True):
            found[int(line), int(u), int(v)] = float(residual)
    return found


def _observed(values: Array, own: Array, weights: Array, alike: float) -> list[Contribution]:
    """What the pictures scatter beyond their own noise, as one more cause of their mean."""
    count = len(values)
    if count < 3:
        return []
    mean = float(weights @ values)
    scatter = float(np.sum((values - mean) ** 2) / (count - 1))
    expected = float(np.mean(own**2)) * (1 - alike)
    beyond = max(scatter - expected, 0.0)
    if beyond <= 0:
        return []
    return [
        Contribution(Cause.OBSERVED, math.sqrt(beyond * float(weights @ weights)), math.sqrt(beyond), dof=count - 1.0)
    ]


def _notes_on_form(steps: Sequence[Step]) -> tuple[Message, ...]:
    """What is wrong with the faces by pictures that are independent of each other."""
    pictures = []
    for step in steps:
        part = np.repeat([0, 1], [len(step.pair.upper), len(step.pair.lower)])
        cloud, planes = step.cloud.select(np.concatenate([step.pair.upper, step.pair.lower])), step.faces.planes
        along = profile_axes(planes.normal, cloud)[0]
        shape = planes.shape(cloud.points, part)
        pictures.append(FacesInPicture(cloud, part, shape, cloud.points @ along, step.errors))
    return notes_on_profiles(pictures, (UPPER_FACE, LOWER_FACE))


def _notes(count: int, alike: float) -> tuple[Message, ...]:
    notes = [note_of("profile.mean_of", n=count)]
    if count > 1 and alike >= _STOOD_STILL:
        notes.append(note_of("profile.stood_still"))
    return tuple(notes)
