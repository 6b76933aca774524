"""Scores of cuts: what their pixels say about the stripe's place; see `core.image.stripes.likelihood.refinement`.

A row (column) cuts a slanting stripe so that its flanks lie up to ten pixels apart along it, on different grains and
on light of different height. There each pixel counts for the cut through its own foot on the line, the point nearest
to it: what such a cut says is that of a section at right angles, read from some rows (columns) on either side.

Sixteen cuts are worked out at once: their pixels are copied to one array, a cut a column of it, and then looked at in
single precision in a loop over the cuts, which compilers turn into a few instructions for all of them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import inlined
from core.image.stripes.likelihood.cut_model import TAIL, Light, cut_model
from core.image.stripes.likelihood.influence import DEGREE, REACH
from core.image.stripes.likelihood.measured_section import PLACES_PER_SIGMA
from core.image.stripes.section_fit import DARK
from core.image.stripes.tracing.pixel_state import IGNORED, SATURATED
from core.image.stripes.tracing.seeds import Picture
from core.model.arrays import Array
from core.model.small_arrays import new_indices, new_single_table, zero_table

Float32 = NDArray[np.float32]
F = np.float32

_CUTS_AT_ONCE = 16  # numbers of single precision in one instruction of today's widest processors
_TOGETHER = 8  # cuts that have their first pixel in the same column (row), so that they are read together
_START, _ACROSS, _BEND, _FADE, _WIDENING, _HEIGHT, _INVERSE, _BACKGROUND, _SLOPE, _OTHER, _PER_LIGHT = range(11)
"""Rows of `_Block.figures`."""
_FIGURES = 11  # number of these rows
_SUMS = 7  # over the pixels of a cut
_SLANTING = 1.5  # rows (columns) from a cut to the foot of its last pixel; with less it is as good as at right angles
_BENT = 0.005  # 1/px: with more, cuts worked out together run in too different directions to share which rows they need
_HALF, _ONE, _EIGHTH, _SIXTEENTH = F(0.5), F(1), F(0.125), F(0.0625)  # in single precision
_NEXT_TERM = F(0.0390625)  # 5/128, of the series of 1 − √(1 − x)
_END = F(0.5 * REACH**2)  # exponent x²/2s² at the end of the weights
_IN_TAIL = F(0.5 * TAIL**2)  # the same where the tails begin
_TO_TAU = F(4 / REACH**2)  # from that exponent to τ + 1 of `influence`
_DARK = F(DARK)  # in single precision


class _Block(NamedTuple):
    """Up to _CUTS_AT_ONCE cuts, and where they are worked out.

    `cut`, `line` and `first` (_CUTS_AT_ONCE,) are their numbers and the rows (columns) and first pixels looked at,
    `grey` and `seen` (P, _CUTS_AT_ONCE) these pixels and whether they can be used, 1 or 0, `figures` (_FIGURES,
    _CUTS_AT_ONCE) what is expected of them, `weight` and `measured` what `Light` has of weights and sections, `sums`
    (_SUMS, _CUTS_AT_ONCE) what they say.
    """

    cut: NDArray[np.int64]
    line: NDArray[np.int64]
    first: NDArray[np.int64]
    grey: Float32
    seen: Float32
    figures: Float32
    weight: Float32
    measured: Float32
    sums: Float32


@inlined(fastmath=True)
def score_cuts(
    picture: Picture,
    state: NDArray[np.uint8],
    run: Array,
    cuts: Array,
    clear: NDArray[np.bool_],
    light: Light,
) -> Array:
    """Compute Σ ψ·(I − model) and Σ ψ·d over the pixels of K cuts of a `run` (N, 5): (K, 2), 0 if unusable."""
    model, sums, longest = light.sections, zero_table(len(cuts), 2), max(picture.shape[0], picture.shape[1])
    block = _Block(
        new_indices(_CUTS_AT_ONCE),
        new_indices(_CUTS_AT_ONCE),
        new_indices(_CUTS_AT_ONCE),
        new_single_table(longest, _CUTS_AT_ONCE),
        new_single_table(longest, _CUTS_AT_ONCE),
        new_single_table(_FIGURES, _CUTS_AT_ONCE),
        new_single_table(1, light.weights.shape[1])[0],
        light.measured,
        new_single_table(_SUMS, _CUTS_AT_ONCE),
    )
    _see_all(block.seen, longest)
    usable = _usable(picture.shape, run, cuts, clear, model)
    around = _lines_around(run, cuts, usable, model)
    begin = 0
    while begin < len(usable):
        upright, slants, end = cuts[usable[begin], 4] > 0, around[usable[begin]] > 0, begin
        while end < min(begin + _CUTS_AT_ONCE, len(usable)):
            if (cuts[usable[end], 4] > 0) != upright or (around[usable[end]] > 0) != slants:
                break
            end += 1
        backwards = cuts[usable[end - 1], 1] < cuts[usable[begin], 1]
        for lane in range(_CUTS_AT_ONCE):  # the last cut fills a block up
            block.cut[lane] = usable[max(end - 1 - lane, begin) if backwards else min(begin + lane, end - 1)]
        _prepare(run, cuts, light, block)
        if slants:
            _look_at_feet(picture, state, run, cuts, model, around, block)
        else:
            pixels = _aim(picture.shape, run, cuts, model, block)
            _look(picture, state, pixels, upright, 0.0, block)
        for lane in range(end - begin):
            c = block.cut[lane]
            near = int(cuts[c, 3])
            sums[c, 0], sums[c, 1] = _score(block.sums, lane, model[near, 0], model[near, 1])
        begin = end
    return sums


@inlined(fastmath=True)
def _lines_around(run: Array, cuts: Array, usable: NDArray[np.int64], model: Array) -> NDArray[np.int64]:
    """How many rows (columns) on either side have pixels whose feet are on a cut, for each cut.

    None where the stripe hardly slants or bends much, and where those rows (columns) are not all `usable` cuts.
    """
    lines, place = new_indices(len(cuts)), new_indices(len(cuts))
    for c in range(len(cuts)):
        lines[c], place[c] = 0, -1
    for k in range(len(usable)):
        place[usable[k]] = k
    for c in usable:
        near = int(cuts[c, 3])
        farthest = REACH * model[near, 1] * min(abs(run[near, 2]), abs(run[near, 3]))
        number = math.ceil(farthest)
        first, last = c - number, c + number
        if farthest < _SLANTING or abs(run[near, 4]) > _BENT or first < 0 or last >= len(cuts):
            continue
        if place[first] < 0 or place[last] < 0:
            continue
        in_order = abs(cuts[last, 1] - cuts[first, 1]) == 2 * number and cuts[first, 4] == cuts[last, 4]
        if in_order and place[last] - place[first] == 2 * number:
            lines[c] = number
    return lines


@inlined(fastmath=True)
def _see_all(seen: Float32, pixels: int) -> None:
    """All of the first pixels can be used."""
    for i in range(pixels):
        for k in range(_CUTS_AT_ONCE):
            seen[i, k] = F(1)


@inlined(fastmath=True)
def _usable(
    shape: tuple[int, int], run: Array, cuts: Array, clear: NDArray[np.bool_], model: Array
) -> NDArray[np.int64]:
    """The numbers of the cuts that are clear and lie wholly within the picture."""
    found, count = new_indices(len(cuts)), 0
    for c in range(len(cuts)):
        near, upright = int(cuts[c, 3]), cuts[c, 4] > 0
        lines, length = shape if upright else shape[::-1]
        half = REACH * model[near, 1] / abs(run[near, 2] if upright else run[near, 3])
        inside = 0 <= cuts[c, 1] < lines and cuts[c, 2] - half > -1 and cuts[c, 2] + half < length
        if clear[near] and model[near, 0] > 0 and inside:
            found[count] = c
            count += 1
    return found[:count]


@inlined(fastmath=True)
def _prepare(run: Array, cuts: Array, light: Light, block: _Block) -> None:
    """Fill in the figures of the cuts of a block, and no sums."""
    upright, figures = cuts[block.cut[0], 4] > 0, block.figures
    kind = light.kind[int(cuts[block.cut[_TOGETHER], 3])]
    for k in range(len(block.weight)):
        block.weight[k] = light.weights[kind, k]
    for lane in range(_CUTS_AT_ONCE):
        model = cut_model(run, light, int(cuts[block.cut[lane], 3]), upright)
        figures[_ACROSS, lane], figures[_BEND, lane] = 2 * model.across, model.bend
        figures[_FADE, lane], figures[_WIDENING, lane] = model.fade, 2 * model.widening
        figures[_HEIGHT, lane], figures[_INVERSE, lane] = model.height, 0.5 / (model.width * model.width)
        figures[_BACKGROUND, lane], figures[_SLOPE, lane] = model.background, model.slope
        figures[_OTHER, lane], figures[_PER_LIGHT, lane] = model.other, model.per_light
    for a in range(_SUMS):
        for k in range(_CUTS_AT_ONCE):
            block.sums[a, k] = F(0)


@inlined(fastmath=True)
def _aim(shape: tuple[int, int], run: Array, cuts: Array, model: Array, block: _Block) -> int:
    """Choose the pixels of the block's cuts themselves; how many of each."""
    upright, pixels = cuts[block.cut[0], 4] > 0, 0
    for begin in range(0, _CUTS_AT_ONCE, _TOGETHER):
        first, last = 1e9, -1e9
        for lane in range(begin, begin + _TOGETHER):
            cut = cuts[block.cut[lane]]
            near = int(cut[3])
            half = REACH * model[near, 1] / abs(run[near, 2] if upright else run[near, 3])
            first, last = min(first, math.ceil(cut[2] - half)), max(last, math.floor(cut[2] + half))
        pixels = max(pixels, int(last - first) + 1)
        for lane in range(begin, begin + _TOGETHER):
            block.first[lane] = int(first)
    length = shape[1] if upright else shape[0]
    for lane in range(_CUTS_AT_ONCE):
        cut = cuts[block.cut[lane]]
        block.line[lane], block.first[lane] = int(cut[1]), min(block.first[lane], length - pixels)
        block.figures[_START, lane] = block.first[lane] - cut[2]
    return pixels


