"""Length of runs of line points, and the cutting of their ends.

Everything here works on the order of the points along the stripe; the picture is not looked at again.
"""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.image.stripes.tracing.ridge import kernel_radius
from core.model.arrays import Array
from core.model.small_arrays import backwards, column, first_above, first_not_below, median_of, new_row

# Ends of a stripe: the filter sees only half of it there. Held by tests/image/stripes/test_extraction.py (ends are
# trimmed) on stripes that end.
END_TRIM_PX = 4.0
"""Px left out at each end, at least."""
_END_TRIM = 2.5  # the same in filter σ
_END_HEIGHT = 0.5  # an end is where the response falls to this share of what it is further in,
_FURTHER_IN = (3.0, 9.0)  # which is its median so many filter σ from the end

# Stripes that leave the picture: their ends are no ends. Held by the same tests (where the filter leaves the picture).
BORDER_PX = 3.0
"""Px from where the filter would leave the picture: a run that stops so near stops for that."""
_UNDIMMED = 0.9  # of the response further in: with less the stripe itself ends there

# An oblique shadow at an end. Held by the same tests (oblique shadow, fades) on shadows and on surfaces that turn away.
_FADE_REACH, _FADE_SHARE = 20.0, 0.2  # filter σ from an end, and share of the run, within which a shadow is looked for
_UNFADED = 2.5  # times that reach: up to there is what it is compared with,
_MIDDLE = 0.5 * (1 + _UNFADED)  # and here its middle
_FADED = 0.8  # share of height · width² further in: with less it is a shadow or a surface that turns away;
_NARROWED = 0.9  # share of width² further in: with less it is a shadow
_MEAN_REACH = 1.5  # filter σ on either side over which width² is averaged


@compiled(inline=True)
def arc_length(run: Array) -> Array:
    """Compute the length in px along a run (N, ≥ 2) from its first point to each point, (N,)."""
    arc = new_row(len(run))
    arc[0] = 0.0
    for k in range(1, len(run)):
        du, dv = run[k, 0] - run[k - 1, 0], run[k, 1] - run[k - 1, 1]
        arc[k] = arc[k - 1] + math.sqrt(du * du + dv * dv)
    return arc


def correlation_length(filter_px: float) -> float:
    """Compute the length in px, 2√π σ of the filter, over which the noise of a stripe's points counts as one error."""
    return 2 * math.sqrt(math.pi) * filter_px


def cut_ends(run: Array, filter_px: float, shape: tuple[int, ...]) -> Array:
    """Cut the ends off a run (N, 5) u, v, n_u, n_v, response where its response falls to half, and a few px more.

    Where it only stops because the filter would leave the picture (`shape`), the stripe goes on: nothing is cut.
    """
    height, width = shape
    border = kernel_radius(filter_px) + BORDER_PX
    trim = max(END_TRIM_PX, _END_TRIM * filter_px)
    first, last = _lit(run, arc_length(run), filter_px, trim, border, (height, width))
    return run[first:last]


@compiled()
def _lit(
    run: Array, arc: Array, filter_px: float, trim: float, border: float, shape: tuple[int, int]
) -> tuple[int, int]:
    """First and past-the-last point of a run between its ends and `trim` px more."""
    whole, last = arc[-1], len(run) - 1
    start, end = 0.0, whole
    arc_back, response = _from_its_end(arc), column(run, 4)
    response_back = backwards(response)
    if not _leaves_picture(arc, response, filter_px, _inside(run, 0, shape), border):
        start = _real_end(arc, response, filter_px) + trim
    if not _leaves_picture(arc_back, response_back, filter_px, _inside(run, last, shape), border):
        end = whole - _real_end(arc_back, response_back, filter_px) - trim
    return first_not_below(arc, start), first_above(arc, end)


@inlined()
def _from_its_end(arc: Array) -> Array:
    """The length along a run (N,), counted from its last point."""
    back, whole = backwards(arc), arc[-1]
    for k in range(len(back)):
        back[k] = whole - back[k]
    return back


@inlined()
def _inside(run: Array, k: int, shape: tuple[int, int]) -> float:
    """How far in px a point of a run is from the border of the picture."""
    u, v = run[k, 0], run[k, 1]
    return float(min(min(u, shape[1] - 1 - u), min(v, shape[0] - 1 - v)))


