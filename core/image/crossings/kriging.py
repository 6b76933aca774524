"""Position of a line from all of its bins nearby: kriging with a curvature learned from the line itself.

Over a window of ± `reach` the line is y(x) in a frame laid along it. Place, direction and curvature at x = 0 are free,
and on its way outwards the curvature is renewed at random, with standard deviation δ and correlation length ℓ: δ = 0
is a parabola, and what else there is a smoothing spline, as stiff as δ and ℓ say. For given (δ, ℓ) the answer at x = 0
has the least variance there is, and that variance counts what the curvature may hide. They are not given. So every
choice of a grid is weighed with the (restricted) likelihood of the window's bins, and mean and variance are taken over
all: a flat face gives the whole window as a parabola, a bent surface as much of it as is of use, and the standard
uncertainty says which.

A straight line is not among the choices. It would be a third better where lines are straight, but a lens bends them all
the same way, by less than one window shows and by more than the many windows of a scan can bear: taken for straight
they are all off to one side.

Both sides of x = 0 are Markov chains that start there. An information filter that comes in from the far end reduces
each to a normal likelihood of (y, y'·reach, y''·reach²) at x = 0: ten numbers, called a side below: Λ (upper triangle,
row by row), η, and the logarithm of the likelihood.

References
----------
Wahba, G., Improper priors, spline smoothing and the problem of guarding against model errors in regression, J. R.
Statist. Soc. B 40 (1978), doi:10.1111/j.2517-6161.1978.tb01050.x.
Kohn, R., Ansley, C. F., A new algorithm for spline smoothing based on smoothing a stochastic process, SIAM J. Sci.
Stat. Comput. 8 (1987), doi:10.1137/0908004.
Hoeting, J. A. et al., Bayesian model averaging: a tutorial, Statistical Science 14 (1999), doi:10.1214/ss/1009212519.
"""

from __future__ import annotations

import math

from core.compiled import inlined
from core.model.arrays import Array
from core.model.small_arrays import new_row, new_table, row_of, zero_table

X, Y, INFORMATION, SPREAD = 0, 1, 2, 3
"""Columns of a bin: its place in the frame, 1/σ² of y in px⁻², the variance in px² of its points along the line."""

# The grid of choices (δ, ℓ) and its prior. Held by tests/image/crossings/test_crossing_bound.py on lines of changing
# curvature, which cross nearly as well as if one knew how it changes.
_LEAST_CHANGE, _CHANGE_FACTOR, _STEPS = 4.0, 3.0, 11
"""The least δ·reach²/σ that is not 0, by what it grows and how often; σ is that of a straight line in its middle."""
_LENGTHS = (0.5, 0.12)
"""Correlation lengths ℓ in reaches of the window."""
_CHOICES = 1 + len(_LENGTHS) * _STEPS
"""Number of choices (δ, ℓ); the first is the parabola."""
_PRIOR_PARABOLA = 0.9
"""Probability that δ = 0 before the line is seen."""
_CURVATURE_SD = 0.02
"""Standard deviation in 1/px that a curvature has before the line is seen: free, unless the window is very short."""
_VARIANCE_FACTOR = 1.1
"""Of the variance where the curvature changes: a window shows δ by a few bends only."""
_Side = tuple[float, float, float, float, float, float, float, float, float, float]
_SIDE = 10
"""Number of figures of a side."""
_NEGLIGIBLE = 15.0
"""A log-likelihood so far below the best has no weight (e⁻¹⁵), nor have those of still larger δ."""


