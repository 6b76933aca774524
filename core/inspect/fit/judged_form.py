"""What residuals say of a face, ball, pin, section or nominal surface: its form, and whether points scatter as stated.

The points of a scan share the errors of their light planes and of the calibrations, so a pattern over a surface is held
against what these explain (`core.model.residuals.judge_with_shared`). What is left is the part itself, or light that
does not do what it should: a face that is bent, a dent, a flank. That is no fault of the measurement and is in U as
*form*; it is told where it stands out of the scatter of the points, so that nobody takes a bent face for a plane.

Faces that were fitted as parallel and are not stand out most of all by a slant against each other. What each of them is
off beside that is its form. Light, a camera or a part that was displaced slants faces as well, at each height
otherwise: where a fact of the scan says so, no angle is named.

Points that the fit has left out as wrong are judged with the rest, as far as a single one can: a dent is full of them.

Patterns are looked for over patches of a face as the camera sees it, or, in a section, along each of its stretches. Of
a part laid on its nominal surface its motion as a whole and its mean deviation are no pattern: the one is the
alignment's, whichever it was, and the other is told by itself.

Whether points scatter as stated is asked twice. Their whole scatter is hardly tested where most of it is of light
planes or of the calibrations, of which a scan holds but few: so few are its degrees of freedom. Their own noise alone,
what is left without these, is not just that where a plane was found with the help of this very point. Only where both
are too large, and neither is chance, is it told.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from core.calibrate.camera.coverage import REGIONS
from core.findings.table import note_of
from core.inspect.fit.plane_search import search_tolerance
from core.inspect.fit.shapes import Parts, Shape
from core.inspect.uncertainty.error_sources import GRAZING, Sources
from core.inspect.uncertainty.point_errors import PATCHES, PointErrors, patches
from core.messages import Message
from core.model.arrays import Array
from core.model.directions import square_to
from core.model.residuals import Judgement, Residuals, SharedErrors, along_line, judge_with_shared
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
are so much too large."""
_BEYOND = 3.0
"""Standard deviations from which on a point counts for less."""
_MOST = 0.6
"""Share of a pattern's variance that a parabola explains if the face is bowed, and an angle between faces if they are
not parallel."""
_LEAST_PATCHES = {2: 9, 1: 6}
"""Of a face, and of a stretch of a section; with fewer, the six or three numbers of a parabola explain everything."""
_CARRIED = 0.5
"""Share of the strongest face's pattern below which another's may be what it has carried over, by what they share."""
_ALONG = 12
"""Parts of a stretch of a section."""
_FARTHEST = 2.0
"""Times the distance within which a search takes points for those of a face: beyond, they are not judged."""
_SAME = 1e-6
"""Share of the largest motion of a part below which another one leaves its surface where it is."""

FACE = Message("form.the_face", "the face")
UPPER_FACE, LOWER_FACE = (
    Message("form.the_upper_face", "the upper face"),
    Message("form.the_lower_face", "the lower face"),
)
SPHERE, CYLINDER = Message("form.the_sphere", "the sphere"), Message("form.the_cylinder", "the cylinder")
STRETCHES = (
    Message("form.the_first_stretch", "the first stretch"),
    Message("form.the_second_stretch", "the second stretch"),
)
ARC, PIECE = Message("form.the_arc", "the arc"), Message("form.the_piece", "the surface about the point")
_UP, _DOWN = Message("form.too_high", "too high"), Message("form.too_low", "too low")
ABOVE, BELOW = Message("form.above", "above"), Message("form.below", "below")


def level(number: int) -> Message:
    """Make the name of a level of a stepped part: "level 1", "level 2", …."""
    return Message("form.the_level", "level {n}", n=number)


