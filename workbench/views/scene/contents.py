"""What a 3D view shows, as plain arrays: cloud, mesh, marks, planes, lines, labels, measures and callouts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.model.arrays import Array
from workbench.views.scene.cloud import SceneCloud, as_points, finite_rows
from workbench.views.scene.colours import Colouring, Rgb

GRID = "#grid"
"""Name of the lines of the grid, which is seen whole."""


MARKS_NEARER = 0.003
"""Marks and lines often lie on the cloud; to be seen they are drawn nearer to the viewer, by this part of the way."""


@dataclass(frozen=True, eq=False, slots=True)
class Marks:
    """Marks at points (N, 3) in one colour, `size` pixels wide."""

    points: Array
    colour: Rgb
    size: float


@dataclass(frozen=True, eq=False, slots=True)
class Patches:
    """Transparent four-cornered patches, each (4, 3), with a colour each."""

    corners: tuple[Array, ...]
    colours: tuple[Rgb, ...]
    opacity: float


@dataclass(frozen=True, eq=False, slots=True)
class Lines:
    """Lines, each (N, 3), with a colour each, `width` pixels wide."""

    lines: tuple[Array, ...]
    colours: tuple[Rgb, ...]
    width: float


@dataclass(frozen=True, eq=False, slots=True)
class Labels:
    """Texts at places (N, 3); without a colour in that of the theme's text."""

    places: Array
    texts: tuple[str, ...]
    colour: Rgb | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Measure:
    """A dimension line from `ends`[0] to `ends`[1] with a text at its middle."""

    ends: Array
    text: str


@dataclass(frozen=True, eq=False, slots=True)
class Callout:
    """Callout of a place (3,) in mm.

    Parameters
    ----------
    name
        Tells it from the others.
    title, value
        Its two lines.
    sign
        Icon before the value, and its colour (a field of Shades), which the plate's edge has, too; None: no sign.
    outdated
        It is told that the value is no longer true.
    moved
        Pixels (right, down) of the plate's middle from the place; None: the view finds room for it.
    """

    name: str
    place: Array
    title: str
    value: str
    sign: tuple[str, str] | None = None
    outdated: bool = False
    moved: tuple[float, float] | None = None