@inlined()
def _leaves_picture(arc: Array, response: Array, filter_px: float, inside: float, border: float) -> bool:
    """Whether a run starts at the border of the picture as bright as it is further in."""
    if inside > border:
        return False
    usual, dimmest = _usual_response(arc, response, filter_px), math.inf
    for k in range(min(first_not_below(arc, filter_px) + 1, len(arc))):  # a few points tell it more surely than one
        dimmest = min(dimmest, response[k])
    return usual > 0 and dimmest >= _UNDIMMED * usual


@inlined()
def _usual_response(arc: Array, response: Array, filter_px: float) -> float:
    """The response a little way in from the start of a run; 0 for one that is too short."""
    first, last = first_not_below(arc, _FURTHER_IN[0] * filter_px), first_above(arc, _FURTHER_IN[1] * filter_px)
    return median_of(response, first, last) if last > first else 0.0


@inlined()
def _real_end(arc: Array, response: Array, filter_px: float) -> float:
    """Length in px at which the response first reaches half of what it is further in."""
    half = _END_HEIGHT * _usual_response(arc, response, filter_px)
    if half == 0.0:
        return 0.0
    for k in range(len(arc)):
        if response[k] >= half:
            return float(arc[k])
    return 0.0


@compiled()
def fully_lit(arc: Array, height: Array, width: Array, filter_px: float) -> tuple[int, int]:
    """Find first and past-the-last point of a run between shadows at its ends, by height and width (N,).

    An oblique shadow cuts the stripe on one side first and pulls the line to the other while its crest is still as
    bright as before. What gives it away is height · width², which speckle hardly changes: its grains make the stripe
    dimmer and wider, or brighter and narrower. Where a surface turns away from the laser that falls too, but the stripe
    gets no narrower as it fades: that is no shadow. Nor is it one where light and width go on falling as they do
    further in: so the light of a laser's line falls towards its ends.
    """
    square = new_row(len(width))
    for k in range(len(width)):
        square[k] = width[k] * width[k]
    first = _fading(arc, height, square, filter_px)
    last = len(arc) - _fading(_from_its_end(arc), backwards(height), backwards(square), filter_px)
    return first, max(first, last)


@inlined()
def _fading(arc: Array, height: Array, square: Array, filter_px: float) -> int:
    """How many points at the start are in a shadow's edge: less light than the stretch behind them, and narrower."""
    reach = min(_FADE_REACH * filter_px, _FADE_SHARE * arc[-1])
    first, last = first_not_below(arc, reach), first_above(arc, _UNFADED * reach)
    if last <= first:
        return 0
    light = new_row(last - first)
    for k in range(first, last):
        light[k - first] = height[k] * square[k]
    if height[0] * square[0] >= _FADED * median_of(light, 0, last - first):  # mostly: a fall only asks for less
        return 0
    middle = first_not_below(arc, _MIDDLE * reach)
    usual, fall = _level_and_fall(light, 0, middle - first, last - first)
    faded = 0
    while (
        height[faded] * square[faded] < _FADED * (usual - fall * (_MIDDLE - arc[faded] / reach)) and arc[faded] < reach
    ):
        faded += 1
    usual, fall = _level_and_fall(square, first, middle, last)
    half = round(_MEAN_REACH * filter_px)
    for k in range(faded - 1, -1, -1):
        total, start, end = 0.0, max(k - half, 0), min(k + half + 1, len(square))
        for i in range(start, end):
            total += square[i]
        if total / (end - start) < _NARROWED * (usual - fall * (_MIDDLE - arc[k] / reach)):
            return k + 1
    return 0


@inlined()
def _level_and_fall(values: Array, first: int, middle: int, last: int) -> tuple[float, float]:
    """Median of `values` from `first` to `last`, and by how much they fall over one reach towards the start, or 0."""
    whole = median_of(values, first, last)
    if not first < middle < last:
        return whole, 0.0
    fall = median_of(values, middle, last) - median_of(values, first, middle)
    return whole, max(fall / (_MIDDLE - 1), 0.0)
