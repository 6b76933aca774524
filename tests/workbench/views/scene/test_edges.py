"""Silhouettes and creases from a depth buffer alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.edges import STRENGTH, Depths, edge_opacity

SIZE = (300, 200)
NEAR, FAR = 350.0, 700.0


def camera(parallel: bool) -> SceneCamera:
    made = SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    return replace(made, parallel=parallel)


def buffer_of(depth: np.ndarray, parallel: bool) -> Depths:
    """What OpenGL keeps of depths in mm; NaN is nothing. In 24 bits."""
    share = (depth - NEAR) / (FAR - NEAR) if parallel else (1 / NEAR - 1 / depth) / (1 / NEAR - 1 / FAR)
    kept = np.round(np.where(np.isnan(depth), 1.0, share) * 2**24) / 2**24
    return Depths(kept.astype(np.float32), NEAR, FAR)


def plane(slope: float, parallel: bool) -> np.ndarray:
    """Depth of a plane that falls away by `slope` mm for each mm to the right, as it is seen in each pixel."""
    scale = camera(parallel).pixels_per_mm(SIZE)
    across = (np.arange(SIZE[0]) - SIZE[0] / 2) / scale
    row = 500 + slope * across if parallel else 500 / (1 - slope * across / 500)
    return np.tile(row, (SIZE[1], 1))


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("slope", [0.0, 0.3, 0.9])
def test_nothing_is_drawn_on_a_plane(slope, parallel):
    assert not edge_opacity(buffer_of(plane(slope, parallel), parallel), camera(parallel)).any()


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize(("bend", "drawn"), [(0.1, False), (0.2, False), (0.6, True), (2.0, True)])
def test_a_bend_is_drawn_if_it_is_larger_than_noise_makes_one(bend, drawn, parallel):
    depth = np.maximum(plane(bend / 2, parallel), plane(-bend / 2, parallel))
    opacity = edge_opacity(buffer_of(depth, parallel), camera(parallel))
    assert bool(opacity[:, 148:152].any(axis=1).all()) == drawn
    assert not opacity[:, :145].any() and not opacity[:, 155:].any()


@pytest.mark.parametrize("parallel", [False, True])
def test_where_a_surface_ends_before_another_the_nearer_one_has_the_line(parallel):
    depth = plane(0.0, parallel) + 20.0
    depth[50:150, 100:200] -= 30.0
    opacity = edge_opacity(buffer_of(depth, parallel), camera(parallel))
    assert (opacity[50, 100:200] == STRENGTH).all() and (opacity[50:150, 199] == STRENGTH).all()
    outside = opacity.copy()
    outside[50:150, 100:200] = 0
    assert not outside.any()
    assert not opacity[52:148, 102:198].any()


def test_a_silhouette_before_nothing_lies_on_the_surface():
    depth = plane(0.2, False)
    depth[:, :60] = np.nan
    opacity = edge_opacity(buffer_of(depth, False), camera(False))
    assert (opacity[:, 60] == STRENGTH).all() and not opacity[:, :60].any() and not opacity[:, 62:].any()


def test_a_narrow_line_on_the_surface_is_no_edge_and_a_step_beside_it_stays_one():
    depth = plane(0.1, False)
    depth[:, 40:44] -= 3.0
    depth[:, 200:] += 10.0
    with_lines = edge_opacity(buffer_of(depth, False), camera(False), lines_px=4)
    assert not with_lines[:, :190].any() and with_lines[:, 195:203].any(axis=1).all()
    assert edge_opacity(buffer_of(depth, False), camera(False))[:, 35:50].any(), "the line is one if it is not said"