Item = Marks | Patches | Lines | Labels | Measure


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """Triangulated surface; `serial` tells meshes apart."""

    vertices: Array
    triangles: NDArray[np.int64]
    values: Array | None
    colouring: Colouring

    serial: int = field(default_factory=count().__next__)

    def colours(self, vertices: NDArray[np.int64]) -> NDArray[np.uint8]:
        """Return the colours (n, 3), uint8, of the vertices with these numbers."""
        if self.values is not None:
            return self.colouring.of(self.values[vertices])
        return self.colouring.plain(vertices)

    @cached_property
    def corners(self) -> Array:
        """Two opposite corners (2, 3) in mm of the box around the mesh."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])


@dataclass(frozen=True, eq=False, slots=True)
class HiddenSide:
    """Half space in which cloud, mesh and marks are hidden: beyond a place (3,) in a direction (3,)."""

    place: Array
    towards: Array

    def hides(self, points: Array) -> NDArray[np.bool_]:
        """Compute flags (N,) of the points (N, 3) in mm that lie in the hidden half space."""
        return np.asarray((points - self.place) @ self.towards > 0)


@dataclass
class Scene:
    """Content of a view: everything that is shown. Items are replaced, never changed: the same object is the same
    drawing.
    """

    cloud: SceneCloud | None = None
    cloud_shown: bool = True
    mesh: SurfaceMesh | None = None
    mesh_shown: bool = True
    items: dict[tuple[type, str], Item] = field(default_factory=dict)
    hidden: HiddenSide | None = None
    callouts: tuple[Callout, ...] = ()
    """Words over the scene: nothing of it is drawn or fitted for them."""

    @property
    def visible_cloud(self) -> SceneCloud | None:
        """Cloud of the scene; None if it is hidden or has no points."""
        return self.cloud if self.cloud is not None and self.cloud_shown and self.cloud.drawable else None

    @property
    def visible_mesh(self) -> SurfaceMesh | None:
        """Mesh of the scene; None if it is hidden or there is none."""
        return self.mesh if self.mesh_shown else None

    @property
    def colouring(self) -> Colouring | None:
        """Colouring that the colour bar shows, the cloud's or else the mesh's; None without values."""
        for coloured in (self.visible_cloud, self.visible_mesh):
            if coloured is not None and coloured.colouring.name and coloured.colouring.limits is not None:
                return coloured.colouring
        return None

    def put(self, name: str, item: Item) -> None:
        """Add an item called `name`, in place of an item of the same kind and name."""
        self.items[type(item), name] = item

    def remove(self, name: str, kind: type | None = None) -> None:
        """Remove the items called `name`, only those of class `kind` if given."""
        for key in [key for key in self.items if key[1] == name and kind in (None, key[0])]:
            del self.items[key]

    def clear(self) -> None:
        """Remove everything from the scene, and show cloud and mesh again when there are new ones."""
        self.cloud = self.mesh = None
        self.cloud_shown = self.mesh_shown = True
        self.items = {}
        self.hidden = None
        self.callouts = ()

    @property
    def empty(self) -> bool:
        """Whether the scene has nothing to show."""
        return self.visible_cloud is None and self.visible_mesh is None and not self.items

    @property
    def has_edges(self) -> bool:
        """Whether the scene has lines or a mesh, whose edges have to be smoothed."""
        return self.visible_mesh is not None or any(isinstance(item, Lines) for item in self.items.values())

    @property
    def is_mesh_alone(self) -> bool:
        """Whether a mesh is shown and no cloud over it, so that its silhouettes and creases are drawn."""
        return self.visible_mesh is not None and self.visible_cloud is None

    def to_fit(self) -> Array:
        """Return the points (N, 3) in mm that a fitted view has to show: cloud, mesh and marks, or else everything."""
        parts = []
        if self.visible_cloud is not None:
            parts.append(self.visible_cloud.sample())
        if self.visible_mesh is not None:
            vertices = self.visible_mesh.vertices
            parts.append(vertices[:: max(1, len(vertices) // 20_000)])
        if parts:
            parts += [line for name, item in self.items.items() if name[1] == GRID for line in _points(item)]
        else:
            parts = [points for item in self.items.values() for points in _points(item)]
        points = np.vstack(parts) if parts else np.empty((0, 3))
        return points[finite_rows(points)]

    def box(self) -> Array:
        """Return the corners (8, 3) in mm of a box around everything in the scene; (0, 3) if it is empty."""
        ends = [cloud.corners for cloud in [self.visible_cloud] if cloud is not None]
        ends += [mesh.corners for mesh in [self.visible_mesh] if mesh is not None]
        ends += [points for item in self.items.values() for points in _points(item) if len(points)]
        if not ends or not np.isfinite(np.vstack(ends)).all(axis=1).any():
            return np.empty((0, 3))
        everything = np.vstack(ends)
        low, high = np.nanmin(everything, axis=0), np.nanmax(everything, axis=0)
        return np.array([[(low, high)[(k >> axis) & 1][axis] for axis in range(3)] for k in range(8)])


def _points(item: Item) -> Iterator[Array]:
    match item:
        case Marks():
            yield item.points
        case Patches():
            yield from item.corners
        case Lines():
            yield from item.lines
        case Labels():
            yield item.places
        case Measure():
            yield item.ends


def as_mesh(points: ArrayLike, triangles: ArrayLike, values: ArrayLike | None, colouring: Colouring) -> SurfaceMesh:
    """Make a mesh of checked arrays and known limits; triangles with a vertex that is not finite are dropped.

    Raises
    ------
    ValueError
        If shapes or vertex numbers do not match.
    """
    vertices = as_points(points, "vertices")
    corners = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if len(corners) and (corners.min() < 0 or corners.max() >= len(vertices)):
        raise ValueError("a triangle names a vertex that is not there")
    if not np.isfinite(vertices.sum()):
        finite = finite_rows(vertices)
        corners = corners[finite[corners].all(axis=1)]
        vertices = np.where(finite[:, None], vertices, np.nanmean(vertices, axis=0))
    numbers = None if values is None else np.asarray(values, dtype=np.float64).ravel()
    if numbers is not None:
        if len(numbers) != len(vertices):
            raise ValueError(f"{len(numbers)} values for {len(vertices)} vertices")
        colouring = colouring.limited(numbers)
    return SurfaceMesh(vertices, corners, numbers, colouring)


def each(colours: Sequence[Rgb], count: int) -> tuple[Rgb, ...]:
    """Return `count` colours: one colour repeated, or the given ones if there are as many; else ValueError."""
    if len(colours) == 1:
        return (colours[0],) * count
    if len(colours) != count:
        raise ValueError(f"{len(colours)} colours for {count} things")
    return tuple(colours)
