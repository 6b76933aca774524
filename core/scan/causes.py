"""Which single cause, added to the model of a scan, explains most of what its crossings are off too much.

Each cause moves the misclosures of the crossings in a way of its own, B c with numbers c that are free:

- something *moved* between two frames: main plane and the rest, each with a shift and a turn (`core.scan.standstill`);
- the rig *drifted*: the picture shifted and its scale changed evenly from the reference to the last frame;
- the *rig changed* since its calibration: fan turned and shifted, picture shifted, focal length (`core.calibrate`);
- the fan's *lines bend*, each in the form that its calibration has seen;
- the *hand moved* while rows were read out: every sheet shifts and turns evenly over the rows;
- *second bounces*: every crossing of their light is off by itself.

The fan's light tells of movement and drift, too: of each of its stretches how far it lies aside in every frame
(`core.scan.fan_watch`), which jumps in a number of its own, or grows with time. Both measures are squares in variances
of their noise, and add up. Where the light is watched and surely at rest, nothing moved, whatever crossings would gain
by it: sweeps that all disagree with a fan whose lines bend are as if the surface had moved before the first of them.

With the network's unknowns eliminated, as in `core.scan.scan_evidence`, a cause takes E = gᵀ N⁻¹ g off the misfit, and
T = gᵀ Σ⁻¹ g is χ² distributed if it does nothing, with Σ the covariance of g by the crossings' whole noise and by what
the calibrations leave uncertain. Of those beyond chance, the likeliest takes most off, numbers that it spends counted
as noise. Then it is part of the model, and the others are tried on what is left: so a movement is not told of a rig
that drifts.

What is too large is the misfit without any of them, less the noise that is left with all that were found; noise above
what is stated counts as too large, and is explained by none. The measure is linear: of a picture that is shifted by
tens of pixels it sees a part, and there the share is that of `core.scan.single_change`.

References
----------
Rao, C. R., Large sample tests of statistical hypotheses concerning several parameters, Math. Proc. Cambridge Philos.
Soc. 44 (1948), doi:10.1017/S0305004100023987.
Chen, S., Billings, S. A., Luo, W., Orthogonal least squares methods, Int. J. Control 50 (1989),
doi:10.1080/00207178908953472 (forward selection).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve
from scipy.special import chdtrc

from core.calibrate.deviations import Deviation
from core.findings.proof import ScanFacts
from core.findings.table import note_of
from core.messages import Message
from core.model import Camera, Fan
from core.model.arrays import Array
from core.model.robust import Schedule
from core.scan.between_frames import Between, between
from core.scan.fan_watch import LEAST_NOISE_PX, fan_shifts, possible_movements
from core.scan.features.crossings import CrossingTable, Index
from core.scan.features.extraction import ScanFeatures
from core.scan.first_cause import BY_CHANCE, Cause, Causes, Suspect
from core.scan.known_planes.known_plane import Control
from core.scan.network.adjustment import HUBER_AT, has_collapsed
from core.scan.network.equations import Adjustment, Solution
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.network.read_out import AT_ONCE, ReadOut, row_forms
from core.scan.results import ScanResult
from core.scan.scan_evidence import change_of_misclosures
from core.scan.standstill import LEAST_SEEN_SHARE, movements_of
from core.scan.sweeps.locate import by_sweep, some_sweeps, sweeping_frames

WEIGHTS = Schedule(5, huber_at=HUBER_AT)
"""Of reweighting, as before the test for a movement."""
LEAST_SHARE = 0.02
"""Share of what is too large below which a further cause is not worth a word."""


@dataclass(frozen=True, eq=False, slots=True)
class _Candidate:
    """A cause: how its numbers move the misclosures (M, K), in 1/mm, and at how many places it was looked for.

    `light` (F, L) is how it moves a stretch of the fan's light over the frames that see it, each as far as it likes.
    """

    suspect: Suspect
    moves: Array
    places: int = 1
    light: Array | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Normal:
    """Normal equations for the parameters (K,) of all candidate causes of misfit, the network's unknowns eliminated.

    Parameters
    ----------
    information
        N (K, K): the misfit falls by gᵀ N⁻¹ g.
    gradient
        g (K,).
    scatter
        Σ (K, K), the covariance of g if there is none of the causes.
    of
        (K,) the candidate of each number.
    places
        At how many places each candidate was looked for.
    misfit, expected
        Sum of the squares of all residuals, and what it is if there is none of the causes.
    """

    information: Array
    gradient: Array
    scatter: Array
    of: tuple[Suspect, ...]
    places: dict[Suspect, int]
    misfit: float
    expected: float


def compare_causes(
    features: ScanFeatures,
    scan: ScanResult,
    camera: Camera,
    fan: Fan | Control,
    of_calibration: Sequence[Deviation] = (),
    of_rig: Sequence[Deviation] = (),
) -> Causes:
    """Find which causes, such as a movement or a drift, explain the misfit of a scan's crossings, most of it first.

    () where none explains more than chance, or the sweeps' planes have fallen together.

    Parameters
    ----------
    features, scan
        What the pictures showed, and its solution by the network with `camera` and `fan`.
    camera, fan
        As calibrated; the `fan`, or that of a control, with the bends of its lines, if they were seen to bend.
    of_calibration
        What the calibrations leave uncertain, one standard uncertainty each.
    of_rig
        How the rig may have changed since.
    """
    if scan.collapsed:
        return ()
    some = some_sweeps(scan.crossings)
    crossings, line = scan.crossings.select(some), scan.crossing_lines[some]
    frames = sweeping_frames(crossings)
    table, bent = by_sweep(crossings, frames), Control.of(fan)
    straight = bent.with_fan(replace(bent.fan, bends=None))
    read_out = AT_ONCE if scan.rows_seen_to_roll else scan.read_out
    equations = Adjustment(
        table, CrossingRays.of(table, camera), line, straight, len(frames), LineErrors.of(table), read_out
    )
    kept = ~scan.second_bounces.among(crossings)
    solution = equations.weighted(WEIGHTS, kept=kept)  # many mirrored pieces would make the planes fall together
    solution = equations.weighted(replace(WEIGHTS, rounds=1), solution)
    if has_collapsed(equations, solution.pis):
        return ()
    seen, shifts, noise_px = fan_shifts(features, scan.printed)
    noise_px = np.maximum(noise_px, LEAST_NOISE_PX)
    movements = possible_movements(scan.movements, seen, shifts, noise_px)
    candidates = [
        *_moved(equations, solution, movements, frames, seen),
        _drifted(equations, solution, frames, len(features.frames), seen),
        *_rig(equations, solution, of_rig, camera),
        *_bent(equations, solution, bent),
        *_hand(equations, scan.read_out if scan.rows_seen_to_roll else AT_ONCE),
        *_bounces(scan, crossings),
    ]
    unsure = [_of_deviation(equations, solution, one, camera) for one in of_calibration]
    normal = _normal(equations, solution, candidates, np.array(unsure).reshape(-1, len(table)).T)
    found = choose(_with_light(normal, candidates, shifts, noise_px))
    return _with_single_change(found, scan.rig_explained)


def causes_of_light(
    features: ScanFeatures, movements: Sequence[Between], printed: NDArray[np.bool_] | None = None
) -> Causes:
    """Find the causes of a failed scan from the fan's light alone, for when no sweep could be located.

    Candidates are that something moved in `movements`, and that it drifted; () where neither explains more than chance.
    Centrelines that are `printed` (P,) on boards tell nothing.
    """
    seen, shifts, noise_px = fan_shifts(features, printed)
    when, none = (seen[:, None] + 1) / max(len(features.frames), 1), np.zeros((0, 0))
    candidates = [
        _Candidate(Suspect.MOVED, none, len(features.frames), _after(movements, seen)),
        _Candidate(Suspect.DRIFTED, none, light=when),
    ]
    places = {one.suspect: one.places for one in candidates}
    normal = Normal(none, np.zeros(0), none, (), places, 0.0, 0.0)
    return choose(_with_light(normal, candidates, shifts, np.maximum(noise_px, LEAST_NOISE_PX)))


def choose(normal: Normal) -> Causes:
    """Choose one after another the cause that explains most of the misfit still left, if more than chance; () for none.

    Examples
    --------
    Two causes that move alike what is off; one fits it better, and leaves nothing for the other:

    >>> normal = Normal(np.array([[100.0, 90], [90, 100]]), np.array([100.0, 90]), np.eye(2) * 10 + 90,
    ...     (Suspect.DRIFTED, Suspect.MOVED), {Suspect.DRIFTED: 1, Suspect.MOVED: 1}, 300.0, 200.0)
    >>> [(one.suspect.value, round(one.share, 2)) for one in choose(normal)]
    [('drifted', 0.99)]
    """
    chosen: list[tuple[Suspect, float, int, float]] = []
    count = sum(normal.places.values())
    while left := [one for one in dict.fromkeys(normal.of) if one not in {suspect for suspect, *_ in chosen}]:
        taken = sum(squares for _, squares, _, _ in chosen)
        spent = sum(freedom for _, _, freedom, _ in chosen)
        beyond_chance = []
        for suspect in left:  # of each: what takes most off may be what the calibrations leave most uncertain
            squares, freedom, score = _explained(normal, suspect, [one for one, *_ in chosen])
            level = _level(normal, taken + squares, spent + freedom)
            p = min(1.0, count * float(chdtrc(freedom, score / max(1.0, level)))) if freedom else 1.0
            gained = squares - freedom * level
            if p < BY_CHANCE and gained > 0:
                beyond_chance.append((gained, (suspect, squares, freedom, p)))
        if not beyond_chance:
            break
        chosen.append(max(beyond_chance, key=lambda one: one[0])[1])
    if not chosen:
        return ()
    noise = min(1.0, _level(normal, sum(one[1] for one in chosen), sum(one[2] for one in chosen)))
    above = [squares - noise * freedom for _, squares, freedom, _ in chosen]
    too_large = max(normal.misfit - noise * normal.expected, sum(above))
    shares = [one / too_large for one in above]
    return tuple(
        Cause(suspect, float(share), freedom, p)
        for (suspect, _, freedom, p), share in zip(chosen, shares, strict=True)
        if share >= LEAST_SHARE
    )


def _level(normal: Normal, taken: float, spent: int) -> float:
    """Variance of unit weight that is left when so many squares are taken off by so many numbers."""
    return max(normal.misfit - taken, 0.0) / max(normal.expected - spent, 1.0)


def _explained(normal: Normal, suspect: Suspect, chosen: Sequence[Suspect]) -> tuple[float, int, float]:
    """Squares that a cause takes off with the `chosen` ones in the model, its numbers that are seen, and its T."""
    mine = np.array([one == suspect for one in normal.of])
    known = np.array([one in chosen for one in normal.of])
    n, s, g = normal.information, normal.scatter, normal.gradient
    own = np.sqrt(np.maximum(n.diagonal()[mine], 1e-300))
    pulled = np.linalg.pinv(n[np.ix_(known, known)], rcond=LEAST_SEEN_SHARE, hermitian=True) @ n[np.ix_(known, mine)]
    turned = np.zeros((len(n), int(mine.sum())))
    turned[mine], turned[known] = np.eye(turned.shape[1]), -pulled
    information = (turned.T @ n @ turned) / np.outer(own, own)
    scatter, gradient = (turned.T @ s @ turned) / np.outer(own, own), turned.T @ g / own
    values, vectors = np.linalg.eigh(information)
    seen = vectors[:, values > LEAST_SEEN_SHARE]
    if not seen.shape[1]:
        return 0.0, 0, 0.0
    part = seen.T @ gradient
    squares = part @ np.linalg.solve(seen.T @ information @ seen, part)
    return float(squares), len(part), float(part @ np.linalg.solve(seen.T @ scatter @ seen, part))


def _normal(equations: Adjustment, solution: Solution, candidates: Sequence[_Candidate], unsure: Array) -> Normal:
    """Eliminate the network's unknowns; `unsure` (M, D) is what calibrations leave uncertain of the misclosures."""
    moves = np.hstack([one.moves for one in candidates])
    weight = solution.weights / solution.sigma**2
    eliminated = cho_solve(solution.factor, solution.design.T @ (weight[:, None] * moves), check_finite=False)
    felt = weight[:, None] * (moves - solution.design @ eliminated)
    noise, cells = equations.noise(solution).T @ felt, eliminated[equations.unknowns :]
    calibrated = felt.T @ unsure
    return Normal(
        moves.T @ felt,
        moves.T @ (weight * solution.residuals * solution.sigma),
        noise.T @ noise + cells.T @ cells + calibrated @ calibrated.T,
        tuple(one.suspect for one in candidates for _ in range(one.moves.shape[1])),
        {one.suspect: one.places for one in candidates},
        solution.misfit,
        equations.expected(solution),
    )