@inlined()
def krige(right: Array, left: Array, reach: float) -> Array:
    """Estimate a line at x = 0 by kriging: (6,) y, y', y'', variance of y, likeliest choice and its variance.

    `right` (N, 4) and `left` (M, 4) are the bins at x ≥ 0 and x < 0, each from 0 outwards.
    """
    sigma = straight_sigma(right, left)
    kappa = _CURVATURE_SD * reach**2
    score, found = row_of(_CHOICES, -math.inf), zero_table(_CHOICES, 4)
    side, best = new_row(_SIDE), -math.inf
    for length in range(len(_LENGTHS)):
        for step in range(_STEPS + 1):
            change = 0 if step == 0 else length * _STEPS + step
            if change == 0 and length > 0:
                continue
            delta, correlation = _change(change, reach, sigma)
            _join(_side(right, reach, delta, correlation), _side(left, -reach, delta, correlation), side)
            score[change] = _solve(side, kappa, found[change]) + _log_prior(change)
            if score[change] < best - _NEGLIGIBLE and step > 1 and score[change] < score[change - 1]:
                break
            best = max(best, score[change])
    weight, total, likeliest = new_row(_CHOICES), 0.0, 0
    for change in range(_CHOICES):
        weight[change] = math.exp(score[change] - best)
        total += weight[change]
        if score[change] > score[likeliest]:
            likeliest = change
    result, bends = row_of(6, 0.0), 0.0
    for change in range(_CHOICES):
        weight[change] /= total
        for i in range(3):
            result[i] += weight[change] * found[change, i]
    for change in range(1, _CHOICES):
        bends += weight[change] * (found[change, 3] + (found[change, 0] - result[0]) ** 2)
    result[3] = weight[0] * (found[0, 3] + (found[0, 0] - result[0]) ** 2) + _VARIANCE_FACTOR * bends
    result[1], result[2] = result[1] / reach, result[2] / reach**2
    result[4], result[5] = likeliest, found[likeliest, 3]
    return result


@inlined()
def influence(right: Array, left: Array, reach: float, sigma: float, change: int) -> float:
    """Compute y in px of a line at x = 0 under assumption number `change` on how much its curvature varies.

    It is linear in the y of bins `right` (N, 4), `left` (M, 4).
    """
    delta, correlation = _change(change, reach, sigma)
    found, side = new_row(4), new_row(_SIDE)
    _join(_side(right, reach, delta, correlation), _side(left, -reach, delta, correlation), side)
    _solve(side, _CURVATURE_SD * reach**2, found)
    return float(found[0])


@inlined()
def log_odds_of_break(right: Array, left: Array, reach: float) -> float:
    """Compute how much likelier bins `right` (N, 4), `left` (M, 4) are two lines than one, as log odds.

    Per px² of jump·kink·reach.

    At least three bins on each side. The standard deviation of the curvature at x = 0 is tried like δ here: two lines
    must not be the less likely for having two curvatures.
    """
    sigma = straight_sigma(right, left)
    scores, found, sides = new_table(3, _CHOICES * _STEPS), new_row(4), new_table(3, _SIDE)
    for change in range(_CHOICES):
        delta, correlation = _change(change, reach, sigma)
        ahead, behind = _side(right, reach, delta, correlation), _side(left, -reach, delta, correlation)
        _join(ahead, behind, sides[0])
        for k in range(_SIDE):
            sides[1, k], sides[2, k] = ahead[k], behind[k]
        for which in range(3):
            for step in range(_STEPS):
                kappa = _LEAST_CHANGE * _CHANGE_FACTOR**step * sigma
                fit = _solve(sides[which], kappa, found)
                scores[which, change * _STEPS + step] = fit + _log_prior(change) - math.log(_STEPS)
    return _log_sum(scores[1]) + _log_sum(scores[2]) - _log_sum(scores[0])


@inlined()
def _log_sum(scores: Array) -> float:
    """Logarithm of the sum of what the `scores` (N,) are logarithms of."""
    best, total = scores[0], 0.0
    for k in range(len(scores)):
        best = max(best, scores[k])
    for k in range(len(scores)):
        total += math.exp(scores[k] - best)
    return float(best + math.log(total))


@inlined()
def straight_sigma(right: Array, left: Array) -> float:
    """Compute the standard uncertainty in px of a straight line through bins `right`, `left` (N, 4) at its middle."""
    ahead, behind = 0.0, 0.0
    for k in range(len(right)):
        ahead += right[k, INFORMATION]
    for k in range(len(left)):
        behind += left[k, INFORMATION]
    return 1 / math.sqrt(ahead + behind)


@inlined()
def _change(change: int, reach: float, sigma: float) -> tuple[float, float]:
    """δ·reach² in px and ℓ in px of a number."""
    if change == 0:
        return 0.0, reach
    step, length = (change - 1) % _STEPS, (change - 1) // _STEPS
    return _LEAST_CHANGE * _CHANGE_FACTOR**step * sigma, _LENGTHS[length] * reach


@inlined()
def _log_prior(change: int) -> float:
    return math.log(_PRIOR_PARABOLA if change == 0 else (1 - _PRIOR_PARABOLA) / (_CHOICES - 1))


