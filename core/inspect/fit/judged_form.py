"""What the residuals of a fitted face, ball or pin say of it: its form, and whether its points scatter as stated.

The points of a scan share the errors of their light planes and of the calibrations, so a pattern over a surface is held
against what these explain (`core.model.residuals.judge_with_shared`). What is left is the part itself, or light that
does not do what it should: a face that is bent, a dent, a flank. That is no fault of the measurement and is in U as
*form*; it is told where it stands out of the scatter of the points, so that nobody takes a bent face for a plane.

Points that the fit has left out as wrong are judged with the rest, as far as a single one can: a dent is full of them.

Whether points scatter as stated is asked twice. Their whole σ is hardly tested where most of it is a light plane, of
which a scan holds but few; their own noise alone, what is left of σ without the plane, is not just that where the plane
was found with the help of this very point. Only where both are too small is it told.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.calibrate.camera.coverage import REGIONS
from core.inspect.fit.shapes import Parts, Shape
from core.inspect.uncertainty.error_sources import GRAZING, Sources
from core.inspect.uncertainty.point_errors import PATCHES, PointErrors, patches
from core.messages import Message
from core.model.arrays import Array
from core.model.residuals import Judgement, Residuals, SharedErrors, judge_with_shared
from core.model.robust import huber_weights, mad_sd
from core.scan.surface.cloud import Cloud
from core.scan.surface.normals import pixel_angle

# Held by tests/inspect/fit/test_judged_form.py on parts with and without form, and by tests/accuracy on rendered ones.
SURELY = 1e-3
"""Probability below which a pattern is no chance."""
STANDS_OUT_PX = 0.2
"""Pixels, as large as the surface shows them, between the highest and the lowest patch from which on a form is told.
Stripes that are not quite as modelled leave up to 0.1 on ideal rendered scans, flat as the parts are."""
TIMES = 1.2
"""Scatter over stated σ from which on it is told, if both the whole of it and the part that errs in each stretch alone
are so much too large. On ideal rendered scans the whole is 0.3 to 0.95, for σ holds what a fit takes out; the other
part is up to 1.9."""
_BEYOND = 3.0
"""Standard deviations from which on a point counts for less."""
_BOWL = 0.6
"""Share of a pattern's variance that a parabola explains if the face is bowed."""
_LEAST_PATCHES = 9
"""Of a face that is judged; with fewer, six numbers of a parabola explain everything."""

FACE = Message("form.the_face", "the face")
UPPER_FACE, LOWER_FACE = (
    Message("form.the_upper_face", "the upper face"),
    Message("form.the_lower_face", "the lower face"),
)
SPHERE, CYLINDER = Message("form.the_sphere", "the sphere"), Message("form.the_cylinder", "the cylinder")
_UP, _DOWN = Message("form.too_high", "too high"), Message("form.too_low", "too low")
_ABOVE, _BELOW = Message("form.above", "above"), Message("form.below", "below")


def level(number: int) -> Message:
    """The name of a level, from 1."""
    return Message("form.the_level", "level {n}", n=number)


def judge_form(cloud: Cloud, shape: Shape, part: Parts, errors: PointErrors) -> Judgement:
    """Judge all points of a cloud, on the faces `part` (N,) of a fitted shape; cells are the patches of each face.

    Of stretches of stripes; groups are the sweeps.
    """
    points = cloud.points
    outward = np.asarray(shape.outward(points, part), dtype=np.float64)
    misfit = shape.misfit(points, part)
    expected = cloud.sigma * np.maximum(np.abs((outward * points).sum(axis=1)) / points[:, 2], GRAZING)
    relative = misfit / expected
    weights = huber_weights(relative / max(mad_sd(relative), 1e-9), _BEYOND)
    patch = patches(cloud.uv, part)
    sources = Sources.of(cloud, outward, weights, part, patch, errors)
    group = np.zeros(len(sources.own), dtype=np.intp)
    group[sources.stretch] = cloud.sweep - cloud.sweep.min()
    residuals = Residuals(
        sources.mean(misfit),
        np.sqrt(sources.mean(expected**2)),
        group,
        np.asarray(sources.form.argmax(axis=1), dtype=np.intp),
        PATCHES**2 * (int(part.max(initial=0)) + 1),
    )
    shared = np.hstack([sources.speckle, sources.sweeps, sources.common])
    acting = SharedErrors(sources.own, shared, sources.mean(shape.design(points, part)))
    return judge_with_shared(residuals, acting)