def _with_light(normal: Normal, candidates: Sequence[_Candidate], shifts: Array, noise_px: Array) -> Normal:
    """The same with what the fan's light says: its stretches' `shifts` (F, C) and their noise (C,), both in px.

    Where a stretch lies in the reference is a number of its own: all is taken from its mean over the frames.
    """
    lit = [one for one in candidates if one.light is not None and one.light.size and shifts.size]
    if not lit:
        return normal
    way = np.hstack([one.light - one.light.mean(axis=0) for one in lit if one.light is not None])
    aside = (shifts - shifts.mean(axis=0)) / noise_px
    information = np.kron(way.T @ way, np.diag(noise_px**-2))
    zero = np.zeros((len(normal.of), len(information)))
    of = [one.suspect for one in lit if one.light is not None for _ in range(one.light.shape[1] * len(noise_px))]
    return replace(
        normal,
        information=np.block([[normal.information, zero], [zero.T, information]]),
        scatter=np.block([[normal.scatter, zero], [zero.T, information]]),
        gradient=np.concatenate([normal.gradient, (way.T @ aside / noise_px).ravel()]),
        of=(*normal.of, *of),
        misfit=normal.misfit + float(np.sum(aside**2)),
        expected=normal.expected + (len(shifts) - 1) * len(noise_px),
    )