@dataclass(frozen=True, eq=False, slots=True)
class Left:
    """Misfits of N points beside a surface, with its normals and how it follows what was fitted.

    Parameters
    ----------
    misfit
        (N,) in mm, outwards positive.
    outward
        (N, 3) unit normals of the surface.
    design
        (N, P) how far it moves outwards at each with what was fitted.
    """

    misfit: Array
    outward: Array
    design: Array

    @classmethod
    def of(cls, shape: Shape, points: Array, part: Parts) -> Left:
        """Compute the distances (N,) of `points` (N, 3) in mm from a fitted shape; `part` (N,) numbers their faces."""
        outward = np.asarray(shape.outward(points, part), dtype=np.float64)
        return cls(shape.misfit(points, part), outward, shape.design(points, part))

    def each_slanted(self, points: Array, part: Parts) -> Left:
        """Return the distances with a design that lets each face but the first tilt by itself."""
        away = (points - points.mean(axis=0))[:, :2] / max(float(np.abs(points[:, :2]).max()), 1e-9)
        slants = [np.where(part[:, None] == one, away, 0.0) for one in np.unique(part)[1:]]
        return Left(self.misfit, self.outward, np.hstack([self.design, *slants]))

    @classmethod
    def of_nominal(cls, points: Array, deviation: Array, normals: Array) -> Left:
        """Make the residuals of deviations (N,) in mm from a nominal surface that may be moved, turned and offset.

        Motions that leave the surface where it is are not in the design.
        """
        moved = np.hstack([normals, np.cross(points - points.mean(axis=0), normals), np.ones((len(points), 1))])
        moved /= np.maximum(np.linalg.norm(moved, axis=0), 1e-12)
        axes, size, _ = np.linalg.svd(moved, full_matrices=False)
        return cls(deviation - np.median(deviation), normals, axes[:, size > _SAME * size[0]] * np.sqrt(len(points)))


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Place on its face of each of N points, among C places a face.

    Parameters
    ----------
    cell
        (N,) number of the place, those of a face after those of the one before.
    sides
        How many places a face has along each side of it: along two sides, or one.
    mm
        (faces, 2) position in a section where each stretch begins and ends; of none else.
    """

    cell: NDArray[np.intp]
    sides: tuple[int, ...]
    mm: Array

    @classmethod
    def in_picture(cls, uv: Array, part: Parts) -> Places:
        """Assign each of the pixels `uv` (N, 2) to a patch of its face, numbered in `part` (N,)."""
        return cls(patches(uv, part).astype(np.intp), (PATCHES, PATCHES), np.zeros((0, 2)))

    @classmethod
    def in_section(cls, position: Array, part: Parts) -> Places:
        """Assign each of the positions (N,) in mm along a section to an interval of its stretch, `part` (N,)."""
        cell, ends = np.zeros(len(position), dtype=np.intp), []
        for number in range(int(part.max(initial=0)) + 1):
            here = part == number
            cell[here] = _ALONG * number + along_line(position[here], _ALONG)
            ends.append([position[here].min(), position[here].max()])
        return cls(cell, (_ALONG,), np.array(ends))

    @property
    def number(self) -> int:
        """Number of places (patches or intervals) that one face is divided into."""
        return int(np.prod(self.sides))

    def of_face(self, number: int) -> slice:
        """Return the slice that one face's places have in an array over the places of all faces."""
        return slice(self.number * number, self.number * (number + 1))

    def flat(self, place: NDArray[np.intp]) -> Array:
        """Compute the coordinates (n, 1 or 2) of places (n,) on their face, −1 … 1; across before down."""
        steps = np.unravel_index(place, self.sides)[::-1]
        return np.column_stack([2 * (step + 0.5) / side - 1 for step, side in zip(steps, self.sides, strict=True)])


