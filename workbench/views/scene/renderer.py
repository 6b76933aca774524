"""The scene as VTK actors in one render window, drawn in passes. Everything in the GUI thread."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import (
    vtkCommand,
    vtkDataArray,
    vtkFloatArray,
    vtkIdTypeArray,
    vtkLogger,
    vtkObject,
    vtkOutputWindow,
    vtkPoints,
    vtkUnsignedCharArray,
)
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPlane, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow
from vtkmodules.vtkRenderingOpenGL2 import vtkGenericOpenGLRenderWindow

from core.model.arrays import Array
from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.colours import Rgb
from workbench.views.scene.contents import MARKS_NEARER, Item, Lines, Marks, Patches, Scene
from workbench.views.scene.edges import Depths
from workbench.views.scene.passes import Part, Pass, Version, gather, version

_log = logging.getLogger("vtk")
_observed: list[vtkOutputWindow] = []

SHADE = 0.7
"""A plain mesh edge-on is darker by this part: its form is all there is to see."""

VALUES_SHADE = 0.15
"""What is coloured by values is darker by this part edge-on: its colours are to be read off the colour bar."""

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "software", "swiftshader", "gdi generic")
"""How drivers call themselves that have the processor draw."""

SHADOW_REACH, SHADOW_BIAS, SHADOW_SAMPLES = 0.06, 0.001, 64
"""Ambient occlusion looks so far round each point, as a share of the scene's diagonal; it takes no notice of less than
the second; it looks at so many places."""


class Renderer:
    """Renderer of scenes into a render window, of a widget or off screen."""

    def __init__(self, window: vtkRenderWindow) -> None:
        self._renderer = vtkRenderer()
        self._renderer.SetUseOIT(False)
        self._renderer.SetAutomaticLightCreation(False)
        self._renderer.RemoveAllLights()
        self._renderer.AddLight(_headlight())
        self._renderer.GetCullers().RemoveAllItems()
        self._window = window
        renderers = window.GetRenderers()
        for _ in range(renderers.GetNumberOfItems()):  # the plotter's own
            window.RemoveRenderer(renderers.GetFirstRenderer())
        self._window.SetMultiSamples(0)
        self._window.AddRenderer(self._renderer)
        self.point_size = 2.0
        """Diameter of the cloud's points in logical pixels."""
        self._items: dict[tuple[type, str], tuple[Item, vtkActor | None]] = {}
        self._parts: dict[Part, tuple[Version, vtkActor]] = {}
        self._cut = vtkPlane()
        self.has_card: bool | None = None
        """Whether a graphics card draws, which has time for ambient occlusion; None before it was found out."""

    def set_background(self, colour: Rgb) -> None:
        """Set the colour of the background behind the scene."""
        self._renderer.SetBackground(*(c / 255 for c in colour))

    def is_made(self, scene: Scene, part: Part) -> bool:
        """Whether a part of the scene is ready to be drawn, its arrays having been collected."""
        return part in self._parts and self._parts[part][0] == version(scene, part)

    def draw(self, scene: Scene, camera: SceneCamera, what: Pass, size: tuple[int, int], ratio: float) -> None:
        """Draw a pass of the scene and wait for it; `size` is in device pixels, `ratio` of them to a logical pixel."""
        if what.first:
            if not isinstance(self._window, vtkGenericOpenGLRenderWindow):  # a widget's window has the widget's size
                self._window.SetSize(*size)
            self._sync(scene)
        for part in what.parts:
            if not self.is_made(scene, part) and version(scene, part) is not None:
                self._make(scene, part)
        shown = set(what.parts)
        for part, (_, actor) in self._parts.items():
            actor.SetVisibility(part in shown)
            if part.kind == "cloud":
                actor.GetProperty().SetPointSize(self.point_size * ratio)
        nearer = _nearer(camera)
        for item, item_actor in self._items.values():
            if item_actor is None:
                continue
            item_actor.SetVisibility(what.first if isinstance(item, Lines) else what.last)
            if isinstance(item, Lines):
                item_actor.GetProperty().SetLineWidth(item.width * ratio)
            if isinstance(item, Marks):
                item_actor.GetProperty().SetPointSize(item.size * ratio)
            if not isinstance(item, Patches):
                item_actor.SetUserMatrix(nearer)
        self._hide(scene)
        self._renderer.SetPreserveColorBuffer(not what.first)
        self._renderer.SetPreserveDepthBuffer(not what.first)
        self._renderer.SetUseFXAA(what.smooth)
        self._occlude(scene, what)
        self._aim(camera, scene)
        self._window.SetSwapBuffers(what.last)
        self._window.Render()
        self._window.WaitForCompletion()  # or the time of a pass would show up in a later one

    def pixels(self) -> NDArray[np.uint8]:
        """Return the picture (h, w, 3), uint8, that was drawn last."""
        width, height = self._window.GetSize()
        self._window.MakeCurrent()
        data = vtkUnsignedCharArray()
        self._window.GetPixelData(0, 0, width - 1, height - 1, 0, data, 0)
        rows: NDArray[np.uint8] = vtk_to_numpy(data).reshape(height, width, 3)  # type: ignore[no-untyped-call]
        return rows[::-1].copy()

    def depths(self) -> Depths:
        """Return the depth buffer of the picture that was drawn last."""
        width, height = self._window.GetSize()
        self._window.MakeCurrent()
        data = vtkFloatArray()
        self._window.GetZbufferData(0, 0, width - 1, height - 1, data)
        rows: NDArray[np.float32] = vtk_to_numpy(data).reshape(height, width)  # type: ignore[no-untyped-call]
        near, far = self._renderer.GetActiveCamera().GetClippingRange()
        return Depths(rows[::-1].copy(), near, far)

    def close(self) -> None:
        """Release all of VTK's objects, while the window still exists."""
        self._renderer.RemoveAllViewProps()
        self._items, self._parts = {}, {}
        self._window.RemoveRenderer(self._renderer)

    def _occlude(self, scene: Scene, what: Pass) -> None:
        """Darken what other parts of a mesh stand before, where a graphics card draws all of it in one pass."""
        wanted = scene.is_mesh_alone and what.first and what.last and what.smooth
        if wanted and self.has_card is None:
            said = self._window.ReportCapabilities().lower()
            self.has_card = "renderer string" in said and not any(name in said for name in SOFTWARE)
        self._renderer.SetUseSSAO(bool(wanted and self.has_card))
        if self._renderer.GetUseSSAO():
            diagonal = float(np.linalg.norm(np.ptp(scene.box(), axis=0)))
            self._renderer.SetSSAORadius(SHADOW_REACH * diagonal)
            self._renderer.SetSSAOBias(SHADOW_BIAS * diagonal)
            self._renderer.SetSSAOKernelSize(SHADOW_SAMPLES)
            self._renderer.SetSSAOBlur(True)

    def _sync(self, scene: Scene) -> None:
        """Make the actors of items those of the scene, and drop the parts it has no longer."""
        for name in [name for name in self._items if scene.items.get(name) is not self._items[name][0]]:
            if (actor := self._items.pop(name)[1]) is not None:
                self._renderer.RemoveActor(actor)
        for name, item in scene.items.items():
            if name not in self._items:
                actor = _item_actor(item)
                self._items[name] = item, actor
                if actor is not None:
                    self._renderer.AddActor(actor)
        for part, (made, _) in list(self._parts.items()):
            current = version(scene, part)
            if current is None or current.serial != made.serial:  # one that has grown is shown until it is made anew
                self._renderer.RemoveActor(self._parts.pop(part)[1])

    def _hide(self, scene: Scene) -> None:
        """Let cloud, mesh and marks be cut where their hidden side begins."""
        if scene.hidden is not None:
            self._cut.SetOrigin(*scene.hidden.place)
            self._cut.SetNormal(*-scene.hidden.towards)
        marks = (actor for item, actor in self._items.values() if isinstance(item, Marks) and actor is not None)
        for actor in (*(actor for _, actor in self._parts.values()), *marks):
            mapper = actor.GetMapper()
            planes = mapper.GetClippingPlanes()
            cut = planes is not None and planes.GetNumberOfItems() > 0
            if scene.hidden is not None and not cut:
                mapper.AddClippingPlane(self._cut)
            elif scene.hidden is None and cut:
                mapper.RemoveAllClippingPlanes()

    def _aim(self, camera: SceneCamera, scene: Scene) -> None:
        vtk_camera = self._renderer.GetActiveCamera()
        vtk_camera.SetFocalPoint(*camera.focal)
        vtk_camera.SetPosition(*camera.position)
        vtk_camera.SetViewUp(*camera.axes[1])
        vtk_camera.SetViewAngle(np.degrees(camera.view_angle))
        vtk_camera.SetParallelProjection(camera.parallel)
        vtk_camera.SetParallelScale(camera.half_height)
        box = scene.box()
        if len(box):
            vtk_camera.SetClippingRange(*camera.depth_range(box))

    def _make(self, scene: Scene, part: Part) -> None:
        """Gather a part into an actor."""
        if part in self._parts:
            self._renderer.RemoveActor(self._parts[part][1])
        made = version(scene, part)
        assert made is not None
        gathered = gather(scene, part)
        data = _data(gathered.points, gathered.colours)
        if gathered.triangles is None:
            data.SetVerts(_cell_of_all(len(gathered.points)))
        else:
            cells = vtkCellArray()
            cells.SetData(3, _ids(gathered.triangles.ravel()))
            data.SetPolys(cells)
        actor = _actor(data)
        if gathered.normals is not None:
            data.GetPointData().SetNormals(_vtk(np.ascontiguousarray(gathered.normals)))
            plain = gathered.triangles is not None and scene.mesh is not None and scene.mesh.values is None
            _light(actor, SHADE if plain else VALUES_SHADE)
        self._renderer.AddActor(actor)
        self._parts[part] = made, actor