def _moved(
    equations: Adjustment, solution: Solution, movements: Sequence[Between], frames: Index, seen: Index
) -> Iterator[_Candidate]:
    """Something moved in each of `movements`, main plane and the rest by themselves."""
    if not movements:
        return
    earlier, later, pattern = movements_of(equations, solution)
    columns = []
    for _, first_after in movements:
        k = np.searchsorted(frames, first_after)
        columns.append(np.where(((earlier < k) & (later >= k))[:, None], pattern, 0.0))
    yield _Candidate(Suspect.MOVED, np.hstack(columns), len(frames), _after(movements, seen))


def _after(movements: Sequence[Between], seen: Index) -> Array:
    """Which of the frames `seen` (F,) come after each of `movements` (F, L): 1 if so."""
    return (seen[:, None] >= np.array([first_after for _, first_after in movements])).astype(np.float64)


def _drifted(equations: Adjustment, solution: Solution, frames: Index, count: int, seen: Index) -> _Candidate:
    """The picture shifts along u and v, and its scale changes, in proportion to the time since the reference."""
    table = equations.crossings
    width = 2 * np.median(np.abs(table.uv - np.median(table.uv, axis=0)))
    when = (frames + 1) / count
    middle, columns = np.median(table.uv, axis=0), np.zeros((len(table), 3))
    at_a, at_b = when[table.a], np.where(table.with_fan, 0.0, when[table.b])
    for tangent, at, gain in zip((table.tangent_a, table.tangent_b), (at_a, at_b), solution.gains.T, strict=True):
        normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
        outwards = np.einsum("mi,mi->m", normal, table.uv - middle) / max(width, 1.0)
        columns += (gain * at)[:, None] * np.column_stack([normal, outwards])
    return _Candidate(Suspect.DRIFTED, columns, light=(seen[:, None] + 1) / count)