def notes_on_form(
    cloud: Cloud,
    indices: NDArray[np.int64],
    shape: Shape,
    errors: PointErrors,
    names: Sequence[Message],
    part: Parts | None = None,
) -> tuple[Message, ...]:
    """What is wrong with a surface, and in which direction: at most one note a face.

    Parameters
    ----------
    cloud, indices
        The points, and which of them (N,) were said to be on it, those that the fit left out included.
    shape, errors
        The surface as fitted, and how the points' errors hang together.
    names
        Of its faces.
    part
        (N,) which face each of the indices is on; None: all on one.
    """
    cloud = cloud.select(indices)
    part = np.zeros(len(cloud), dtype=np.int64) if part is None else part
    found = judge_form(cloud, shape, part, errors)
    notes: list[Message] = []
    for number, name in enumerate(names):
        mine = slice(PATCHES**2 * number, PATCHES**2 * (number + 1))
        here = part == number
        if found.p < SURELY and np.count_nonzero(found.count[mine]) >= _LEAST_PATCHES:
            notes += _of_pattern(found.profile[mine], found.count[mine], _pixel_mm(cloud.select(here)), name)
    if notes:
        return tuple(notes)
    if min(found.times, found.alone) > TIMES:
        return (
            Message(
                "form.scatter",
                "Points scatter about {name:and} {times:.1f} times as much as their uncertainty says: something acts "
                "on them that is not known (gloss, vibration, a laser out of focus). U contains the scatter as noise.",
                name=list(names),
                times=found.times,
            ),
        )
    return ()


def _pixel_mm(cloud: Cloud) -> float:
    """Size of a pixel in mm on the surface, square to the line of sight."""
    return pixel_angle(cloud.points, cloud.uv) * float(np.median(cloud.points[:, 2]))


def _of_pattern(profile: Array, count: NDArray[np.intp], pixel_mm: float, name: Message) -> tuple[Message, ...]:
    """A note on one face's pattern (PATCHES²,) in mm, if it stands out."""
    seen = np.flatnonzero(count)
    height = profile[seen] - np.average(profile[seen], weights=count[seen])
    if np.ptp(height) <= STANDS_OUT_PX * pixel_mm:
        return ()
    row, column = np.divmod(seen, PATCHES)
    x, y = (2 * (column + 0.5) / PATCHES - 1, 2 * (row + 0.5) / PATCHES - 1)
    form, root = _parabola(x, y), np.sqrt(count[seen])
    solved = np.linalg.lstsq(form * root[:, None], height * root, rcond=None)[0]
    bowl = form @ solved
    explained = 1 - float(count[seen] @ (height - bowl) ** 2) / float(count[seen] @ height**2)
    middle = float(solved[0] - np.average(bowl, weights=count[seen]))
    if explained > _BOWL and abs(middle) > np.ptp(bowl) / 4:
        where, to_edges = _ABOVE if middle > 0 else _BELOW, PATCHES / (PATCHES - 1)
        return (
            Message(
                "form.bowed",
                "The form of {name} is not true: it is bowed, its middle is {mm:.2g} mm {where} its rim. U contains "
                "what that does to the value.",
                name=name,
                mm=float(np.ptp(_parabola(to_edges * x, to_edges * y) @ solved)),
                where=where,
            ),
        )
    most = int(np.argmax(np.abs(height)))
    third = [int(at > -1 / 3) + int(at > 1 / 3) for at in (y[most], x[most])]
    return (
        Message(
            "form.uneven",
            "The form of {name} is not true: at the {place}, as the camera sees it, it is {mm:.2g} mm {where}. U "
            "contains what that does to the value.",
            name=name,
            place=REGIONS[3 * third[0] + third[1]],
            mm=abs(float(height[most])),
            where=_UP if height[most] > 0 else _DOWN,
        ),
    )


def _parabola(x: Array, y: Array) -> Array:
    """(n, 6) what the coefficients of a parabola are multiplied by at places of a face, −1 … 1 from edge to edge."""
    return np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])