def _item_actor(item: Item) -> vtkActor | None:
    """What VTK draws of an item; labels and measures are written over the picture."""
    if isinstance(item, Marks):
        data = _data(item.points)
        data.SetVerts(_cell_of_all(len(item.points)))
        return _actor(data, item.colour)
    if isinstance(item, Patches):
        return _patches(item)
    if isinstance(item, Lines):
        return _lines(item)
    return None


def _lines(lines: Lines) -> vtkActor:
    colours = np.repeat(_rows(lines.colours, 3), [len(line) for line in lines.lines], axis=0)
    data = _data(np.vstack([*lines.lines, np.empty((0, 3))]), colours)
    cells, start = vtkCellArray(), 0
    for line in lines.lines:
        cells.InsertNextCell(len(line), list(range(start, start + len(line))))
        start += len(line)
    data.SetLines(cells)
    return _actor(data)


def _patches(patches: Patches) -> vtkActor:
    alpha = round(255 * patches.opacity)
    colours = np.repeat(_rows([(*colour, alpha) for colour in patches.colours], 4), 4, axis=0)
    data = _data(np.vstack([*patches.corners, np.empty((0, 3))]), colours)
    cells = vtkCellArray()
    for k in range(len(patches.corners)):
        cells.InsertNextCell(4, [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3])
    data.SetPolys(cells)
    actor = _actor(data)
    actor.ForceTranslucentOn()
    return actor


