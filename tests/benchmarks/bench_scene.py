"""The 3D view's own camera, picking and passes beside those of VTK that pyvista uses, on the OpenGL that is there.

Needs a screen, for software OpenGL a virtual one: `xvfb-run -a pytest tests/benchmarks/bench_scene.py -s`.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkRenderingCore import vtkCellPicker, vtkHardwarePicker, vtkPointPicker

from tests.benchmarks.conftest import table
from tests.workbench.views.scene.test_view import ready  # noqa: F401  a fixture
from workbench.views.scene.camera import SceneCamera
from workbench.views.scene.chooser import nearest_point
from workbench.views.scene.view import SceneView

SIZE = (1000, 700)
POINTS, SIDE = 1_000_000, 316
"""Points of the cloud, and vertices along a side of the mesh, of some 200,000 triangles: a scan of 300 frames."""


def cloud() -> np.ndarray:
    """A wavy surface of 200 mm, POINTS times at random: (N, 3) in mm."""
    u, v = np.random.default_rng(1).uniform(-100, 100, (2, POINTS))
    return np.column_stack([u, v, 500 + 8 * np.sin(u / 9) * np.cos(v / 12)])


def mesh() -> tuple[np.ndarray, np.ndarray]:
    """The same surface as vertices (n, 3) and triangles (m, 3)."""
    u, v = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-100, 100, SIDE)] * 2))
    first = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    triangles = np.concatenate(
        [first[:, None] + [0, 1, SIDE], first[:, None] + [1, SIDE + 1, SIDE]],
    )
    return np.column_stack([u, v, 500 + 8 * np.sin(u / 9) * np.cos(v / 12)]), triangles


def milliseconds(job: Callable[[], object], rounds: int) -> np.ndarray:
    """How long each of `rounds` calls took, after one that does not count."""
    job()
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        job()
        times.append(1e3 * (time.perf_counter() - began))
    return np.array(times)


@pytest.fixture
def plotter():
    """Cloud and mesh as pyvista draws them."""
    made = pv.Plotter(off_screen=True, window_size=list(SIZE))
    made.add_points(cloud(), color="w", point_size=2)
    vertices, triangles = mesh()
    made.add_mesh(pv.PolyData.from_regular_faces(vertices, triangles), color="w")
    made.view_xy()
    made.show(auto_close=False)
    yield made
    made.close()


def test_the_longest_stop_of_the_window_while_the_view_is_turned(capsys, qtbot, ready, plotter):  # noqa: F811
    view = SceneView()
    qtbot.addWidget(view)
    view.resize(*SIZE)
    view.show()
    qtbot.waitExposed(view)
    view.set_cloud(cloud())
    view.set_mesh(*mesh())
    qtbot.waitUntil(lambda: view.state().complete, timeout=120_000)
    drawing = view._drawing
    drawing.pass_ms = []
    for _ in range(15):
        view._navigator.orbit(12, 3)
        qtbot.wait(40)
    began = time.perf_counter()
    qtbot.waitUntil(lambda: view.state().complete, timeout=120_000)
    whole = 1e3 * (time.perf_counter() - began)

    def turn() -> None:
        plotter.camera.azimuth += 3
        plotter.render()
        plotter.render_window.WaitForCompletion()

    theirs = milliseconds(turn, 7)
    ours = np.array(drawing.pass_ms)
    table(capsys, f"Turning a view of {POINTS:,d} points and {2 * (SIDE - 1) ** 2:,d} triangles", {
        "passes: median, longest": f"{np.median(ours):7.1f}, {ours.max():7.1f} ms",
        "passes: until everything is shown after the last turn": f"{whole:7.1f} ms",
        "pyvista, all in one: median, longest": f"{np.median(theirs):7.1f}, {theirs.max():7.1f} ms",
    })  # fmt: skip


def test_the_point_that_a_click_means(capsys, plotter):
    points, camera = cloud(), SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    rows = {"own: nearest on the screen": milliseconds(lambda: nearest_point(points, camera, SIZE, (510, 360)), 7)}
    for kind in (vtkPointPicker, vtkCellPicker, vtkHardwarePicker):
        picker = kind()
        rows[kind.__name__] = milliseconds(lambda picker=picker: picker.Pick(510, 360, 0, plotter.renderer), 3)
    table(capsys, f"Picking in {POINTS:,d} points", {name: f"{np.median(ms):9.1f} ms" for name, ms in rows.items()})


def test_projecting_points_for_labels_and_outlines(capsys, plotter):
    points, camera = cloud(), SceneCamera.looking((0, 0, -1), (0, -1, 0), (0, 0, 500), 500)
    ours = np.median(milliseconds(lambda: camera.project(points, SIZE), 5))
    some = points[::100]

    def by_vtk() -> None:
        for point in some:
            plotter.renderer.SetWorldPoint(*point, 1.0)
            plotter.renderer.WorldToDisplay()
            plotter.renderer.GetDisplayPoint()

    theirs = np.median(milliseconds(by_vtk, 3)) * len(points) / len(some)
    table(capsys, f"Projecting {POINTS:,d} points", {
        "own camera": f"{ours:9.1f} ms",
        "VTK's camera, point by point": f"{theirs:9.1f} ms",
    })  # fmt: skip
