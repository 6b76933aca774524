"""What the sweeps' planes have in common with the centrelines that fixed them: against sampling."""

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.model import Camera
from core.scan.network.line_errors import LineErrors
from core.scan.surface.triangulate import OwnLine, triangulate
from core.scan.sweeps.locate import locate_together
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactCrossings, ExactScan

FRAMES, SCANS, CELL_PX = 24, 40, 40.0


@pytest.fixture(scope="module")
def scans():
    """Crossings, and of each scan solved from them the solution, the errors of the planes and those of the cells."""
    exact = ExactScan.of(Scenario(height_mm=50.0, seed=4, scale=0.5, frames=FRAMES))
    crossings, solved = ExactCrossings.of(exact), []
    for seed in range(SCANS):
        table, fan, cells = crossings.drawn_with(seed)
        sweeps = locate_together(table, crossings.line, exact.rig.camera, exact.rig.fan)
        solved.append((sweeps, sweeps.pis - exact.pis[sweeps.frames], fan, cells))
    return crossings, solved


@pytest.mark.accuracy
def test_planes_follow_the_fans_cells_as_stated(scans):
    crossings, solved = scans
    rays, sweep = crossings.scan.rig.camera.rays(crossings.table.uv), crossings.table.a
    errors, told = [], []
    for sweeps, off, fan, _ in solved:
        assert np.array_equal(sweeps.frames, np.arange(FRAMES))
        assert np.array_equal(sweeps.fan_cells, LineErrors.of(crossings.table).fan_cells)
        errors.append((rays * off[sweep]).sum(axis=1))
        told.append((rays * (sweeps.fan_covariance @ fan).reshape(-1, 3)[sweep]).sum(axis=1))
    error, told = np.concatenate(errors), np.concatenate(told)
    assert (error @ told) / (told @ told) == pytest.approx(1.0, abs=0.15)
    assert np.corrcoef(error, told)[0, 1] > 0.5


def test_planes_follow_the_cells_of_their_own_lines_as_stated(scans):
    crossings, solved = scans
    table = crossings.table
    names = {tuple(row): index for index, row in enumerate(solved[0][0].line_cells.tolist())}
    rays = crossings.scan.rig.camera.rays(table.uv)
    cell = np.array([names[key] for key in zip(table.a, table.piece_a, table.along_a // CELL_PX, strict=True)])
    unit = np.median(np.abs([(rays * off[table.a]).sum(axis=1) for _, off, _, _ in solved]), axis=0)
    sampled = np.mean([(rays * off[table.a]).sum(axis=1) / unit * cells[cell] for _, off, _, cells in solved], axis=0)
    stated = np.mean([(rays * one.line_covariance[cell]).sum(axis=1) / unit for one, *_ in solved], axis=0)
    assert (sampled @ stated) / (stated @ stated) == pytest.approx(1.0, abs=0.2)


def test_a_plane_that_follows_its_line_undoes_some_of_its_noise():
    camera = Camera((800, 600), [[2500.0, 0.0, 400.0], [0.0, 2500.0, 300.0], [0.0, 0.0, 1.0]])
    along, cells, sigma = np.arange(400.0), 10, 0.05
    line = Centreline(
        np.column_stack([200 + along, np.full(400, 320.0)]),
        np.tile([0.0, -1.0], (400, 1)),
        *np.ones((2, 400)),
        np.full(400, sigma),
        np.zeros(400, dtype=bool),
        CELL_PX,
    )
    pi = np.array([1e-4, 8e-3, 1.9e-3])
    # The plane moves as far as half of the mean of its line's noise asks, and by something of its own.
    slope = -pi[1] / camera.focal
    follows = np.outer(np.full(cells, -0.5 * slope * sigma / cells), [0.0, 0.0, 1.0])
    covariance = follows.T @ follows + np.diag([0.0, 0.0, (0.2 * slope * sigma) ** 2])
    middle = np.arange(20, 400, 40)
    independent = triangulate(line, pi, covariance, camera, 0, 0)
    own = triangulate(line, pi, covariance, camera, 0, 0, OwnLine(follows, CELL_PX))
    rng = np.random.default_rng(0)
    z = rng.normal(size=(20_000, cells))
    plane = z @ follows + np.outer(rng.normal(size=20_000), [0.0, 0.0, 0.2 * slope * sigma])
    off = slope * sigma * z + plane @ camera.rays(line.uv[middle]).T
    true = np.std(off, axis=0) * own.points[middle, 2] ** 2
    assert own.sigma[middle] == pytest.approx(true, rel=0.03)
    assert np.all(own.sigma < 0.97 * independent.sigma)
