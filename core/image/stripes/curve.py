"""The smooth curve of a stripe: position, direction and curvature from a local parabola around every point."""

from __future__ import annotations

import math

from core.compiled import compiled, inlined
from core.image.stripes.running_statistics import quantile_of_magnitudes
from core.model.arrays import Array
from core.model.small_arrays import mean_of, new_row, new_table, zero_table

# Windows of the local parabolas. Held by tests/image/stripes/likelihood/test_refinement.py (bent stripes, tightest
# circles) on rendered arcs.
_ARM, _SHORTEST_ARM = 8.0, 3.0  # filter σ: half length of a window, on straight and on bent stripes
_LARGEST_ANGLE = 0.2  # rad from the middle of a window to its end: beyond, a parabola is no arc
_BEND_SAMPLE = 4  # points: every so many tell the run's curvature, which changes as slowly as the window is long


@inlined(fastmath={"contract", "arcp"})
def parabolas(run: Array, arc: Array, weight: Array, arm: float) -> Array:
    """Fit parabolas u(s), v(s) over ± `arm` px of arc around every point of a run: (N, 5) u, v, n_u, n_v, curvature.

    Parameters
    ----------
    run
        (N, ≥ 2) points, in pixels.
    arc
        (N,) length along the run.
    weight
        (N,) weight of each point.
    arm
        Half the length of a window; at the ends of the run it is not centred, but as long.

    Notes
    -----
    The tangent is (−n_v, n_u) and runs along the points; curvature is in 1/px, positive towards the normal. Running
    sums make the cost independent of `arm`. A window that holds too little for a parabola gives the point itself, the
    chord's direction and no curvature.
    """
    count = len(run)
    middle, centre_u, centre_v = 0.5 * (arc[0] + arc[-1]), mean_of(run, 0), mean_of(run, 1)
    sums = zero_table(count + 1, 11)  # Σ w x⁰…⁴, Σ w x⁰…² u, Σ w x⁰…² v
    for k in range(count):
        x, power = (arc[k] - middle) / arm, weight[k]
        for a in range(5):
            sums[k + 1, a] = sums[k, a] + power
            if a < 3:
                sums[k + 1, 5 + a] = sums[k, 5 + a] + power * (run[k, 0] - centre_u)
                sums[k + 1, 8 + a] = sums[k, 8 + a] + power * (run[k, 1] - centre_v)
            power *= x
    result, window, fit = new_table(count, 5), new_row(11), new_row(6)
    left, right = 0, 0
    for k in range(count):
        at = min(max(arc[k], arc[0] + arm), arc[-1] - arm)
        while left < count - 1 and arc[left] < at - arm:
            left += 1
        while right < count and arc[right] <= at + arm:
            right += 1
        for a in range(11):
            window[a] = sums[right, a] - sums[left, a]
        if not _solve(window, (arc[k] - middle) / arm, fit):
            before, behind = max(k - 1, 0), min(k + 1, count - 1)
            fit[0], fit[1], fit[2] = run[k, 0] - centre_u, run[behind, 0] - run[before, 0], 0.0
            fit[3], fit[4], fit[5] = run[k, 1] - centre_v, run[behind, 1] - run[before, 1], 0.0
        scale = 1 / math.sqrt(fit[1] * fit[1] + fit[4] * fit[4])
        nu, nv = fit[4] * scale, -fit[1] * scale
        result[k, 0], result[k, 1], result[k, 2], result[k, 3] = fit[0] + centre_u, fit[3] + centre_v, nu, nv
        result[k, 4] = (fit[2] * nu + fit[5] * nv) / (arm * arm)
    return result


@inlined(fastmath={"contract", "arcp"})
def _solve(m: Array, x: float, fit: Array) -> bool:
    """Value, slope and bend of u and of v at `x` from a window's sums (11,), into `fit` (6,); False if too few."""
    s0 = m[0]
    s1 = m[1] - x * m[0]
    s2 = m[2] - x * (2 * m[1] - x * m[0])
    s3 = m[3] - x * (3 * m[2] - x * (3 * m[1] - x * m[0]))
    s4 = m[4] - x * (4 * m[3] - x * (6 * m[2] - x * (4 * m[1] - x * m[0])))
    c00, c01, c02 = s2 * s4 - s3 * s3, s2 * s3 - s1 * s4, s1 * s3 - s2 * s2
    c11, c12, c22 = s0 * s4 - s2 * s2, s1 * s2 - s0 * s3, s0 * s2 - s1 * s1
    determinant = s0 * c00 + s1 * c01 + s2 * c02
    if determinant <= 1e-6 * s0**3:
        return False
    inverse = 1 / determinant
    for axis in range(2):
        t0, t1, t2 = m[5 + 3 * axis], m[6 + 3 * axis], m[7 + 3 * axis]
        t2 -= x * (2 * t1 - x * t0)
        t1 -= x * t0
        fit[3 * axis] = (c00 * t0 + c01 * t1 + c02 * t2) * inverse
        fit[3 * axis + 1] = (c01 * t0 + c11 * t1 + c12 * t2) * inverse
        fit[3 * axis + 2] = 2 * (c02 * t0 + c12 * t1 + c22 * t2) * inverse
    return True


@compiled(inline=True)
def smooth_curve(run: Array, arc: Array, weight: Array, filter_px: float) -> Array:
    """Fit a smooth curve through a run (N, ≥ 2): (N, 5) u, v, n_u, n_v, curvature by local parabolas.

    By `parabolas` over ± 8 filter σ, shorter ones where the run is bent.
    """
    curve = parabolas(run, arc, weight, _ARM * filter_px)
    sample = new_row((len(curve) + _BEND_SAMPLE - 1) // _BEND_SAMPLE)
    for k in range(len(sample)):
        sample[k] = curve[k * _BEND_SAMPLE, 4]
    bend = quantile_of_magnitudes(sample, 0.9)
    if bend * _ARM * filter_px > _LARGEST_ANGLE:
        curve = parabolas(run, arc, weight, max(_LARGEST_ANGLE / bend, _SHORTEST_ARM * filter_px))
    return curve
