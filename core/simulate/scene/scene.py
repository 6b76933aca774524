"""Scene in front of the camera, a table, triangle meshes and spheres, and maps of what each pixel sees."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from core.compiled import compiled
from core.model import Camera, Pose
from core.model.arrays import Array, frozen_array, set_field
from core.simulate.rays import Map, ray_map
from core.simulate.scene.patterns import Pattern, draw_pattern
from core.simulate.scene.raster import draw_triangles
from core.simulate.scene.wrong_plates import points_on_bowed, rays_to_bowed

TABLE_ALBEDO, OBJECT_ALBEDO = 0.55, 0.7
"""Of a grey table and of a light, matt part."""
FARTHEST_MM = 5000.0
"""Depth beyond which nothing is seen."""
BOW_STRIPS = 40
"""Strips of a bowed board's surface, as what casts shadows has it: off by less than a shadow ray's clearance."""
TILE = 16
"""Side in px of the squares whose extent in space is known, see `SurfaceMaps`; chosen by speed."""


@dataclass(frozen=True, slots=True)
class Material:
    """Reflection of the objects' surface beyond an even one.

    Parameters
    ----------
    inner_share
        Share of the light that enters and comes back from below the surface, evenly from all depths to `inner_mm`.
    inner_mm
        Greatest depth in mm from which light comes back.
    gloss
        Light of the mirroring lobe at its crest, over what an even surface sends back at normal incidence.
    gloss_rad
        Gaussian σ of that lobe as a tilt of the surface, in rad: its roughness (Torrance and Sparrow 1967,
        doi:10.1364/JOSA.57.001105, without masking). Of a surface with a lay, across that.
    along_rad
        σ along the lay of a ground, rolled or brushed surface, where it is smoother; 0: it has none (Ward 1992,
        doi:10.1145/133994.134078).
    lay
        Direction (x, y, z) of the lay in the camera's frame; on each face as its plane has it.
    scattered, free_path_mm, scatter_albedo
        Share of the light that wanders through the matter, its free path and albedo: `core.simulate.scene.walk`.
    """

    inner_share: float = 0.0
    inner_mm: float = 0.0
    gloss: float = 0.0
    gloss_rad: float = 0.1
    along_rad: float = 0.0
    lay: tuple[float, float, float] = (1.0, 0.0, 0.0)
    scattered: float = 0.0
    free_path_mm: float = 0.3
    scatter_albedo: float = 0.98


MATT = Material()


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Mesh of triangles (T, 3, 3) in mm, corners counter-clockwise seen from outside.

    With `normals` (T, 3, 3), one unit vector a corner, shading is smooth over the faces; without, each is flat.
    """

    triangles: Array
    albedo: float = OBJECT_ALBEDO
    normals: Array | None = None

    def __post_init__(self) -> None:
        set_field(self, "triangles", frozen_array(self.triangles, (None, 3, 3), "triangles"))
        if self.normals is not None:
            set_field(self, "normals", frozen_array(self.normals, (len(self.triangles), 3, 3), "normals"))

    def moved(self, pose: Pose) -> Mesh:
        """Transform the mesh by `pose` to another frame."""
        triangles = pose.apply(self.triangles.reshape(-1, 3)).reshape(-1, 3, 3)
        normals = None if self.normals is None else self.normals @ pose.rotation.T
        return Mesh(triangles, self.albedo, normals)


@dataclass(frozen=True, eq=False, slots=True)
class Sphere:
    """Ball with centre (3,) and radius in mm."""

    centre: Array
    radius: float
    albedo: float = OBJECT_ALBEDO

    def __post_init__(self) -> None:
        set_field(self, "centre", frozen_array(self.centre, (3,), "centre"))

    def moved(self, pose: Pose) -> Sphere:
        """Transform the sphere by `pose` to another frame."""
        return Sphere(pose.apply(self.centre[None])[0], self.radius, self.albedo)