@inlined(fastmath=True)
def _look_at_feet(
    picture: Picture,
    state: NDArray[np.uint8],
    run: Array,
    cuts: Array,
    model: Array,
    around: NDArray[np.int64],
    block: _Block,
) -> None:
    """Add up what the pixels say whose feet are on the block's cuts, from some rows (columns) `around` each."""
    middle = cuts[block.cut[_TOGETHER]]
    upright, near = middle[4] > 0, int(middle[3])
    ahead = -run[near, 2] * run[near, 3]  # rows (columns) from a pixel's own to its foot, per pixel along
    half = REACH * model[near, 1] / abs(run[near, 2] if upright else run[near, 3])
    pixels, length = math.ceil(2 * half), picture.shape[1] if upright else picture.shape[0]
    on = 1 if cuts[block.cut[0] + 1, 1] > cuts[block.cut[0], 1] else -1  # from a cut to that on the next line
    most = around[block.cut[0]]
    for lane in range(_CUTS_AT_ONCE):
        most = min(most, around[block.cut[lane]])
    first = 0
    while first < pixels:
        lines, behind = math.floor(ahead * (first + 0.5 - half) + 0.5), first + 1
        while behind < pixels and math.floor(ahead * (behind + 0.5 - half) + 0.5) == lines:
            behind += 1
        lines = max(-most, min(lines, most))
        for lane in range(_CUTS_AT_ONCE):
            cut = cuts[block.cut[lane] - on * lines]
            at = int(cut[3])
            begin = min(math.ceil(cut[2] - half) + first, length - (behind - first))
            block.line[lane], block.first[lane] = int(cut[1]), max(begin, 0)
            block.figures[_START, lane] = block.first[lane] - cut[2]
            block.figures[_ACROSS, lane] = 2 * (run[at, 2] if upright else run[at, 3])
            block.figures[_BEND, lane] = run[at, 4]
        _look(picture, state, behind - first, upright, lines / ahead, block)
        first = behind


