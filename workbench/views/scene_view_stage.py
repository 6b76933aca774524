"""The scene as VTK actors in one render window, drawn in passes.

A cloud of millions takes software OpenGL a second. So a picture may be drawn in several passes, each a few chunks of
the cloud over what is already there (colour and depth are kept), and is shown when the last one is done. Passes also
spread the work of sending a new cloud to the graphics card.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkIdTypeArray, vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow

from core.model.arrays import Array
from workbench.views.scene_view_camera import SceneCamera
from workbench.views.scene_view_cloud import CHUNK
from workbench.views.scene_view_colours import Rgb
from workbench.views.scene_view_contents import MARKS_NEARER, Item, Labels, Lines, Marks, Measure, Patches, Scene
from workbench.views.scene_view_pieces import Key, Version, make, version


class Stage:
    """Actors of a scene in a render window. All in the GUI thread."""

    def __init__(self, window: vtkRenderWindow) -> None:
        self.window = window
        self.renderer = vtkRenderer()
        self.renderer.SetUseOIT(False)
        self.renderer.SetAutomaticLightCreation(False)
        self.renderer.RemoveAllLights()
        self.renderer.AddLight(_headlight())
        self.renderer.GetCullers().RemoveAllItems()
        window.SetMultiSamples(0)
        window.AddRenderer(self.renderer)
        self.pixel_ratio = 1.0
        self.point_size = 2.0
        self._items: dict[tuple[type, str], tuple[Item, vtkActor | None]] = {}
        self._pieces: dict[Key, tuple[Version, vtkActor]] = {}
        self._verts: dict[int, vtkCellArray] = {}

    def set_background(self, colour: Rgb) -> None:
        """Colour behind the scene."""
        self.renderer.SetBackground(*(c / 255 for c in colour))

    def is_made(self, scene: Scene, key: Key) -> bool:
        """Whether a piece is there as it is in the scene."""
        return key in self._pieces and self._pieces[key][0] == version(scene, key)

    def draw(
        self, scene: Scene, camera: SceneCamera, keys: Iterable[Key], *, first: bool, last: bool, smooth: bool
    ) -> None:
        """One pass: some pieces of cloud and mesh; with the first lines, with the last marks and all transparent."""
        if first:
            self._sync(scene)
        shown = set(keys)
        for key in shown:
            if not self.is_made(scene, key):
                self._make(scene, key)
        for key, (_, actor) in self._pieces.items():
            actor.SetVisibility(key in shown)
            if key.kind == "cloud" and key in shown:
                actor.GetProperty().SetPointSize(self.point_size * self.pixel_ratio)
        nearer = _nearer(camera)
        for item, item_actor in self._items.values():
            if item_actor is not None:
                item_actor.SetVisibility(first if isinstance(item, Lines) else last)
                if not isinstance(item, Patches):
                    item_actor.SetUserMatrix(nearer)
        self.renderer.SetPreserveColorBuffer(not first)
        self.renderer.SetPreserveDepthBuffer(not first)
        self.renderer.SetUseFXAA(smooth)
        self._aim(camera, scene)
        self.window.SetSwapBuffers(last)
        self.window.Render()
        self.window.WaitForCompletion()  # or the time of a pass would show up in a later one

    def close(self) -> None:
        """Let go of everything, while the render window still lives."""
        self.renderer.RemoveAllViewProps()
        self._items, self._pieces, self._verts = {}, {}, {}
        self.window.RemoveRenderer(self.renderer)

    def _sync(self, scene: Scene) -> None:
        """Make the actors of items those of the scene, and drop the pieces it has no longer."""
        for name in [name for name in self._items if scene.items.get(name) is not self._items[name][0]]:
            self._take_away(self._items.pop(name)[1])
        for name, item in scene.items.items():
            if name not in self._items:
                actor = self._item_actor(item)
                self._items[name] = item, actor
                if actor is not None:
                    self.renderer.AddActor(actor)
        current = {key: version(scene, key) for key in self._pieces}
        for key in [key for key, (made, _) in self._pieces.items() if not _same_thing(made, current[key])]:
            self._take_away(self._pieces.pop(key)[1])

    def _aim(self, camera: SceneCamera, scene: Scene) -> None:
        vtk_camera = self.renderer.GetActiveCamera()
        vtk_camera.SetFocalPoint(*camera.focal)
        vtk_camera.SetPosition(*camera.position)
        vtk_camera.SetViewUp(*camera.axes[1])
        vtk_camera.SetViewAngle(np.degrees(camera.view_angle))
        vtk_camera.SetParallelProjection(camera.parallel)
        vtk_camera.SetParallelScale(camera.half_height)
        box = scene.box()
        if len(box):
            vtk_camera.SetClippingRange(*camera.depth_range(box))

    def _take_away(self, actor: vtkActor | None) -> None:
        if actor is not None:
            self.renderer.RemoveActor(actor)

    def _make(self, scene: Scene, key: Key) -> None:
        """Gather a piece into an actor."""
        if key in self._pieces:
            self._take_away(self._pieces[key][1])
        made = version(scene, key)
        assert made is not None
        piece = make(scene, key)
        data = vtkPolyData()
        data.SetPoints(_points(piece.points))
        data.GetPointData().SetScalars(_vtk(piece.colours, deep=False))
        if piece.triangles is None:
            data.SetVerts(self._cells(len(piece.points)))
        else:
            cells = vtkCellArray()
            cells.SetData(3, _ids(piece.triangles.ravel()))
            data.SetPolys(cells)
            assert piece.normals is not None
            data.GetPointData().SetNormals(_vtk(piece.normals))
        actor = _actor(data)
        if piece.triangles is not None:
            _light(actor)
        self.renderer.AddActor(actor)
        self._pieces[key] = made, actor

    def _cells(self, count: int) -> vtkCellArray:
        """One cell a point, shared by all full chunks."""
        if count not in self._verts:
            self._verts = {n: cells for n, cells in self._verts.items() if n == CHUNK} | {count: _one_cell_each(count)}
        return self._verts[count]

    def _item_actor(self, item: Item) -> vtkActor | None:
        match item:
            case Marks():
                return self._marks(item)
            case Patches():
                return _patches(item)
            case Lines():
                return self._lines(item)
            case Labels() | Measure():
                return None  # drawn over the picture

    def _marks(self, marks: Marks) -> vtkActor:
        data = vtkPolyData()
        data.SetPoints(_points(marks.points))
        data.SetVerts(_one_cell_each(len(marks.points)))
        actor = _actor(data, marks.colour)
        actor.GetProperty().SetPointSize(marks.size * self.pixel_ratio)
        return actor

    def _lines(self, lines: Lines) -> vtkActor:
        data = vtkPolyData()
        data.SetPoints(_points(np.vstack(lines.lines) if lines.lines else np.empty((0, 3))))
        cells, start = vtkCellArray(), 0
        for line in lines.lines:
            cells.InsertNextCell(len(line), list(range(start, start + len(line))))
            start += len(line)
        data.SetLines(cells)
        colours = [
            np.tile(np.array(c, dtype=np.uint8), (len(line), 1))
            for line, c in zip(lines.lines, lines.colours, strict=True)
        ]
        data.GetPointData().SetScalars(_vtk(np.vstack([*colours, np.empty((0, 3), np.uint8)])))
        actor = _actor(data)
        actor.GetProperty().SetLineWidth(lines.width * self.pixel_ratio)
        return actor


def read_pixels(window: vtkRenderWindow) -> NDArray[np.uint8]:
    """The picture a render window shows, (h, w, 3)."""
    width, height = window.GetSize()
    window.MakeCurrent()
    data = vtkUnsignedCharArray()
    window.GetPixelData(0, 0, width - 1, height - 1, 0, data, 0)
    rows: NDArray[np.uint8] = vtk_to_numpy(data).reshape(height, width, 3)  # type: ignore[no-untyped-call]
    return rows[::-1].copy()


def _actor(data: vtkPolyData, colour: Rgb | None = None) -> vtkActor:
    """An unlit actor, in one colour or in those of its points."""
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetStatic(True)
    mapper.SetScalarVisibility(colour is None)
    mapper.SetColorModeToDirectScalars()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    if colour is not None:
        actor.GetProperty().SetColor(*(c / 255 for c in colour))
    return actor


def _patches(patches: Patches) -> vtkActor:
    data = vtkPolyData()
    data.SetPoints(_points(np.vstack([*patches.corners, np.empty((0, 3))])))
    cells = vtkCellArray()
    for k in range(len(patches.corners)):
        cells.InsertNextCell(4, [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3])
    data.SetPolys(cells)
    alpha = round(255 * patches.opacity)
    colours = np.repeat(np.array([[*c, alpha] for c in patches.colours], dtype=np.uint8).reshape(-1, 4), 4, axis=0)
    data.GetPointData().SetScalars(_vtk(colours))
    actor = _actor(data)
    actor.ForceTranslucentOn()
    return actor


def _nearer(camera: SceneCamera) -> vtkMatrix4x4:
    """Brings points nearer to the viewer, each on its line of sight."""
    linear, shift = np.eye(3), camera.axes[2] * camera.distance * MARKS_NEARER
    if not camera.parallel:
        linear, shift = linear * (1 - MARKS_NEARER), camera.position * MARKS_NEARER
    matrix = vtkMatrix4x4()
    matrix.DeepCopy([*np.column_stack([linear, shift]).ravel(), 0, 0, 0, 1])
    return matrix


def _light(actor: vtkActor) -> None:
    """Shade by the normals."""
    looks = actor.GetProperty()
    looks.LightingOn()
    looks.SetInterpolationToGouraud()
    looks.SetAmbient(0.3)
    looks.SetDiffuse(0.8)


def _same_thing(made: Version, current: Version | None) -> bool:
    """Whether a piece is still of the same cloud or mesh; it may have grown."""
    return current is not None and made[:2] == current[:2]


def _points(points: NDArray[np.float32] | Array) -> vtkPoints:
    held = vtkPoints()
    held.SetData(_vtk(np.ascontiguousarray(points, dtype=np.float32), deep=False))  # holds a reference to the array
    return held


def _vtk(array: NDArray[Any], deep: bool = True) -> vtkDataArray:
    """An array for VTK: a copy, or one that keeps the numpy array alive."""
    given: vtkDataArray = numpy_to_vtk(array, deep=deep)  # type: ignore[no-untyped-call]
    return given


def _ids(array: NDArray[np.int64]) -> vtkIdTypeArray:
    given: vtkIdTypeArray = numpy_to_vtkIdTypeArray(array, deep=True)  # type: ignore[no-untyped-call]
    return given


def _one_cell_each(count: int) -> vtkCellArray:
    cells = vtkCellArray()
    cells.SetData(1, _ids(np.arange(count, dtype=np.int64)))
    return cells


def _headlight() -> Any:
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(-0.35, 0.45, 1.0)
    light.SetFocalPoint(0, 0, 0)
    return light