def _rows(colours: Any, channels: int) -> NDArray[np.uint8]:
    return np.array(colours, dtype=np.uint8).reshape(-1, channels)


def _data(points: NDArray[np.float32] | Array, colours: NDArray[np.uint8] | None = None) -> vtkPolyData:
    """Points with colours, without cells."""
    held = vtkPoints()
    held.SetData(_vtk(np.ascontiguousarray(points, dtype=np.float32)))
    data = vtkPolyData()
    data.SetPoints(held)
    if colours is not None:
        data.GetPointData().SetScalars(_vtk(np.ascontiguousarray(colours)))
    return data


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


def _nearer(camera: SceneCamera) -> vtkMatrix4x4:
    """Brings points nearer to the viewer, each on its line of sight."""
    linear, shift = np.eye(3), camera.axes[2] * camera.distance * MARKS_NEARER
    if not camera.parallel:
        linear, shift = linear * (1 - MARKS_NEARER), camera.position * MARKS_NEARER
    matrix = vtkMatrix4x4()
    matrix.DeepCopy([*np.column_stack([linear, shift]).ravel(), 0, 0, 0, 1])
    return matrix


def _light(actor: vtkActor, shade: float) -> None:
    """Shade by the normals: what is seen edge-on is darker by the part `shade`."""
    looks = actor.GetProperty()
    looks.LightingOn()
    looks.SetInterpolationToGouraud()
    looks.SetAmbient(1 - shade)
    looks.SetDiffuse(shade)


def _vtk(array: Any) -> vtkDataArray:
    """An array for VTK that keeps the numpy array alive."""
    given: vtkDataArray = numpy_to_vtk(array)  # type: ignore[no-untyped-call]
    return given


def _ids(array: NDArray[np.int64]) -> vtkIdTypeArray:
    given: vtkIdTypeArray = numpy_to_vtkIdTypeArray(array, deep=True)  # type: ignore[no-untyped-call]
    return given


def _cell_of_all(count: int) -> vtkCellArray:
    """One cell of all points: VTK draws each of them."""
    cells = vtkCellArray()
    cells.SetData(_ids(np.array([0, count] if count else [0])), _ids(np.arange(count)))
    return cells


def _headlight() -> Any:
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(0.0, 0.0, 1.0)
    light.SetFocalPoint(0, 0, 0)
    return light


def route_messages() -> None:
    """Send VTK's messages to Python's logging instead of the console; call it before VTK is used."""
    if _observed:
        return
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    window = vtkOutputWindow.GetInstance()
    window.AddObserver(int(vtkCommand.ErrorEvent), _error)
    window.AddObserver(int(vtkCommand.WarningEvent), _warning)
    _observed.append(window)


def _error(_sender: vtkObject, _event: str, text: str) -> None:
    _log.error("%s", text.strip())


def _warning(_sender: vtkObject, _event: str, text: str) -> None:
    _log.warning("%s", text.strip())


for _observer in (_error, _warning):
    setattr(_observer, "CallDataType", "string0")  # noqa: B010  how VTK is told to pass the text on