@inlined(fastmath=True)
def _look(picture: Picture, state: NDArray[np.uint8], pixels: int, upright: bool, foot: float, block: _Block) -> None:
    """Add up what so many pixels of each line say; their cuts' feet are so far along it."""
    marked = _read(picture, state, pixels, upright, block)
    grey, seen = block.grey[:pixels], block.seen[:pixels]
    if block.measured.shape[1] == 0:
        _work_out(grey, seen, block.figures, F(foot), block.weight, block.sums)
    else:
        _work_out_measured(grey, seen, block.figures, foot, block.weight, block.measured, block.sums)
    if marked:
        _see_all(block.seen, pixels)


@inlined(fastmath=True)
def _read(picture: Picture, state: NDArray[np.uint8], pixels: int, upright: bool, block: _Block) -> bool:
    """Copy the pixels of a block; whether one of them is saturated or to be ignored."""
    bits, grey, last = 0, block.grey, _TOGETHER - 1
    for begin in range(0, _CUTS_AT_ONCE, _TOGETHER):
        first, line = block.first[begin], block.line[begin]
        side_by_side = block.line[begin + last] - line == last and block.first[begin + last] == first
        if side_by_side and not upright:  # as nearly always
            for i in range(pixels):
                row, marks = picture[first + i, line : line + _TOGETHER], state[first + i, line : line + _TOGETHER]
                for k in range(_TOGETHER):
                    grey[i, begin + k] = row[k]
                for k in range(_TOGETHER):
                    bits |= marks[k]
            continue
        for lane in range(begin, begin + _TOGETHER):
            line, first = block.line[lane], block.first[lane]
            for i in range(pixels):
                row, column = (line, first + i) if upright else (first + i, line)
                grey[i, lane] = picture[row, column]
                bits |= state[row, column]
    if bits & (SATURATED | IGNORED) == 0:
        return False
    for lane in range(_CUTS_AT_ONCE):
        first, line = block.first[lane], block.line[lane]
        for i in range(pixels):
            mark = state[line, first + i] if upright else state[first + i, line]
            block.seen[i, lane] = F(0) if mark & (SATURATED | IGNORED) else F(1)
    return True