@dataclass(frozen=True, eq=False, slots=True)
class Stretches:
    """Misfits of J stretches of stripes beside a surface, with what acts on them.

    Parameters
    ----------
    sources
        What acts on them.
    misfit, expected
        (J,) in mm, and its standard uncertainty as stated.
    cell
        (J,) number of the place.
    design
        (J, P) how far the surface moves outwards at each with what was fitted.
    """

    sources: Sources
    misfit: Array
    expected: Array
    cell: NDArray[np.intp]
    design: Array

    @classmethod
    def of(cls, cloud: Cloud, left: Left, part: Parts, places: Places, errors: PointErrors) -> Stretches:
        """Average the residuals `left` of all points of a cloud over pieces of stripes; outliers count less."""
        expected = cloud.sigma * np.maximum(
            np.abs((left.outward * cloud.points).sum(axis=1)) / cloud.points[:, 2], GRAZING
        )
        relative = left.misfit / expected
        weights = huber_weights(relative / max(mad_sd(relative), 1e-9), _BEYOND)
        sources = Sources.of(cloud, left.outward, weights, part, places.cell.astype(np.int64), errors)
        return cls(
            sources,
            sources.mean(left.misfit),
            np.sqrt(sources.mean(expected**2)),
            np.asarray(sources.form.argmax(axis=1), dtype=np.intp),
            sources.mean(left.design),
        )


def judge_form(cloud: Cloud, left: Left, part: Parts, places: Places, errors: PointErrors) -> Judgement | None:
    """Test whether the residuals `left` of a cloud's points show a form or too much scatter; None if there are too few.

    The residuals are means over stretches of stripes; their groups are the sweeps.
    """
    stretches = Stretches.of(cloud, left, part, places, errors)
    sources = stretches.sources
    if len(sources.own) <= left.design.shape[1]:
        return None
    group = np.zeros(len(sources.own), dtype=np.intp)
    group[sources.stretch] = cloud.sweep - cloud.sweep.min()
    residuals = Residuals(
        stretches.misfit, stretches.expected, group, stretches.cell, places.number * (int(part.max(initial=0)) + 1)
    )
    shared = sources.effects(sources.common)

    def information(others: Array, weight: Array) -> Array:
        return sources.information(np.hstack([others, sources.common]), weight)

    return judge_with_shared(residuals, SharedErrors(sources.own, shared, stretches.design, information))


def notes_on_form(
    cloud: Cloud,
    indices: NDArray[np.int64],
    shape: Shape,
    errors: PointErrors,
    names: Sequence[Message],
    part: Parts | None = None,
    position: Array | None = None,
    lies: bool = False,
) -> tuple[Message, ...]:
    """Make the notes on the form error of a fitted surface and its direction, at most one for each face.

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
    position
        (N, 2) in mm along a section, whose stretches the faces are then, and off its plane: a surface that slants or
        curves across the cut's width is no fault.
    lies
        Whether the faces are those of a part and of what it lies on; else they are levels, if there are several.
    """
    part = np.zeros(len(indices), dtype=np.int64) if part is None else part
    # Where a face is looked for, farther points are of something else; a region or a section holds them as well.
    # What all points of a face share is nothing of its form: on a rig that has changed it may be more than that.
    away = shape.misfit(cloud.points[indices], part)
    for number in np.unique(part):
        away[part == number] -= np.median(away[part == number])
    on = np.abs(away) <= search_tolerance(cloud) * _FARTHEST
    if not on.any():
        return ()
    cloud, part = cloud.select(indices[on]), part[on]
    position = None if position is None else position[on]
    left = Left.of(shape, cloud.points, part)
    if position is None:
        places = Places.in_picture(cloud.uv, part)
    else:
        places = Places.in_section(position[:, 0], part)
        off = position[:, 1:] / max(float(np.abs(position[:, 1]).max()), 1e-9)
        across = [np.where(part[:, None] == k, np.hstack([off, off**2]), 0.0) for k in range(len(names))]
        left = Left(left.misfit, left.outward, np.hstack([left.design, *across]))
    found, patterns = _patterns_on(cloud, left, part, places, errors)
    explained = _share_of_slants(patterns) if position is None and len(names) > 1 else 0.0
    askew: tuple[Message, ...] = ()
    if explained > _MOST:
        if not (errors.facts and errors.facts.displaced):
            askew = (_note_on_angle(left, cloud.points, part, names, explained, lies=lies),)
        found, patterns = _patterns_on(cloud, left.each_slanted(cloud.points, part), part, places, errors)
    if found is None:
        return askew
    least = _CARRIED * max((float(np.ptp(one.height)) for one in patterns if one is not None), default=0.0)
    notes = [
        _of_pattern(pattern, places, number, names[number])
        for number, pattern in enumerate(patterns)
        if pattern is not None and np.ptp(pattern.height) >= least
    ]
    return (*askew, *(notes or of_scatter(found, names)))