@dataclass(frozen=True, eq=False, slots=True)
class Board:
    """Printed board called `name`, at `pose` in the camera frame, its left and right edges bent forward by `bow_mm`.

    It is matt, and what is behind its outline has the pattern's background.
    """

    name: str
    pattern: Pattern
    pose: Pose
    bow_mm: float = 0.0

    def moved(self, motion: Pose) -> Board:
        """Move the board by `motion` in the camera frame."""
        pose = Pose(motion.rotation @ self.pose.rotation, motion.apply(self.pose.translation[None])[0])
        return replace(self, pose=pose)

    @property
    def triangles(self) -> Array:
        """Its surface as triangles (T, 3, 3) in mm: strips along a bowed one."""
        (x0, y0, _), (x1, y1, _) = self.pattern.outline.min(axis=0), self.pattern.outline.max(axis=0)
        share = np.linspace(-1.0, 1.0, (BOW_STRIPS if self.bow_mm else 1) + 1)
        x, z = (x0 + x1) / 2 + share * (x1 - x0) / 2, -self.bow_mm * share**2
        top, bottom = (np.column_stack([x, np.full_like(x, y), z]) for y in (y0, y1))
        upper = np.stack([top[:-1], top[1:], bottom[1:]], axis=1)
        lower = np.stack([top[:-1], bottom[1:], bottom[:-1]], axis=1)
        return self.pose.apply(np.concatenate([upper, lower]).reshape(-1, 3)).reshape(-1, 3, 3)


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """Table and objects on it, all in the camera frame.

    `pose_cam_table` maps table coordinates (origin on the table, z up out of it, towards the camera) into the camera
    frame; None means there is no table. `material` is that of the objects; the table and `boards` beside them are matt.
    """

    pose_cam_table: Pose | None
    meshes: tuple[Mesh, ...] = ()
    spheres: tuple[Sphere, ...] = ()
    table_albedo: float = TABLE_ALBEDO
    material: Material = MATT
    boards: tuple[Board, ...] = ()

    @classmethod
    def on_table(
        cls,
        pose_cam_table: Pose,
        *things: Mesh | Sphere,
        table_albedo: float = TABLE_ALBEDO,
        material: Material = MATT,
        boards: tuple[Board, ...] = (),
    ) -> Scene:
        """Make a scene in the camera frame of a table and objects given in the table's frame."""
        moved = [thing.moved(pose_cam_table) for thing in things]
        meshes = tuple(thing for thing in moved if isinstance(thing, Mesh))
        spheres = tuple(thing for thing in moved if isinstance(thing, Sphere))
        return cls(pose_cam_table, meshes, spheres, table_albedo, material, boards)

    def moved(self, motion: Pose, *, with_table: bool = False) -> Scene:
        """Move the objects of the scene by `motion` in the camera frame; table and boards move only if `with_table`."""
        table, boards = self.pose_cam_table, self.boards
        if with_table:
            boards = tuple(board.moved(motion) for board in boards)
        if with_table and table is not None:
            table = Pose(motion.rotation @ table.rotation, motion.apply(table.translation[None])[0])
        meshes = tuple(mesh.moved(motion) for mesh in self.meshes)
        spheres = tuple(sphere.moved(motion) for sphere in self.spheres)
        return Scene(table, meshes, spheres, self.table_albedo, self.material, boards)

    @property
    def occluders(self) -> Array:
        """Triangles (T, 3, 3) that can cast a shadow; the table is below everything and casts none."""
        shading = [*(mesh.triangles for mesh in self.meshes), *(board.triangles for board in self.boards)]
        return np.concatenate(shading) if shading else np.empty((0, 3, 3))


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceMaps:
    """Maps of the surface in each pixel, float32: point (h, w, 3) in mm, outward unit normal (h, w, 3), albedo (h, w).

    A pixel that sees nothing has depth 0 and albedo 0. `table` is True where the table is seen, `matt` where the table
    or a board is (None: where the table is). `tiles` is filled in:
    smallest and largest coordinates (2, rows, columns, 3) in mm within each tile of TILE × TILE pixels, so that what is
    near a plane is found without looking at every pixel.
    """

    points: Map
    normals: Map
    albedo: Map
    table: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((0, 0), np.bool_))
    matt: NDArray[np.bool_] | None = None
    tiles: Map = field(init=False)

    def __post_init__(self) -> None:
        set_field(self, "tiles", _extent_by_tile(self.points))

    @property
    def depth(self) -> Map:
        """Depth z (h, w) in mm of each pixel's surface point, 0 where nothing is seen."""
        return self.points[..., 2]


