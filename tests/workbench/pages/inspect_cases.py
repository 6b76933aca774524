"""A scan of a block made by hand: what the jobs of the inspect page would give, at once."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from core.files.project.data import Done, Project, Repeat, new_project
from core.files.project.keys import finished
from core.files.recording.rig import GaugeSpec
from core.inspect.causes import Cause
from core.inspect.results import Contribution, Face, GaugeResult
from core.inspect.shown.shown_scan import DEPTH, HEIGHT, LOWER, UPPER, InspectionView, Relief, ShownMesh
from core.messages import plain
from core.model import LightPlane
from workbench.pages.inspect.presenter import InspectPresenter

POINTS = 600
SIZE = (64, 48)
RECORDING = "recordings/scan-1"
PICTURES = ("scan/reference.png", "scan/frame0000.png", "scan/frame0001.png")
UPPER_OUTLINE = np.array([[20.0, 15.0], [40.0, 15.0], [40.0, 30.0], [20.0, 30.0]])
LOWER_OUTLINE = np.array([[5.0, 5.0], [60.0, 5.0], [60.0, 44.0], [5.0, 44.0]])
AT = datetime(2025, 3, 4, 10, 30, tzinfo=UTC)


def project(**gauge: Any) -> Project:
    """A project with a recording; nominal value and tolerance as given."""
    made = new_project("block")
    spec = GaugeSpec(**gauge) if gauge else None
    return replace(made, rig=replace(made.rig, gauge=spec), sources=replace(made.sources, scan=RECORDING))


def results(made: Project, *, inspected: bool = True) -> dict[str, Done]:
    """A finished scan, and its thickness."""
    done = {"scan": finished("scan", made, {}, AT)}
    if inspected:
        done["gauge"] = finished("gauge", made, done, AT)
    return done


def gauge(thickness_mm: float = 50.012, **more: Any) -> GaugeResult:
    """Half of the points on either face."""
    upper, lower = np.arange(0, POINTS, 2), np.arange(1, POINTS, 2)
    over, below = (
        Face(LightPlane.from_normal([0.0, 0.0, 1.0], depth), indices, np.zeros(len(indices)), flatness, 0.01)
        for indices, depth, flatness in ((upper, 500.0, 0.031), (lower, 550.0, 0.042))
    )
    return GaugeResult(
        thickness_mm, 0.012, 2.0, over, below, 0.0005, (Contribution(Cause.CAMERA, 0.002),), 50.0, 0.2,
        np.array([0.0, 0.0, 1.0]), plain("distance of two parallel planes"), **({"doubts": ()} | more),
    )  # fmt: skip


def view(measured: GaugeResult | None = None, *, mesh: bool = True) -> InspectionView:
    """The block's points, every other one on the upper face, σ rising from 0.01 to 0.05 mm."""
    rng = np.random.default_rng(3)
    number = np.arange(POINTS)
    flat = rng.uniform(-30, 30, (POINTS, 2))
    depth = np.where(number % 2, 550.0, 500.0)
    none = np.full(POINTS, np.nan, np.float32)
    sigma = np.linspace(0.01, 0.05, POINTS).astype(np.float32)
    return InspectionView(
        points=np.column_stack([flat, depth]),
        normals=np.tile(np.array([0, 0, -1], np.float32), (POINTS, 1)),
        number=number[::-1].astype(np.int32),
        uv=rng.uniform(5, 40, (POINTS, 2)).astype(np.float32),
        sigma=sigma,
        height=(depth if measured is None else 550.0 - depth).astype(np.float32),
        height_is=DEPTH if measured is None else HEIGHT,
        deviation=none if measured is None else np.zeros(POINTS, np.float32),
        face=np.zeros(POINTS, np.int8) if measured is None else np.where(number % 2, LOWER, UPPER).astype(np.int8),
        frame=np.where(number % 3, 1 + number % 2, np.nan).astype(np.float32),
        frames=PICTURES[1:],
        ranges={"sigma": (0.0, 0.05), "height": (0.0, 50.0), "deviation": (-0.1, 0.1), "frame": (1.0, 2.0)},
        mesh=_mesh() if mesh else None,
        gauge=measured,
        outlines=None if measured is None else (UPPER_OUTLINE, LOWER_OUTLINE),
        next_pair=None,
        used_uv=None if measured is None else (UPPER_OUTLINE + 1, LOWER_OUTLINE + 1),
        relief=Relief(np.full(SIZE[::-1], 90, np.uint8), 1.0),
        image_size=SIZE,
        pictures=PICTURES,
        shown=PICTURES[1],
        calibration_id="cal-1",
    )


def _mesh() -> ShownMesh:
    corners = np.array([[0.0, 0, 500], [10, 0, 500], [0, 10, 500], [10, 10, 500]])
    values = np.array([0.01, 0.02, 0.03, 0.04], np.float32)
    return ShownMesh(corners, values, values, values, np.array([[0, 1, 2], [1, 2, 3]]), values[2:])


def repeat(number: int, thickness_mm: float, *, calibration: str = "cal-1") -> Repeat:
    """A repeat of another scan."""
    return Repeat(f"recordings/scan-{number}", thickness_mm, 0.024, 2.0, calibration, AT)


def entered(bench, folder, project, qtbot) -> InspectPresenter:
    """The Inspect page's presenter, with a measured `project` in `folder` shown."""
    made = InspectPresenter(bench)
    bench.model.create(folder, project)
    for step, done in results(made.project).items():
        made.model.record(step, done)
    made.entered()
    qtbot.waitUntil(lambda: made.scan.view is not None and not made.scan.stale)
    return made
