"""The traps of the network, one test each, on whole scans at the level of centrelines or of their exact crossings."""

from dataclasses import replace

import numpy as np
import pytest

from core.model.robust import huber_weights
from core.scan.features.extraction import gather
from core.scan.network.adjustment import HUBER_AT, has_collapsed, solve_network
from core.scan.network.equations import Adjustment
from core.scan.network.geometry import CrossingRays
from core.scan.network.line_errors import LineErrors
from core.scan.reconstruct import reconstruct
from core.scan.sweeps.locate import by_sweep, locate_together
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactCrossings, ExactScan, Noise

DRAWS = 120


@pytest.fixture(scope="module")
def block():
    return ExactCrossings.of(ExactScan.of(Scenario(scale=0.5)))


class Sampled:
    """The network of one exact scan solved for many draws: errors and stated σ of depths and of the block's height."""

    def __init__(self, exact, draws=DRAWS, changed=lambda table: table):
        scan = exact.scan
        up, camera = scan.scene.pose_cam_table.rotation[:, 2], scan.rig.camera
        curves = [(i, c) for i, cs in enumerate(scan.sweeps) for c in cs if np.ptp(c.points @ up) < 0.1]
        sweep = np.concatenate([np.full(len(c.uv[::50]), i) for i, c in curves])
        points = np.concatenate([c.points[::50] for _, c in curves])
        lever = -points * points[:, 2:]
        known = self._stated(locate_together(exact.drawn(0), exact.line, camera, scan.rig.fan), sweep, lever) < 0.2
        sweep, points, lever = sweep[known], points[known], lever[known]  # as the σ cut would
        depth, height = points[:, 2], points @ up
        top = height > (height.min() + height.max()) / 2
        of_height = lever * (height / depth * np.where(top, 1 / top.sum(), -1 / (~top).sum()))[:, None]
        self.depth, self.height, self.scale = [], [], []
        self.stated_depth, self.stated_height = [], []
        for seed in range(draws):
            table = changed(exact.drawn(seed))
            solved = locate_together(table, exact.line, camera, scan.rig.fan)
            place = np.searchsorted(solved.frames, sweep)
            off = solved.pis - scan.pis[solved.frames]
            self.depth.append(np.einsum("ni,ni->n", lever, off[place]))
            self.stated_depth.append(self._stated(solved, sweep, lever))
            gain = np.zeros((len(solved.frames), 3))
            np.add.at(gain, place, of_height)
            self.height.append(gain.ravel() @ off.ravel())
            self.stated_height.append(np.sqrt(gain.ravel() @ solved.covariance @ gain.ravel()))
            self.scale.append(solved.scale)

    @staticmethod
    def _stated(solved, sweep, lever):
        """Stated σ of the depths of points of these sweeps' frames."""
        blocks = [solved.covariance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(len(solved.frames))]
        place = np.searchsorted(solved.frames, sweep)
        return np.sqrt(np.einsum("ni,nij,nj->n", lever, np.array(blocks)[place], lever))

    @property
    def of_depth(self):
        """RMS of depth errors over their stated σ."""
        return np.sqrt(np.mean((np.array(self.depth) / np.array(self.stated_depth)) ** 2))

    @property
    def of_height(self):
        """RMS of the height's error over its stated σ."""
        return np.sqrt(np.mean((np.array(self.height) / np.array(self.stated_height)) ** 2))


@pytest.fixture(scope="module")
def sampled(block):
    return Sampled(block)


def adjusted(exact, table):
    """The adjustment's equations for a table of crossings."""
    frames = np.unique(np.concatenate([table.a, table.b[~table.with_fan]]))
    renumbered, geometry = by_sweep(table, frames), CrossingRays.of(table, exact.scan.rig.camera)
    fan = exact.scan.rig.fan
    return Adjustment(renumbered, geometry, exact.line, fan, len(frames), LineErrors.of(table)), frames


def height_of(scan, result):
    """Median height over the table of the cloud's points on the block, in mm."""
    up, foot = scan.scene.pose_cam_table.rotation[:, 2], scan.scene.pose_cam_table.translation
    heights = (result.cloud.points[result.cloud.sweep >= 0] - foot) @ up
    return float(np.median(heights[heights > 5])) - float(np.median(heights[heights < 5]))


@pytest.mark.accuracy
def test_stated_sigma_is_that_of_repeated_scans(sampled):
    assert sampled.of_depth == pytest.approx(1.0, abs=0.05)
    assert sampled.of_height == pytest.approx(1.0, abs=0.15)  # 120 draws know it to 6.5 %
    assert np.mean(sampled.scale) == pytest.approx(1.0, abs=0.03)