def _patterns_on(
    cloud: Cloud, left: Left, part: Parts, places: Places, errors: PointErrors
) -> tuple[Judgement | None, list[Pattern | None]]:
    """What is `left` of all points, judged, and the pattern over each face; none where it cannot be judged."""
    found = judge_form(cloud, left, part, places, errors)
    if found is None:
        return None, []
    faces = range(int(part.max()) + 1)
    return found, [pattern_on(found, places, one, cloud.select(np.flatnonzero(part == one))) for one in faces]


def _share_of_slants(patterns: Sequence[Pattern | None]) -> float:
    """How much of what the patterns of faces that were fitted as parallel are off, in squares, their slants explain."""
    seen = [one for one in patterns if one is not None]
    total = sum(float(one.count @ one.height**2) for one in seen)
    return 1 - sum(float(one.count @ one.beside_plane() ** 2) for one in seen) / total if seen else 0.0


def _note_on_angle(
    left: Left, points: Array, part: Parts, names: Sequence[Message], share: float, *, lies: bool
) -> Message:
    """A note that faces fitted as parallel are not, which explains that share of what is `left`.

    Levels are compared with the one to which all points are nearest to parallel. Those are named that rise against it
    by at least half as much as the one that rises most.
    """
    slants, extents, count = [], [], np.bincount(part)
    for number in range(len(names)):
        on = part == number
        flat = points[on] @ square_to(left.outward[0])
        flat -= flat.mean(axis=0)
        slants.append(np.linalg.lstsq(flat, left.misfit[on] - left.misfit[on].mean(), rcond=None)[0])
        extents.append(float(np.linalg.norm(flat, axis=1).max()))
    between = np.linalg.norm(np.array(slants)[:, None] - np.array(slants), axis=2)
    if lies:
        deg = float(np.degrees(np.arctan(between.max())))
        return note_of("form.askew", name=list(names), deg=deg, percent=100 * share)
    reference = int(np.argmin(between @ count))
    rise = between[reference] * extents
    slanting = np.flatnonzero(rise >= _CARRIED * rise.max())
    return note_of(
        "form.levels_askew",
        reference=names[reference],
        name=[names[int(number)] for number in slanting],
        deg=float(np.degrees(np.arctan(between[reference, slanting].max()))),
        percent=100 * share,
    )


def notes_on_deviation(cloud: Cloud, deviation: Array, normals: Array, errors: PointErrors) -> tuple[Message, ...]:
    """Make the note on a significant pattern in deviations (N,) in mm from a nominal surface; () if there is none.

    `normals` (N, 3) are of the nominal surface. At most one note, none on scatter: a map has no margin, and points at
    edges, which no fit has left out, scatter more than they can state. What they scatter makes a pattern less sure.
    """
    one = np.zeros(len(cloud), dtype=np.int64)
    places = Places.in_picture(cloud.uv, one)
    found = judge_form(cloud, Left.of_nominal(cloud.points, deviation, normals), one, places, errors)
    if found is None:
        return ()
    pattern = pattern_on(found, places, 0, cloud)
    if pattern is None:
        return ()
    most = int(np.argmax(np.abs(pattern.height)))
    return (
        note_of(
            "form.off_nominal",
            place=_region(pattern.at[most]),
            mm=abs(float(pattern.height[most])),
            where=_UP if pattern.height[most] > 0 else _DOWN,
        ),
    )