def _rig(
    equations: Adjustment, solution: Solution, of_rig: Sequence[Deviation], camera: Camera
) -> Iterator[_Candidate]:
    """Camera or laser changed since their calibration."""
    if of_rig:
        moves = [_of_deviation(equations, solution, one, camera) for one in of_rig]
        yield _Candidate(Suspect.RIG_CHANGED, np.array(moves).T)


def _of_deviation(equations: Adjustment, solution: Solution, one: Deviation, camera: Camera) -> Array:
    control = Control.of(equations.fan).displaced(one)
    return change_of_misclosures(equations, solution, control, None if one.camera is camera else one.camera)


def _bent(equations: Adjustment, solution: Solution, bent: Control) -> Iterator[_Candidate]:
    """Each of the fan's lines bends in the form that its calibration has seen, more or less."""
    fan = bent.fan
    if fan.bends is None:
        return
    lines = np.eye(len(fan.bends))[:, :, None, None] * fan.bends
    each = (bent.with_fan(replace(fan, bends=one)) for one in lines)
    moves = [change_of_misclosures(equations, solution, one) for one in each]
    yield _Candidate(Suspect.BENT_LINES, np.array(moves).T)


def _hand(equations: Adjustment, read_out: ReadOut) -> Iterator[_Candidate]:
    """Every sheet of light shifts and turns evenly while rows are read out."""
    if not read_out.moves:
        return
    table = equations.crossings
    forms = row_forms(equations.geometry.rays, table.uv[:, 1], read_out.rows, 6)[:, 3:]
    moves = np.zeros((len(table), equations.sweeps, 3))
    rows = np.arange(len(table))
    moves[rows, table.a] = forms
    between = ~table.with_fan
    moves[rows[between], table.b[between]] -= forms[between]
    yield _Candidate(Suspect.HAND_MOVED, moves.reshape(len(table), -1))


