"""Scans made by hand: what jobs of the scan page would give, at once and without pictures worth measuring."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.files.project.results import ScanSummary
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.messages import plain
from core.pipeline.live.events import LiveView, ScanDetail, ScanStage
from core.scan.features.frames import FrameRecord
from core.scan.preview.shown import FramePreview, FrameStages, PreviewCloud, ShownScan

FRAMES = 6
SIZE = (64, 48)
UNCERTAIN = "its light plane is too uncertain for any point to pass the σ cut"
WEAK = "Weak: it crosses line 2 of the fan at 20° only."


def name_of(number: int) -> str:
    return f"scan/frame{number:04d}.png"


def line(u0: float, u1: float, v: float) -> Centreline:
    u = np.arange(u0, u1)
    ones = np.ones(len(u))
    return Centreline(
        np.column_stack([u, np.full(len(u), v)]), np.tile([0.0, 1.0], (len(u), 1)), ones, 90 * ones, 0.1 * ones,
        np.zeros(len(u), bool),
    )  # fmt: skip


def records() -> tuple[FrameRecord, ...]:
    used = [
        FrameRecord(n, name_of(n), True, None, 2, 60, 3, 3, 20, 1, 120.0, 100 * (n + 1), 0.01 * (n + 1))
        for n in range(FRAMES - 1)
    ]
    return (*used, FrameRecord(FRAMES - 1, name_of(FRAMES - 1), False, plain(UNCERTAIN)))


def look(points: int = 1500) -> ShownScan:
    rng = np.random.default_rng(1)
    frames = records()
    return ShownScan(
        points=rng.normal(0, 20, (points, 3)).astype(np.float32) + np.array([0, 0, 600], np.float32),
        sigma=np.full(points, 0.02, np.float32),
        uv=np.column_stack([np.arange(points) % SIZE[0], np.full(points, 20)]).astype(np.float32),
        frame=(np.arange(points) % FRAMES).astype(np.int32),
        triangles=2800,
        frames=frames,
        frames_used=FRAMES - 1,
        median_sigma_mm=0.021,
        sigma_95_mm=0.048,
        share=0.63,
        stripe=StripeSettings(5.9, 91.5),
        notes=(plain("The relief fixes the scale well."),),
        problems=(),
    )


def summary(*, gauge: Any = True) -> ScanSummary:
    no_gauge = None if gauge else plain("There are no two parallel faces")
    return ScanSummary(records(), 1500, 2800, gauge, no_gauge, (), "cal", {})


def preview(number: int, *, condition: float = 120.0, hints: tuple[str, ...] = ()) -> FramePreview:
    pieces = (line(4, 60, 10.0 + number),)
    points = np.random.default_rng(number).normal(0, 20, (30, 3)) + [0, 0, 600]
    return FramePreview(
        index=number,
        name=name_of(number),
        centrelines=pieces,
        sigma_mm=tuple(np.full(len(piece), 0.05) for piece in pieces),
        crossing_uv=np.array([[10.0, 12.0], [30.0, 12.0], [50.0, 12.0]]),
        crossing_status=np.array([0, 1, 2], np.int8),
        crossing_reason=tuple(
            map(plain, ("Good: it crosses line 1 of the fan at 80°.", WEAK, "Left out: the lines bend too much here."))
        ),
        condition=condition,
        speed_px=1.0,
        points=points,
        point_sigma=np.full(30, 0.05),
        point_intensity=np.full(30, 90.0),
        point_uv=np.full((30, 2), 12.0),
        hints=tuple(map(plain, hints)),
        exclusion=None,
    )


def detail(number: int, *, stage: ScanStage = "scanning", renewed: bool = False, **more: Any) -> ScanDetail:
    seen = preview(number, **more)
    cells = np.zeros((6, 8), bool)
    cells[: number + 1] = True
    none = np.zeros(len(seen.points), np.float32)
    points = PreviewCloud(
        seen.points.astype(np.float32), seen.point_sigma.astype(np.float32), none,
        seen.point_uv.astype(np.float32), np.full(len(none), number, np.int32),
    )  # fmt: skip
    fan = tuple((line(2, 62, 8.0 + 10 * k),) for k in range(3))
    return ScanDetail(number, stage, seen, fan, cells, np.ones((6, 8), bool), 0.63, points, renewed)


def live_view(number: int, **more: Any) -> LiveView:
    picture = np.full((SIZE[1] // 2, SIZE[0] // 2), 40, np.uint8)
    return LiveView(picture, 2, number, 20.0, number + 1, 0, detail(number, **more))


def stages(name: str, *, calibrated: bool = True) -> FrameStages:
    number = int(name[-8:-4])
    picture, difference, ridge = (np.full(SIZE[::-1], level, np.uint8) for level in (40, 80, 120))
    return FrameStages(
        number, name, picture, difference, ridge, 1.7,
        (line(4, 60, 10.0 + number),), (line(2, 62, 8.0), line(2, 62, 18.0)), (0, -1),
        preview(number) if calibrated else None, 0.0, False, None,
    )  # fmt: skip