@pytest.mark.accuracy
def test_nothing_pulls_the_heights_one_way(sampled):
    assert abs(np.mean(sampled.height)) < 3 * np.std(sampled.height) / np.sqrt(DRAWS)


@pytest.mark.accuracy
def test_speckle_of_the_fan_taken_as_independent_would_make_sigma_optimistic():
    """Many sweeps cross the same stretches of the fan; forgetting that they share its speckle costs honesty."""
    scan = ExactScan.of(Scenario(scale=0.5, frames=90))
    exact = ExactCrossings.of(scan, Noise(0.03, 0.15, 7.2))

    def forgetting(table):
        nothing = np.zeros((len(table), 1))
        return replace(table, share_a=nothing, share_b=nothing)

    honest, optimistic = Sampled(exact, 30), Sampled(exact, 30, forgetting)
    assert honest.of_height < 1.3
    assert optimistic.of_height > 1.5 * honest.of_height
    assert np.mean(optimistic.stated_height) < np.mean(honest.stated_height)


def test_a_solution_that_has_collapsed_onto_the_table_comes_back(block):
    """Every sweep at the table's plane satisfies every crossing on the table: weights must not hold it there."""
    equations, frames = adjusted(block, block.drawn(1))
    foot, up = block.scan.scene.pose_cam_table.translation, block.scan.scene.pose_cam_table.rotation[:, 2]
    solution = equations.start()
    table_plane = np.tile(up / (up @ foot), (len(frames), 1))
    collapsed = replace(solution, pis=table_plane + 1e-3 * (solution.pis - table_plane), cells=0 * solution.cells)
    for _ in range(12):
        collapsed = equations.improve(collapsed, np.ones(len(block.table)))
    for _ in range(12):
        solution = equations.improve(solution, np.ones(len(block.table)))
    true, seen = block.scan.pis[frames], equations.crossings.a
    rays = equations.geometry.rays

    def off_mm(pis):
        inverse = np.einsum("mi,mi->m", rays, true[seen])
        return float(np.quantile(np.abs(np.einsum("mi,mi->m", rays, pis[seen]) - inverse) / inverse**2, 0.9))

    assert off_mm(table_plane) > 20
    assert off_mm(solution.pis) < 0.3
    assert off_mm(collapsed.pis) < 1.1 * off_mm(solution.pis)


def test_planes_that_have_fallen_together_are_told(block):
    equations, frames = adjusted(block, block.drawn(1))
    foot, up = block.scan.scene.pose_cam_table.translation, block.scan.scene.pose_cam_table.rotation[:, 2]
    true = block.scan.pis[frames]
    assert not has_collapsed(equations, true)
    assert has_collapsed(equations, up / (up @ foot) + 0.02 * (true - up / (up @ foot)))
    solved = solve_network(equations.crossings, equations.geometry, block.line, block.scan.rig.fan, len(frames))
    assert not solved.collapsed


@pytest.mark.accuracy
def test_the_table_does_not_outvote_a_small_part():
    """A narrow block with a tenth of the crossings: all its crossings count, and its height is right."""
    scan = ExactScan.of(Scenario(object="narrow-block", height_mm=40.0, scale=0.5))
    result = reconstruct(scan.measured(3), scan.rig.camera, scan.rig.fan)
    up, foot = scan.scene.pose_cam_table.rotation[:, 2], scan.scene.pose_cam_table.translation
    rays = scan.rig.camera.rays(result.crossings.uv)
    depth = 1 / np.einsum("mi,mi->m", rays, scan.pis[result.crossings.a])
    on_top = ((rays * depth[:, None] - foot) @ up) > 20
    assert on_top.mean() < 0.35
    assert np.mean(result.crossing_weights[on_top] > 0.5) > 0.97
    assert height_of(scan, result) == pytest.approx(40.0, abs=0.08)


def test_windows_do_not_reach_over_kinks_and_depth_edges():
    """Crossings close to the edges of a block and of steps are as good as they say."""
    scan = ExactScan.of(Scenario(object="steps", scale=0.5))
    noisy = scan.measured(1, smoothed=False).crossings
    clean = ExactCrossings.of(scan).table
    off_a, off_b = offsets(noisy, clean)
    assert np.sqrt(np.mean(off_a**2)) == pytest.approx(1.0, abs=0.12)
    assert np.sqrt(np.mean(off_b**2)) == pytest.approx(1.0, abs=0.12)
    assert np.abs(np.concatenate([off_a, off_b])).max() < 6


