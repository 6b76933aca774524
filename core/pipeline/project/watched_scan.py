"""Measuring a recording, and being told of every frame what a live scan would tell."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from core.files.project.data import Project
from core.files.project.results import ScanSummary
from core.image.stripes.centreline import Centreline
from core.pipeline.live.events import ScanDetail
from core.pipeline.project.calibration import accepted_camera
from core.pipeline.project.measuring import measure_scan
from core.pipeline.steps.scan.surface import get_ready
from core.pipeline.taken_over import MAKES_SURFACES
from core.progress import Progress, silent
from core.scan.preview.shown import FramePreview, cloud_of
from core.scan.surface.coverage_map import CoverageMap
from core.second_process import second_process

Watch = Callable[[ScanDetail], None]


def measure_watched(
    folder: Path, project: Project, progress: Progress = silent, watch: Watch | None = None
) -> ScanSummary:
    """Measure a project's scan and call `watch` for each frame, in order, on this thread, with what is seen so far.

    Raises
    ------
    InputError
        As `measure_scan`.
    """
    watching = None if watch is None else WatchReporter(accepted_camera(folder, project).image_size, watch)
    with second_process(MAKES_SURFACES) as beside:  # it starts while the network is solved
        if beside is not None:
            beside.submit(get_ready, None)  # meanwhile, too
        return measure_scan(folder, project, progress, watching, beside=beside)


class WatchReporter:
    """Reporter that adds up points and coverage of a scan frame by frame, and calls `watch` with the state so far."""

    def __init__(self, image_size: tuple[int, int], watch: Watch) -> None:
        self._watch, self._coverage = watch, CoverageMap(image_size)
        self._fan_lines: tuple[tuple[Centreline, ...], ...] = ()

    def __call__(self, preview: FramePreview) -> None:
        """The next frame."""
        coverage, renewed = self._coverage, preview.renewed
        points = cloud_of(preview) if renewed is None else renewed
        if preview.fan_lines is not None:
            self._fan_lines = preview.fan_lines
        for piece in preview.centrelines:
            coverage.add_lit(piece.uv)
        coverage.add(points.uv)
        self._watch(
            ScanDetail(
                index=preview.index,
                stage="scanning",
                preview=replace(preview, renewed=None, fan_lines=None),
                fan_lines=self._fan_lines,
                cells=coverage.cells.copy(),
                lit=coverage.lit.copy(),
                share=coverage.share,
                points=points,
                renewed=renewed is not None,
            )
        )