@inlined()
def _join(ahead: _Side, behind: _Side, side: Array) -> None:
    """Both sides as one; x runs outwards in each, so y' counts the other way on the left."""
    for k in range(_SIDE):
        side[k] = ahead[k] - behind[k] if k in (1, 4, 7) else ahead[k] + behind[k]


@inlined()
def _solve(side: Array, kappa: float, found: Array) -> float:
    """Log-likelihood if y''·reach² has the standard deviation κ; into `found` y, y'·reach, y''·reach², var y."""
    l00, l01, l02, l11, l12 = side[0], side[1], side[2], side[3], side[4]
    e0, e1, e2 = side[6], side[7], side[8]
    l22 = side[5] + 1 / kappa**2
    c00, c01, c02 = l11 * l22 - l12 * l12, l02 * l12 - l01 * l22, l01 * l12 - l02 * l11
    c11, c12, c22 = l00 * l22 - l02 * l02, l01 * l02 - l00 * l12, l00 * l11 - l01 * l01
    determinant = l00 * c00 + l01 * c01 + l02 * c02
    found[0] = (c00 * e0 + c01 * e1 + c02 * e2) / determinant
    found[1] = (c01 * e0 + c11 * e1 + c12 * e2) / determinant
    found[2] = (c02 * e0 + c12 * e1 + c22 * e2) / determinant
    found[3] = c00 / determinant
    fit = found[0] * e0 + found[1] * e1 + found[2] * e2
    return float(side[9] + 0.5 * (fit - math.log(determinant)) - math.log(kappa))


@inlined()
def _side(bins: Array, reach: float, delta: float, length: float) -> _Side:
    """Likelihood of (y, y'·reach, y''·reach²) at x = 0 from one side; `reach` is negative on the left.

    From bin to bin y'' is autoregressive and runs straight: x_k = F x_{k−1} + g w with F = [[1, d, d²(1/3 + ρ/6)],
    [0, 1, d(1 + ρ)/2], [0, 0, ρ]], g = (d²/6, d/2, 1) and w of variance δ²(1 − ρ²).
    """
    l00 = l01 = l02 = l11 = l12 = l22 = e0 = e1 = e2 = score = 0.0
    for k in range(len(bins) - 1, -1, -1):
        w, y, h = bins[k, INFORMATION], bins[k, Y], 0.5 * bins[k, SPREAD] / reach**2
        l00, l02, l22 = l00 + w, l02 + w * h, l22 + w * h * h
        e0, e2 = e0 + w * y, e2 + w * h * y
        d = (bins[k, X] - (bins[k - 1, X] if k > 0 else 0.0)) / reach
        rho = 1.0
        if delta > 0.0:
            rho = math.exp(-d * abs(reach) / length)
            q = delta * delta * (1 - rho * rho)
            g0, g1 = d * d / 6, 0.5 * d
            p0, p1, p2 = l00 * g0 + l01 * g1 + l02, l01 * g0 + l11 * g1 + l12, l02 * g0 + l12 * g1 + l22
            pe = e0 * g0 + e1 * g1 + e2
            s = 1 + q * (g0 * p0 + g1 * p1 + p2)
            score += 0.5 * (q * pe * pe / s - math.log(s))
            gain = q / s
            e0, e1, e2 = e0 - gain * p0 * pe, e1 - gain * p1 * pe, e2 - gain * p2 * pe
            l00, l01, l02 = l00 - gain * p0 * p0, l01 - gain * p0 * p1, l02 - gain * p0 * p2
            l11, l12, l22 = l11 - gain * p1 * p1, l12 - gain * p1 * p2, l22 - gain * p2 * p2
        f0, f1 = d * d * (1 / 3 + rho / 6), 0.5 * d * (1 + rho)
        a01, a02 = l00 * d + l01, l00 * f0 + l01 * f1 + l02 * rho
        a11, a12, a22 = l01 * d + l11, l01 * f0 + l11 * f1 + l12 * rho, l02 * f0 + l12 * f1 + l22 * rho
        l22 = f0 * a02 + f1 * a12 + rho * a22
        l12, l11, l01, l02 = d * a02 + a12, d * a01 + a11, a01, a02
        e1, e2 = d * e0 + e1, f0 * e0 + f1 * e1 + rho * e2
    return l00, l01, l02, l11, l12, l22, e0, e1, e2, score
