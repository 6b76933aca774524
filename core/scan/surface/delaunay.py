"""Delaunay triangulation of points in a plane, compiled: about ten times as fast as by a convex hull in 3D.

The points come by their distance from one in the middle, so that each new one lies outside the convex hull of those
before. It is joined to the hull's edges that it sees, and edges are flipped until no circle round a triangle holds
another point. A hull vertex near the new point is found by its direction from the middle.

Coordinates are rounded to 2⁻²⁴ of the extent (0.0002 px in a picture 3840 px wide). On that lattice every decision is
exact in whole numbers: triangles never overlap, and flipping ends.

References
----------
Sinclair, S-hull: a fast radial sweep-hull routine for Delaunay triangulation (2016), arXiv:1604.01428.
Lawson, Software for C¹ surface interpolation, Mathematical Software III (1977), 161–194.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled, inlined
from core.model.arrays import Array
from core.model.small_arrays import doubled_indices, indices_of, new_index_table, new_indices

Index = NDArray[np.int64]

_BITS = 24
"""Bits of a coordinate: products of two differences and their sums then stay below 2⁵¹."""
_DOUBT = 1e-15
"""Where sums of products in floating point are less than this share of their terms their sign may be wrong: about five
units of rounding."""
_LIMB = 26
"""Bits of a limb: products of up to 102 bits are summed in limbs."""
_LIMB_MASK = (1 << _LIMB) - 1  # its bits


class _Edges(NamedTuple):
    """Half-edges: 3t, 3t + 1, 3t + 2 run round triangle t; the vertex each starts from, and its twin or −1."""

    start: Index
    twin: Index


class _Hull(NamedTuple):
    """The convex hull of the points so far, anticlockwise.

    For a vertex the next (itself when it has left the hull) and the one before, and the half-edge that starts there;
    `near` has a vertex that was last seen in each direction from the middle, or −1.
    """

    following: Index
    before: Index
    edge: Index
    near: Index


def delaunay(uv: Array) -> Index:
    """Triangulate points `uv` (N, 2): (T, 3) indices, each anticlockwise; none when the points do not span a plane.

    Points that fall together with another on the lattice are left out. The same points give the same triangles; where
    four or more lie on a circle, any one of those there can be.

    Raises
    ------
    ValueError
        If a coordinate is not finite.
    """
    if not np.isfinite(uv).all():
        raise ValueError("points to triangulate must be finite")
    if len(uv) < 3:
        return np.empty((0, 3), dtype=np.int64)
    low = uv.min(axis=0)
    extent = float(np.ptp(uv, axis=0).max())
    xy = np.rint((uv - low) * (2**_BITS / (extent or 1.0))).astype(np.int64)
    middle = xy[((xy - np.ptp(xy, axis=0) // 2) ** 2).sum(axis=1).argmin()]
    order = np.argsort(((xy - middle) ** 2).sum(axis=1), kind="stable")
    found: Index = _triangulated(np.ascontiguousarray(xy[order]))
    return np.asarray(order[found], dtype=np.int64)


@compiled()
def _triangulated(xy: Index) -> Index:
    """Triangles over points sorted by their distance from the first."""
    count = len(xy)
    second = 1
    while second < count and xy[second, 0] == xy[0, 0] and xy[second, 1] == xy[0, 1]:
        second += 1
    third = second + 1
    while third < count and _turn(xy, 0, second, third) == 0:
        third += 1
    if third >= count:
        return new_index_table(0, 3)
    edges = _Edges(new_indices(6 * count), new_indices(6 * count))
    near = indices_of(max(8, math.ceil(math.sqrt(count))), -1)
    hull = _Hull(new_indices(count), new_indices(count), indices_of(count, -1), near)
    for k in range(count):
        hull.before[k], hull.following[k] = k, k
    if _turn(xy, 0, second, third) > 0:
        _add(edges, 0, 0, second, third)
    else:
        _add(edges, 0, 0, third, second)
    for k in range(3):
        one, other = edges.start[k], edges.start[(k + 1) % 3]
        hull.following[one], hull.before[other], hull.edge[one] = other, one, k
        hull.near[_direction(xy, one, len(hull.near))] = one
    stack = new_indices(64)
    used = 3
    for i in range(second + 1, count):
        if i != third:
            used, stack = _joined(i, xy, edges, hull, used, stack)
    triangles = new_index_table(used // 3, 3)
    for e in range(used):
        triangles[e // 3, e % 3] = edges.start[e]
    return triangles


@inlined()
def _joined(i: int, xy: Index, edges: _Edges, hull: _Hull, used: int, stack: Index) -> tuple[int, Index]:
    """Join point i, which lies outside the hull, to all that it sees of it; how many half-edges there are then."""
    first = hull.before[_seen_towards(i, xy, hull)]
    e = first
    while _turn(xy, e, hull.following[e], i) >= 0:
        e = hull.following[e]
        if e == first:
            return used, stack  # it sees nothing: it falls together with a point of the hull
    last = hull.following[e]
    _add(edges, used, e, i, last)
    _link(edges, used + 2, hull.edge[e])
    hull.edge[e] = used
    hull.edge[i], stack = _legalised(used + 2, xy, edges, hull, stack)
    used += 3
    while _turn(xy, last, hull.following[last], i) < 0:
        beyond = hull.following[last]
        _add(edges, used, last, i, beyond)
        _link(edges, used, hull.edge[i])
        _link(edges, used + 2, hull.edge[last])
        hull.following[last] = last
        hull.edge[i], stack = _legalised(used + 2, xy, edges, hull, stack)
        used, last = used + 3, beyond
    while e == first and _turn(xy, hull.before[e], e, i) < 0:
        beyond = hull.before[e]
        _add(edges, used, beyond, i, e)
        _link(edges, used + 1, hull.edge[e])
        _link(edges, used + 2, hull.edge[beyond])
        hull.edge[beyond] = used
        _, stack = _legalised(used + 2, xy, edges, hull, stack)
        hull.following[e] = e
        used, e = used + 3, beyond
        first = e
    hull.before[i], hull.following[i] = e, last
    hull.following[e], hull.before[last] = i, i
    hull.near[_direction(xy, i, len(hull.near))] = i
    hull.near[_direction(xy, e, len(hull.near))] = e
    return used, stack


@inlined()
def _add(edges: _Edges, at: int, a: int, b: int, c: int) -> None:
    """Add the triangle a, b, c as half-edges that have no twins yet."""
    edges.start[at], edges.start[at + 1], edges.start[at + 2] = a, b, c
    for k in range(3):
        edges.twin[at + k] = -1


@inlined()
def _link(edges: _Edges, one: int, other: int) -> None:
    edges.twin[one] = other
    if other >= 0:
        edges.twin[other] = one


@inlined()
def _legalised(a: int, xy: Index, edges: _Edges, hull: _Hull, stack: Index) -> tuple[int, Index]:
    r"""Flip edge a, opposite to a new point, and those that come to be opposite, until all circles are empty.

    Returns the half-edge that starts from the new point and follows the last of them, and the stack, which may grow.
    ::

             pl                   pl
            /||\                 /  \
         al/ || \bl           al/    \a
          /  ||  \             /      \
       p0   a||b   p1  flip  p0 --ar-- p1
          \  ||  /             \  bl  /
         ar\ || /br            b\    /br
            \||/                 \  /
             pr                   pr
    """
    depth = 0
    while True:
        b = edges.twin[a]
        ar = a - a % 3 + (a + 2) % 3
        if b >= 0:
            al, bl, br = a - a % 3 + (a + 1) % 3, b - b % 3 + (b + 2) % 3, b - b % 3 + (b + 1) % 3
            p0, p1 = edges.start[ar], edges.start[bl]
            if _in_circle(xy, p0, edges.start[a], edges.start[al], p1):
                edges.start[a], edges.start[b] = p1, p0
                if edges.twin[bl] < 0 and hull.edge[p1] == bl:
                    hull.edge[p1] = a
                _link(edges, a, edges.twin[bl])
                _link(edges, b, edges.twin[ar])
                _link(edges, ar, bl)
                if depth == len(stack):
                    stack = doubled_indices(stack)
                stack[depth] = br
                depth += 1
                continue
        if depth == 0:
            return ar, stack
        depth -= 1
        a = stack[depth]


@inlined()
def _seen_towards(i: int, xy: Index, hull: _Hull) -> int:
    """A vertex of the hull in about the direction of point i or the next one anticlockwise."""
    size = len(hull.near)
    towards = _direction(xy, i, size)
    for step in range(size):
        vertex = hull.near[(towards + step) % size]
        if vertex >= 0 and hull.following[vertex] != vertex:
            return int(vertex)
    return 0  # never: a hull has vertices


@inlined()
def _direction(xy: Index, i: int, size: int) -> int:
    """In which of `size` directions, anticlockwise, point i lies from the first."""
    dx, dy = float(xy[i, 0] - xy[0, 0]), float(xy[i, 1] - xy[0, 1])
    length = abs(dx) + abs(dy)
    share = dx / length if length > 0 else 0.0
    return int((3.0 - share if dy > 0 else 1.0 + share) / 4.0 * size) % size


@inlined()
def _turn(xy: Index, a: int, b: int, c: int) -> int:
    """Above 0 where a, b, c run anticlockwise, 0 where they are on one line; exact."""
    ax, ay = xy[a, 0], xy[a, 1]
    return int((xy[b, 0] - ax) * (xy[c, 1] - ay) - (xy[b, 1] - ay) * (xy[c, 0] - ax))


@inlined()
def _in_circle(xy: Index, a: int, b: int, c: int, d: int) -> bool:
    """Whether d lies within the circle through a, b, c, which run anticlockwise; exact."""
    ax, ay = xy[a, 0] - xy[d, 0], xy[a, 1] - xy[d, 1]
    bx, by = xy[b, 0] - xy[d, 0], xy[b, 1] - xy[d, 1]
    cx, cy = xy[c, 0] - xy[d, 0], xy[c, 1] - xy[d, 1]
    lift_a, lift_b, lift_c = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    area_a, area_b, area_c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    one, two, three = float(lift_a) * float(area_a), float(lift_b) * float(area_b), float(lift_c) * float(area_c)
    total = one + two + three
    if abs(total) > _DOUBT * (abs(one) + abs(two) + abs(three)):
        return bool(total > 0)
    high, middle, low = 0, 0, 0
    for k in range(3):
        lift, area = (lift_a, area_a) if k == 0 else ((lift_b, area_b) if k == 1 else (lift_c, area_c))
        high += (lift >> _LIMB) * (area >> _LIMB)
        middle += (lift >> _LIMB) * (area & _LIMB_MASK) + (lift & _LIMB_MASK) * (area >> _LIMB)
        low += (lift & _LIMB_MASK) * (area & _LIMB_MASK)
    middle += low >> _LIMB
    high += middle >> _LIMB
    return bool(high > 0 or (high == 0 and ((middle & _LIMB_MASK) > 0 or (low & _LIMB_MASK) > 0)))