def test_crossings_near_the_ends_of_stripes_know_less_and_say_so(block):
    noisy = [block.scan.measured(seed, smoothed=False) for seed in (1, 2, 3)]
    near, far = [], []
    sigma_near, sigma_far = [], []
    for features in noisy:
        table = features.crossings
        pieces = zip(table.a, table.piece_a, strict=True)
        lengths = np.array([len(features.frames[a].centrelines[piece]) for a, piece in pieces])
        to_end = np.minimum(table.along_a, lengths - table.along_a)
        off, rows = offsets(table, block.table, with_rows=True)
        close = to_end[rows] < 20
        near.append(off[close])
        far.append(off[~close])
        sigma_near.append(table.sigma_a[rows][close])
        sigma_far.append(table.sigma_a[rows][~close])
    assert np.median(np.concatenate(sigma_near)) > 1.2 * np.median(np.concatenate(sigma_far))
    assert np.sqrt(np.mean(np.concatenate(near) ** 2)) == pytest.approx(1.0, abs=0.2)


@pytest.mark.accuracy
def test_saturated_points_have_no_say(block):
    """Where stripes meet they saturate, and saturated points lie wrong: here by a whole pixel."""
    scan = block.scan
    features = scan.measured(1)
    rng = np.random.default_rng(1)

    def spoilt(piece):
        bad = np.zeros(len(piece), dtype=bool)
        for at in rng.integers(0, len(piece), max(1, len(piece) // 80)):
            bad[at : at + 8] = True
        return replace(piece, uv=piece.uv + bad[:, None] * piece.normal, saturated=bad)

    raw = scan.measured(1, smoothed=False)
    frames = [replace(frame, centrelines=tuple(map(spoilt, frame.centrelines))) for frame in raw.frames]
    fan = tuple(map(spoilt, raw.fan))
    stripes = (features.fan_stripe, features.sweep_stripe)
    wrong = gather(features.image_size, fan, frames, stripes)
    good, bad = (reconstruct(one, scan.rig.camera, scan.rig.fan) for one in (features, wrong))
    assert height_of(scan, bad) == pytest.approx(height_of(scan, good), abs=0.05)
    assert bad.scale < 1.2


def test_weights_do_not_run_away_where_two_sweeps_are_almost_one():
    """Twins a hair apart: their crossings with each other tell nothing, however small their misclosure."""
    base = ExactScan.of(Scenario(scale=0.5, frames=24))
    twins = tuple(
        replace(sheet, plane=type(sheet.plane)(sheet.plane.pi * (1 + 2e-4 * np.array([1.0, -1.0, 1.0]))))
        for sheet in base.sheets[::4]
    )
    scan = ExactScan.of(Scenario(scale=0.5, frames=24), sheets=(*base.sheets, *twins))
    exact = ExactCrossings.of(scan)
    equations, _ = adjusted(exact, exact.drawn(2))
    solution = equations.start()
    for _ in range(8):
        solution = equations.improve(solution, huber_weights(solution.residuals, HUBER_AT))
    pull = solution.weights / solution.sigma**2
    assert pull.max() < 1000 * np.median(pull)  # by their own gradient they would pull a million times as hard
    sample = Sampled(exact, 20)
    assert 0.75 < sample.of_depth < 1.25


def test_rejecting_comes_late_and_never_silences_the_fan(block):
    """One plane of the fan is wrong by half a percent: crossings with it disagree, but it is the only metric."""
    fan = block.scan.rig.fan
    planes = list(fan.planes)
    planes[0] = type(planes[0])(planes[0].pi * 1.005)
    wrong = type(fan)(tuple(planes))
    solved = locate_together(block.drawn(1), block.line, block.scan.rig.camera, wrong)
    with_fan = block.table.with_fan
    assert np.mean(solved.weights[with_fan] < 0.05) < 0.25
    assert any(note.code == "scan.fan_disagrees" for note in solved.notes)
    assert solved.scale > HUBER_AT


def offsets(noisy, clean, with_rows=False):
    """Errors of a's (and b's) centreline across itself at the crossings of two tables, in stated σ."""
    of = {key: m for m, key in enumerate(keys(clean))}
    pairs = [(m, of[key]) for m, key in enumerate(keys(noisy)) if key in of]
    mine, true = np.array([(m, k) for m, k in pairs if np.linalg.norm(noisy.uv[m] - clean.uv[k]) < 3]).T
    moved = noisy.uv[mine] - clean.uv[true]
    ends = []
    for end in "ab":
        tangent = getattr(clean, f"tangent_{end}")[true]
        across = moved[:, 0] * -tangent[:, 1] + moved[:, 1] * tangent[:, 0]
        ends.append(across / getattr(noisy, f"sigma_{end}")[mine])
    return (ends[0], mine) if with_rows else tuple(ends)


def keys(table):
    return list(map(tuple, np.column_stack([table.a, table.b, table.piece_a, table.piece_b]).tolist()))
