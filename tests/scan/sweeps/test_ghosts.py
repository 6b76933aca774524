"""Second bounces are told from a sweep's own light, and faint light of its own is kept."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.scan.features.crossings import CrossingTable
from core.scan.features.frames import CrossingUse
from core.scan.network.geometry import CrossingRays
from core.scan.reconstruct import reconstruct
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.ghosts import free_turns
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

MIRRORED = range(8, 32)
"""Frames with a second bounce."""
LENGTH, FAINT, BRIGHT = 110, 40.0, 100.0


@cache
def matt(kind):
    return ExactScan.of(Scenario(object=kind, scale=0.5, frames=40))


@cache
def shiny():
    """A block; in most frames a piece of another sweep's light lies on the table, as a mirror turns the sheet over."""
    scan = matt("block")
    sweeps = list(scan.sweeps)
    for frame in MIRRORED:
        table = max(scan.sweeps[39 - frame], key=lambda curve: len(curve.uv))
        part = slice(len(table.uv) // 2, len(table.uv) // 2 + LENGTH)
        piece = replace(table, uv=table.uv[part], normal=table.normal[part], points=table.points[part], strength=FAINT)
        sweeps[frame] = (*sweeps[frame], piece)
    return replace(scan, sweeps=tuple(sweeps))


def solved(scan):
    lines = FanLines.settled_as(scan.fan_line)
    return reconstruct(scan.measured(3), scan.rig.camera, scan.rig.fan, fan_lines=lines)


@cache
def without_a_mirror(kind):
    return solved(matt(kind))


@pytest.fixture(scope="module")
def result():
    return solved(shiny())


def test_second_bounces_are_found_and_nothing_else_is(result):
    expected = {(frame, len(matt("block").sweeps[frame])) for frame in MIRRORED}
    assert result.second_bounces.pieces == expected
    assert [frame.second_bounces for frame in result.frames] == [int(k in MIRRORED) for k in range(40)]
    assert f"Second bounces: {len(MIRRORED)} pieces" in str(result.notes[0])


def test_second_bounces_give_no_points_and_no_other_cause_is_named(result):
    assert not {note.code for note in result.notes} & {"scan.moved", "scan.collapsed", "scan.fan_disagrees"}
    swept = np.flatnonzero(result.cloud.sweep >= 0)
    true = 1 / np.einsum(
        "ni,ni->n", shiny().rig.camera.rays(result.cloud.uv[swept]), shiny().pis[result.cloud.frame[swept]]
    )
    off = np.abs(result.cloud.points[swept, 2] - true) / result.cloud.sigma[swept]
    assert np.median(off) < 1.2
    assert len(result.cloud) > 0.85 * len(without_a_mirror("block").cloud)


def test_crossings_of_second_bounces_say_so(result):
    bounced = result.second_bounces.among(result.crossings)
    assert np.count_nonzero(bounced) >= 5
    assert np.all(result.crossing_reasons[bounced] == CrossingUse.SECOND_BOUNCE)
    assert not np.any(result.crossing_reasons[~bounced] == CrossingUse.SECOND_BOUNCE)
    assert not np.any(result.of_solved & bounced)
    assert np.all(result.crossing_weights[bounced] == 0)


@pytest.mark.parametrize(
    "kind", ["block", *(pytest.param(kind, marks=pytest.mark.accuracy) for kind in ("steps", "sphere", "mask"))]
)
def test_a_dark_part_is_no_mirror(kind):
    """All but the longest piece of each frame, which lies on the table, are as faint as second bounces are."""
    scan = matt(kind)

    def dark(curves):
        longest = max((len(curve.uv) for curve in curves), default=0)
        return tuple(replace(one, strength=BRIGHT if len(one.uv) == longest else FAINT) for one in curves)

    darker = solved(replace(scan, sweeps=tuple(map(dark, scan.sweeps))))
    even = without_a_mirror(kind)
    assert not darker.second_bounces.pieces
    assert len(darker.cloud) == len(even.cloud)
    assert np.array_equal(darker.pis, even.pis)


def crossed_beside_a_line(off_px):
    """Crossings of one sweep with the fan along a row of the picture, every other one so many px beside it."""
    count, focal_px, sigma_px = 9, 1000.0, 0.1
    along, one = np.linspace(-300.0, 300.0, count), np.ones(count)
    beside = np.random.default_rng(1).normal(scale=sigma_px, size=count) + off_px * (np.arange(count) % 2)
    uv, zero = np.column_stack([along, beside]), np.zeros(count, dtype=np.int64)
    tangents = np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1))
    table = CrossingTable(uv, *tangents, sigma_px * one, sigma_px * one, zero, zero - 1, zero, zero, along, along, 8.0)
    return table, CrossingRays(np.column_stack([uv / focal_px, one]), np.tile(np.eye(2) / focal_px, (count, 1, 1)))


def test_a_sheet_crossed_along_one_line_alone_may_turn_about_it_whatever_noise_seems_to_say():
    """A true piece missed by 63 px: the turn of its sheet was known by nothing but noise beside that line."""
    (free,) = free_turns(*crossed_beside_a_line(0.0), 1)
    assert np.abs(free) == pytest.approx([0.0, 1.0, 0.0], abs=0.01)
    assert not free_turns(*crossed_beside_a_line(20.0), 1).any()
