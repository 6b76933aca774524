"""Second bounces are told from a sweep's own light, and faint light of its own is kept."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.scan.features.frames import CrossingUse
from core.scan.reconstruct import reconstruct
from core.scan.sweeps.fan_lines import FanLines
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