def _bounces(scan: ScanResult, crossings: CrossingTable) -> Iterator[_Candidate]:
    """Every crossing of a second bounce is off by itself."""
    off = np.flatnonzero(scan.second_bounces.among(crossings))
    if len(off):
        moves = np.zeros((len(crossings), len(off)))
        moves[off, np.arange(len(off))] = 1.0
        yield _Candidate(Suspect.SECOND_BOUNCES, moves)


def _with_single_change(found: Causes, explained: float | None) -> Causes:
    """The causes with the share that a change of the rig explains of what is too large when it is not small."""
    linear = next((one for one in found if one.suspect == Suspect.RIG_CHANGED), None)
    if explained is None or (linear is not None and (linear.share or 0.0) >= explained):
        return found
    changed = Cause(Suspect.RIG_CHANGED, explained, 1 if linear is None else linear.freedom, 0.0)
    others = (one for one in found if one is not linear and (one.share or 0.0) <= 1 - explained)
    return (changed, *others)


_WORDS = {
    Suspect.DRIFTED: Message("cause.drifted", "the rig drifted during the scan"),
    Suspect.RIG_CHANGED: Message("cause.rig_changed", "camera or laser changed since they were calibrated"),
    Suspect.BENT_LINES: Message("cause.bent_lines", "the fan's lines are no planes of light"),
    Suspect.HAND_MOVED: Message("cause.hand_moved", "the hand moved while the camera read its rows out"),
    Suspect.SECOND_BOUNCES: Message("cause.second_bounces", "shiny sides mirror the hand-held laser's light"),
}


def note_on_causes(
    causes: Causes, facts: ScanFacts, movements: Sequence[Between], names: Sequence[str]
) -> tuple[Message, ...]:
    """Make a note on the likeliest cause of a scan's misfit, with its share, and on further ones; () for none.

    It is grave where the scan's `facts` say the same of the likeliest, and so take the proof away; else a caution: that
    a cause is beyond chance does not say that it does more than U contains. `names` are the frames', and
    something moved in each of `movements`.
    """
    if not causes:
        return ()
    told = [_explains(cause, number, _words_of(cause, movements, names)) for number, cause in enumerate(causes)]
    if _is_fact(causes[0].suspect, facts):
        return (note_of("scan.most_likely_cause", causes=told),)
    return (note_of("scan.most_likely_scatter", causes=told),)


def _is_fact(suspect: Suspect, facts: ScanFacts) -> bool:
    """Whether a fact by which nothing is proven says the same as a cause."""
    said = {
        Suspect.MOVED: facts.moved,
        Suspect.DRIFTED: facts.drifted,
        Suspect.RIG_CHANGED: facts.rig_changed or facts.rig_seems_changed,
    }
    return bool(said.get(suspect))


def _explains(cause: Cause, number: int, what: Message) -> Message:
    """A cause with its share: the first one, or one of what is left."""
    percent = 100 * (cause.share or 0.0)
    if number == 0:
        return Message(
            "cause.first", "{what} (explains {percent:.0f} % of what is too large)", what=what, percent=percent
        )
    return Message("cause.next", "then {what} ({percent:.0f} %)", what=what, percent=percent)


def _words_of(cause: Cause, movements: Sequence[Between], names: Sequence[str]) -> Message:
    if cause.suspect != Suspect.MOVED:
        return _WORDS[cause.suspect]
    return Message("cause.moved", "something moved {when:and}", when=between(names, movements))