@inlined(fastmath=True)
def _work_out(grey: Float32, seen: Float32, figures: Float32, foot: F, weight: Float32, sums: Float32) -> None:
    """Add to `sums` (_SUMS, lanes) those over the pixels of each cut that `_score` asks for.

    With r what the model leaves of a pixel and e = exp(−x²/2s²): Σ r·ψ, Σ x·e·ψ, Σ e·ψ, Σ r·e, Σ x·e², Σ e², and how
    many pixels near enough cannot be used: those not `seen`, and those that show other light. The exponential is that
    of `core.image.stripes.section_fit`, ψ/x that of `core.image.stripes.likelihood.influence.influences`.
    """
    w0, w1, w2, w3, w4, w5 = weight[0], weight[1], weight[2], weight[3], weight[4], weight[5]
    w6, w7, w8, w9, w10 = weight[6], weight[7], weight[8], weight[9], weight[DEGREE]
    n, nt, nh, e, et, eh, lost = sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6]
    for i in range(len(grey)):
        row, use, step = grey[i], seen[i], F(np.int32(i))
        for k in range(grey.shape[1]):
            along = step + figures[_START, k]
            on = along - foot
            bend = figures[_BEND, k]
            power = along * (figures[_ACROSS, k] - bend * along)  # of the pixel, to the circle of that bend
            turn = bend * power
            x = power * (_HALF + turn * (_EIGHTH + turn * (_SIXTEENTH + turn * _NEXT_TERM)))
            y = x * x * figures[_INVERSE, k]
            t = min(y * (_ONE - figures[_WIDENING, k] * on), _DARK) * _SIXTEENTH
            tail = _ONE - t * F(1 / 4) * (_ONE - t * F(1 / 5) * (_ONE - t * F(1 / 6) * (_ONE - t * F(1 / 7))))
            light = _ONE - t * (_ONE - t * F(1 / 2) * (_ONE - t * F(1 / 3) * tail))
            light *= light
            light *= light
            light *= light
            light *= light * (_ONE + figures[_FADE, k] * on)
            left = row[k] - (figures[_BACKGROUND, k] + figures[_SLOPE, k] * x + figures[_HEIGHT, k] * light)
            strange = (left * left > figures[_OTHER, k] + figures[_PER_LIGHT, k] * light) & (y > _IN_TAIL)
            used = F(0) if strange | (y > _END) else use[k]
            lost[k] += F(0) if y > _END else _ONE - used
            tau = y * _TO_TAU - _ONE
            psi = w4 + tau * (w5 + tau * (w6 + tau * (w7 + tau * (w8 + tau * (w9 + tau * w10)))))
            psi = used * x * (w0 + tau * (w1 + tau * (w2 + tau * (w3 + tau * psi))))
            n[k] += psi * left
            nt[k] += psi * light * x
            nh[k] += psi * light
            light *= used
            e[k] += light * left
            light *= light
            eh[k] += light
            et[k] += light * x


