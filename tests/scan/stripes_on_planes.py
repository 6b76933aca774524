"""Clouds along stripes on planes, seen by a pinhole camera at the picture's centre."""

import numpy as np

from core.scan.surface.cloud import Cloud

FOCAL = 2495.0
SIZE = (480, 360)


def cloud_of(uv, depth, sigma=0.03, sweep=0):
    """Points at `depth` on the rays of `uv`, seen by a pinhole camera at the picture's centre."""
    uv = np.asarray(uv, dtype=float)
    count = len(uv)
    rays = np.column_stack([(uv - np.array(SIZE) / 2) / FOCAL, np.ones(count)])
    points = rays * np.broadcast_to(depth, count)[:, None]
    sweeps = np.broadcast_to(sweep, count)
    return Cloud(points, uv, np.broadcast_to(sigma, count), np.full(count, 80.0), sweeps, sweeps, np.zeros((count, 3)))


def stripes(spacing=8.0, slope=0.3):
    """Pixels along stripes `spacing` px apart, one point per row, and the index of each one's stripe."""
    rows = np.arange(20.0, 340.0)
    starts = np.arange(30.0, 450.0, spacing)
    u = starts[:, None] + slope * (rows - 180)
    uv = np.column_stack([u.ravel(), np.tile(rows, len(starts))])
    index = np.repeat(np.arange(len(starts)), len(rows))
    inside = (uv[:, 0] > 5) & (uv[:, 0] < 475)
    return uv[inside], index[inside]


def on_plane(uv, normal, distance):
    """Depths at which the rays of `uv` meet normal·X = distance."""
    rays = np.column_stack([(uv - np.array(SIZE) / 2) / FOCAL, np.ones(len(uv))])
    return distance / (rays @ normal)