@dataclass(frozen=True, eq=False, slots=True)
class Pattern:
    """Pattern of a face: `height` (n,) in mm of places from their mean, `count` (n,) of stretches, `at` (n, sides)."""

    height: Array
    count: NDArray[np.intp]
    at: Array

    def beside_plane(self) -> Array:
        """Compute the part (n,) in mm of the pattern's heights that a tilted plane does not explain."""
        slant, root = np.column_stack([np.ones(len(self.at)), self.at]), np.sqrt(self.count)
        solved = np.linalg.lstsq(slant * root[:, None], self.height * root, rcond=None)[0]
        return np.asarray(self.height - slant @ solved)


def pattern_on(found: Judgement, places: Places, number: int, face: Cloud) -> Pattern | None:
    """Compute the pattern of mean residuals over face `number`; None unless it is significant and large."""
    count = found.count[places.of_face(number)]
    seen = np.flatnonzero(count)
    if found.p >= SURELY or len(seen) < _LEAST_PATCHES[len(places.sides)]:
        return None
    profile = found.profile[places.of_face(number)][seen]
    height = np.asarray(profile - np.average(profile, weights=count[seen]), dtype=np.float64)
    if np.ptp(height) <= STANDS_OUT_PX * _pixel_mm(face):
        return None
    return Pattern(height, count[seen], places.flat(seen))


def _pixel_mm(cloud: Cloud) -> float:
    """Size of a pixel in mm on the surface, square to the line of sight."""
    return pixel_angle(cloud.points, cloud.uv) * float(np.median(cloud.points[:, 2]))


def of_scatter(found: Judgement, names: Sequence[Message]) -> tuple[Message, ...]:
    """Make the note that points scatter more than their stated σ; () unless they certainly do."""
    asked = ((found.whole, found.whole_freedom), (found.alone, found.freedom))
    if any(times <= TIMES or _by_chance(times, freedom) >= SURELY for times, freedom in asked):
        return ()
    return (note_of("form.scatter", name=list(names), times=found.whole),)


def _by_chance(times: float, freedom: float) -> float:
    """Probability that a scatter of so many degrees of freedom is so many times what it should be."""
    return float(chdtrc(freedom, freedom * times**2)) if freedom > 0 else 1.0


def _of_pattern(pattern: Pattern, places: Places, number: int, name: Message) -> Message:
    """A note on the pattern of one face."""
    height, count = pattern.height, pattern.count
    form, root = _parabola(pattern.at), np.sqrt(count)
    solved = np.linalg.lstsq(form * root[:, None], height * root, rcond=None)[0]
    bowl = form @ solved
    explained = 1 - float(count @ (height - bowl) ** 2) / float(count @ height**2)
    middle = float(solved[0] - np.average(bowl, weights=count))
    if explained > _MOST and abs(middle) > np.ptp(bowl) / 4:
        where, to_edges = ABOVE if middle > 0 else BELOW, places.sides[0] / (places.sides[0] - 1)
        return note_of(
            "form.bowed", name=name, mm=float(np.ptp(_parabola(to_edges * pattern.at) @ solved)), where=where
        )
    most = int(np.argmax(np.abs(height)))
    size, where = abs(float(height[most])), _UP if height[most] > 0 else _DOWN
    if len(places.sides) == 1:
        first, last = places.mm[number]
        return note_of(
            "form.uneven_along",
            name=name,
            at_mm=float(first + (pattern.at[most, 0] + 1) / 2 * (last - first)),
            mm=size,
            where=where,
        )
    return note_of("form.uneven", name=name, place=_region(pattern.at[most]), mm=size, where=where)


def _region(at: Array) -> Message:
    """Name of the part of a face that a place (2,) across and down is in."""
    third = [int(one > -1 / 3) + int(one > 1 / 3) for one in at]
    return REGIONS[3 * third[1] + third[0]]


def _parabola(at: Array) -> Array:
    """(n, 3 or 6) what the coefficients of a parabola are multiplied by at places (n, 1 or 2) of a face."""
    if at.shape[1] == 1:
        return np.hstack([np.ones((len(at), 1)), at, at * at])
    x, y = at.T
    return np.column_stack([np.ones(len(x)), x, y, x * x, x * y, y * y])