@inlined(fastmath=True)
def _work_out_measured(
    grey: Float32, seen: Float32, figures: Float32, foot: float, weight: Float32, measured: Float32, sums: Float32
) -> None:
    """`_work_out` for a measured section: light, its push −f' in place of x·e, and ψ are read from tables."""
    last = measured.shape[1] - 2
    for k in range(grey.shape[1]):
        inverse = math.sqrt(2 * figures[_INVERSE, k])
        sigma, bend, fade, widening = 1 / inverse, figures[_BEND, k], figures[_FADE, k], 0.5 * figures[_WIDENING, k]
        for i in range(len(grey)):
            along = i + figures[_START, k]
            on = along - foot
            power = along * (figures[_ACROSS, k] - bend * along)
            turn = bend * power
            x = power * (0.5 + turn * (0.125 + turn * (0.0625 + turn * _NEXT_TERM)))
            if abs(x * inverse) > REACH:
                continue
            place = (x * inverse * (1 - widening * on) + REACH) * PLACES_PER_SIGMA
            at = max(min(int(place), last), 0)
            behind = min(max(place - at, 0.0), 1.0)
            here = 1 - behind
            strength = 1 + fade * on
            light = strength * (here * measured[0, at] + behind * measured[0, at + 1])
            push = strength * sigma * (here * measured[1, at] + behind * measured[1, at + 1])
            left = grey[i, k] - (figures[_BACKGROUND, k] + figures[_SLOPE, k] * x + figures[_HEIGHT, k] * light)
            strange = left * left > figures[_OTHER, k] + figures[_PER_LIGHT, k] * max(light, 0.0)
            if seen[i, k] == 0 or (strange and abs(x * inverse) > TAIL):
                sums[6, k] += F(1)
                continue
            psi = sigma * (here * weight[at] + behind * weight[at + 1])
            sums[0, k] += F(psi * left)
            sums[1, k] += F(psi * push)
            sums[2, k] += F(psi * light)
            sums[3, k] += F(light * left)
            sums[4, k] += F(light * push)
            sums[5, k] += F(light * light)


@inlined(fastmath=True)
def _score(sums: Float32, k: int, height: float, width: float) -> tuple[float, float]:
    """Σ ψ·(I − model) and Σ ψ·d; where pixels are left out, the height is estimated together with the place."""
    n, nt, e, eh = sums[0, k], sums[1, k], sums[3, k], sums[5, k]
    if sums[6, k] > 0 and eh > 0:
        share = sums[2, k] / eh
        n, nt = n - share * e, nt - share * sums[4, k]
    inverse = 1 / width
    return n * inverse, max(nt * height * inverse * inverse * inverse, 0.0)
