"""The picture of the scan page: a frame as it comes, or one frame in one of its stages."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import Any

import numpy as np
from PySide6.QtWidgets import QWidget

from core.image.stripes.centreline import Centreline
from core.pipeline.live.events import LiveView, PlanesDetail, ScanDetail
from workbench.language import tr
from workbench.pages.scan import overlays, words
from workbench.pages.scan.presenter import ScanPresenter
from workbench.views.forms.source_chooser import NextAction
from workbench.views.image.view import ImageView
from workbench.views.layouts import in_column


class View(StrEnum):
    """Stage of a frame that can be shown, in the order of processing."""

    RECORDED = "recorded"
    DIFFERENCE = "difference"
    RIDGE = "ridge"
    CENTRELINES = "centrelines"
    CROSSINGS = "crossings"
    POINTS = "points"


class ScanPicture(QWidget):
    """Picture of the scan: live, of a recording that is measured, or of one frame."""

    def __init__(
        self, presenter: ScanPresenter, next_action: Callable[[], NextAction], parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._presenter, self._next_action = presenter, next_action
        self._shown: Any = None
        self._fan: tuple[Any, bool] | None = None
        self._said: tuple[str, NextAction | None] = "", None
        self.image, self.wanted = ImageView(), View.CROSSINGS
        self.image.setAccessibleName(tr("Picture of the scan"))
        in_column(self.image, on=self)
        nothing = np.zeros((1, 1), np.bool_)
        overlays.show_coverage(self.image, nothing, nothing)  # the first layers are the lowest
        for live in (presenter.live, presenter.check_live):
            live.notice.connect(self.image.announce)

    def refresh(self) -> None:
        """Show the chosen frame in the chosen stage, or a sentence if there is none."""
        p = self._presenter
        running = next((live for live in (p.live, p.check_live) if live.running), None)
        if running is not None:
            if self._shown not in ("live", "check") and not running.live:
                self._clear(running.state_text())
        elif p.scrubbing:
            self._show_frame()
        elif not p.run.measuring and p.work.frames is not None:  # while they are listed, the last picture stands
            self._empty()

    def show_view(self, view: View) -> None:
        """Show the current frame in another stage of its processing."""
        self.wanted = view
        self._shown = None
        self.refresh()

    def show_live(self, view: LiveView) -> None:
        """Show a live picture with the stripes found in it."""
        self._begin("live")
        self.image.set_picture(view.picture, scale=view.scale)
        if isinstance(view.detail, ScanDetail):
            self._show_detail(view.detail)

    def show_check(self, view: LiveView) -> None:
        """Show a live picture of the interim check, with the plane target and the stripes on it."""
        self._begin("check")
        self.image.set_picture(view.picture, scale=view.scale)
        if isinstance(view.detail, PlanesDetail):
            overlays.show_target(self.image, view.detail)

    def show_measured(self, detail: ScanDetail, picture: Any, scale: int) -> None:
        """Show a frame that is being measured, with its stripes; the picture is reduced by `scale`."""
        self._begin("measured")
        self.image.set_picture(picture, scale=scale)
        self._show_detail(detail)

    def _show_detail(self, detail: ScanDetail) -> None:
        p, preview = self._presenter, detail.preview
        calibrated = p.calibrated and p.has_fan  # without one a frame by itself gives no points
        if p.has_fan:
            overlays.show_coverage(self.image, detail.cells, detail.lit)
        self._show_fan(detail.fan_lines, numbered=calibrated)
        pieces = preview.centrelines if preview is not None and detail.stage == "scanning" else ()
        overlays.show_sweep(
            self.image, pieces, preview.sigma_mm if preview is not None and calibrated and pieces else ()
        )
        if calibrated:
            overlays.show_crossings(self.image, preview if pieces else None)

    def _show_fan(self, lines: Sequence[Sequence[Centreline]], *, numbered: bool) -> None:
        """The fan's lines, if they are not there already: they come with every frame, and hardly ever change."""
        uv = [[piece.uv for piece in line] for line in lines]
        if self._fan is None or self._fan[1] != numbered or not _same(self._fan[0], uv):
            overlays.show_fan(self.image, lines, numbered=numbered)
            self._fan = uv, numbered

    def _show_frame(self) -> None:
        scrub = self._presenter.scrub
        stages, points = scrub.stages, self._presenter.points_of_frame()
        if stages is None:
            self._clear(scrub.problem or tr("The frame is being looked at …"))
            return
        planes = self._presenter.work.known_planes()
        wanted = (stages, self.wanted, points[0] is not None, tuple(planes))
        if self._shown == wanted:
            return
        self._begin("frame")
        self._shown = wanted
        shown = {View.DIFFERENCE: stages.difference, View.RIDGE: stages.ridge}
        self.image.set_picture(shown.get(self.wanted, stages.picture))
        place = list(View).index(self.wanted)
        self.image.clear_layers()
        overlays.show_known_planes(self.image, planes)
        if place >= list(View).index(View.CENTRELINES):
            overlays.show_fan_pieces(self.image, stages.fan, stages.fan_line)
            overlays.show_swept(self.image, stages.sweep, stages.bounced)
        if self.wanted is View.CROSSINGS:
            overlays.show_crossings(self.image, stages.seen)
        if self.wanted is View.POINTS:
            overlays.show_points(self.image, *points, self._presenter.largest_sigma_mm)

    def _begin(self, kind: str) -> None:
        """Layers of another kind of picture are no longer true."""
        before = self._shown if isinstance(self._shown, str) else "frame"
        if before != kind:
            self.image.clear_layers()
            self._fan = None
        self._shown = kind

    def _empty(self) -> None:
        how = tr("Record a scan with a live source, or choose the folder of a recording (or drop one here).")
        can = self._presenter.has_fan or self._presenter.boards
        self._clear(how if can else tr(words.NO_LIVE_SCAN), self._next_action())

    def _clear(self, message: str, next_action: NextAction | None = None) -> None:
        self._shown = self._fan = None
        said = message, next_action
        if self.image.has_picture or self._said != said:
            self._said = said
            self.image.clear(message, *(next_action or ()))


def _same(before: Sequence[Sequence[Any]], now: Sequence[Sequence[Any]]) -> bool:
    """Whether arrays in two lists of lists are equal, one by one."""
    return [len(line) for line in before] == [len(line) for line in now] and all(
        np.array_equal(a, b) for one, other in zip(before, now, strict=True) for a, b in zip(one, other, strict=True)
    )