def surface_maps(scene: Scene, camera: Camera, rays: Map | None = None) -> SurfaceMaps:
    """Compute surface point, normal and albedo seen by each pixel of `camera`, along its distorted ray.

    `rays` is :func:`core.simulate.rays.ray_map` of the camera, computed here when it is not given.
    """
    rays = ray_map(camera) if rays is None else rays
    shape = rays.shape[:2]
    depth = np.full(shape, FARTHEST_MM, np.float32)
    normals = np.zeros((*shape, 3), np.float32)
    albedo = np.zeros(shape, np.float32)
    table = np.zeros(shape, np.bool_)
    if scene.pose_cam_table is not None:
        _see_table(scene.pose_cam_table, rays, depth, normals)
        albedo[depth < FARTHEST_MM] = scene.table_albedo
        table = depth < FARTHEST_MM
    for mesh in scene.meshes:
        face = np.full(shape, -1, np.int32)
        draw_triangles(mesh.triangles, camera, rays, depth, face)
        seen = face >= 0
        normals[seen] = _mesh_normals(mesh, face[seen], rays[seen], depth[seen])
        albedo[seen] = mesh.albedo
        table &= ~seen
    for sphere in scene.spheres:
        table &= ~_see_sphere(sphere, rays, depth, normals, albedo)
    matt = table.copy() if scene.boards else None
    for board in scene.boards:
        seen = _see_board(board, rays, depth, normals, albedo)
        table &= ~seen
        assert matt is not None
        matt |= seen
    depth[depth == FARTHEST_MM] = 0
    points = np.empty((*shape, 3), np.float32)
    np.multiply(rays, depth[..., None], out=points[..., :2])
    points[..., 2] = depth
    return SurfaceMaps(points, normals, albedo, table, matt)


def _see_board(board: Board, rays: Map, depth: Map, normals: Map, albedo: Map) -> NDArray[np.bool_]:
    """Draw one board into the maps; returns where it is seen."""
    bent = rays_to_bowed(board.pattern, board.pose, rays, board.bow_mm)
    points, printed = draw_pattern(board.pattern, board.pose, bent)
    points = points_on_bowed(board.pattern, board.pose, rays, points, board.bow_mm) * (points[..., 2:] > 0)
    seen = (points[..., 2] > 0) & (points[..., 2] < depth)
    depth[seen], albedo[seen] = points[seen, 2], printed[seen]
    normals[seen] = -board.pose.rotation[:, 2]
    return np.asarray(seen, dtype=np.bool_)


@compiled()
def _extent_by_tile(points):  # type: ignore[no-untyped-def]
    height, width = points.shape[:2]
    extent = np.empty((2, (height + TILE - 1) // TILE, (width + TILE - 1) // TILE, 3), np.float32)
    extent[0], extent[1] = np.inf, -np.inf
    for v in range(height):
        for u in range(width):
            for k in range(3):
                value = points[v, u, k]
                extent[0, v // TILE, u // TILE, k] = min(extent[0, v // TILE, u // TILE, k], value)
                extent[1, v // TILE, u // TILE, k] = max(extent[1, v // TILE, u // TILE, k], value)
    return extent


def _see_table(pose: Pose, rays: Map, depth: Map, normals: Map) -> None:
    up = pose.rotation[:, 2]
    slope = rays[..., 0] * up[0] + rays[..., 1] * up[1] + up[2]
    z = (up @ pose.translation) / slope
    seen = (slope < 0) & (z > 0) & (z < FARTHEST_MM)
    depth[seen] = z[seen]
    normals[seen] = up


def _see_sphere(sphere: Sphere, rays: Map, depth: Map, normals: Map, albedo: Map) -> NDArray[np.bool_]:
    """Draw one sphere into the maps; returns where it is seen."""
    x, y = rays[..., 0].astype(np.float64), rays[..., 1].astype(np.float64)
    a = x * x + y * y + 1
    b = x * sphere.centre[0] + y * sphere.centre[1] + sphere.centre[2]
    root = b * b - a * (sphere.centre @ sphere.centre - sphere.radius**2)
    z = (b - np.sqrt(np.maximum(root, 0))) / a
    seen = (root > 0) & (z > 0) & (z < depth)
    depth[seen] = z[seen]
    hit = np.column_stack([x[seen], y[seen], np.ones(seen.sum())]) * z[seen, None]
    normals[seen] = (hit - sphere.centre) / sphere.radius
    albedo[seen] = sphere.albedo
    return np.asarray(seen, dtype=np.bool_)


def _mesh_normals(mesh: Mesh, face: NDArray[np.int32], rays: Map, depth: Map) -> Array:
    """Unit normals (N, 3) at the points seen: of the flat faces, or blended from the corners.

    They point to the side that is seen, so thin shells and files with faces turned inside out look right.
    """
    corners = mesh.triangles[face]
    directions = np.column_stack([rays, np.ones(len(rays))])
    normals: Array = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = np.einsum("ni,ni->n", normals, directions) > 0
    if mesh.normals is not None:
        points = directions * depth[:, None]
        shares = [
            np.einsum("ni,ni->n", np.cross(corners[:, j] - points, corners[:, k] - points), normals)[:, None]
            for j, k in ((1, 2), (2, 0), (0, 1))
        ]
        normals = np.sum([share * mesh.normals[face, i] for i, share in enumerate(shares)], axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[away] *= -1
    return normals
