"""The scan a plan will give: the stripes of all sweeps on a block, as features for the real solver."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from core.image.exclusion import Exclusion
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import CONTRAST_QUANTILE, WIDTH_IN_SIGMA, StripeSettings
from core.messages import Message
from core.model import Camera
from core.progress import Progress, silent, steps
from core.scan.features.extraction import FrameFeatures, ScanFeatures, gather
from core.simulate.rig import Rig
from core.simulate.scan import LAMP
from core.simulate.scene.image import generator
from core.simulate.scene.laser import Sheet, fan_sheets
from core.simulate.scene.scene import Scene
from core.wings.rig_planning.prediction.boards import board_triangles, lines_on_boards
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.light_lines import FlatFace, LitLine, faces_of, lit_lines
from core.wings.rig_planning.prediction.seen_stripes import SeenStripes


def plan_scan(design: Design, height_mm: float, seed: int, progress: Progress = silent) -> ScanFeatures:
    """Simulate what the stripe extraction finds in a scan of a block of `height_mm`, by the random `seed`.

    Raises
    ------
    PlanError
        If the camera would see no stripe of a fan that is there, or of the hand-held laser.
    """
    stage = Stage(design, height_mm)
    lit_by_fan = fan_sheets(stage.rig, design.work_point) if design.has_fan else ()
    fan_lines = stage.lines(lit_by_fan, SeenStripes.of_fan(design))
    sheets = design.sweeps_over(stage.scene, seed)
    hand = SeenStripes.of_hand(design)
    sweep_lines = [stage.lines([sheet], hand) for sheet in steps(sheets, progress, "stripes", len(sheets))]
    every = [line for lines in sweep_lines for line in lines]
    if design.has_fan and not fan_lines:
        raise PlanError(
            Message("plan.fan_not_seen", "the camera would see no stripe of the fan on table and block"),
            where="[plan]",
            todo=Message("plan.advice_check_fan", "check baseline_mm, distance_mm and focal_mm"),
        )
    if not every:
        raise PlanError(
            Message("plan.hand_not_seen", "the camera would see no stripe of the hand-held laser on table and block"),
            where="[plan]",
            todo=Message("plan.advice_check_hand", "check hand_baseline_mm, distance_mm and focal_mm"),
        )
    background = stage.background_grey()
    fan_seen = SeenStripes.of_fan(design).tried(fan_lines, background) if fan_lines else hand
    hand = hand.tried(every, background)
    noise = generator(seed, "scan noise")
    fan = _longest_first(fan_seen.centreline(line, noise) for line in fan_lines)
    frames = [_longest_first(hand.centreline(line, noise) for line in lines) for lines in sweep_lines]
    return gather(
        stage.camera.image_size,
        fan,
        [
            FrameFeatures(index, f"sweep {index + 1}", pieces, None if pieces else Exclusion.WITHOUT_STRIPE)
            for index, pieces in enumerate(frames)
        ],
        (_settings(fan_lines or every), _settings(every)),
        progress=progress,
    )


class Stage:
    """Block under the rig, or another `scene` there, its flat faces listed once: the table first."""

    def __init__(self, design: Design, height_mm: float, scene: Scene | None = None) -> None:
        self.rig: Rig = design.rig()
        self.camera: Camera = self.rig.camera
        self.scene = scene or design.scene(height_mm)
        self._ambient = design.ambient_grey
        self.faces: tuple[FlatFace, ...] = faces_of(self.scene, design.table(), 2 * design.distance_mm)
        self._design, self._occluders = design, self.scene.occluders
        if design.boards:
            self._occluders = np.concatenate([self._occluders, board_triangles(design)])

    def lines(self, sheets: Sequence[Sheet], seen: SeenStripes) -> list[LitLine]:
        """Compute the stripes that the light `sheets` draw on the scene's faces, trimmed as the extraction does."""
        found: list[LitLine] = []
        for sheet in sheets:
            hidden, camera, blur = self._occluders, self.camera, self.rig.blur_px
            found += lit_lines(sheet, self.faces, hidden, camera, blur, seen.filter_px)
            if self._design.boards:
                found += lines_on_boards(self._design, sheet, hidden, camera, blur, seen.filter_px)
        return found

    def background_grey(self) -> float:
        """Compute the mean grey level of table and block in the room's light."""
        lamp = LAMP / np.linalg.norm(LAMP)
        table = self.faces[0]
        top = min(self.faces, key=lambda face: float(face.corners[:, 2].mean()))
        facing = [max(float(face.normal @ lamp), 0.0) * 0.6 + 0.4 for face in (table, top)]
        return self._ambient * float(np.mean([table.albedo * facing[0], top.albedo * facing[1]]))


def _longest_first(pieces: Iterable[Centreline]) -> tuple[Centreline, ...]:
    return tuple(sorted(pieces, key=len, reverse=True))


def _settings(lines: Sequence[LitLine]) -> StripeSettings:
    width = float(np.median(np.concatenate([line.width for line in lines])))
    height = float(np.quantile(np.concatenate([line.height for line in lines]), CONTRAST_QUANTILE))
    return StripeSettings(WIDTH_IN_SIGMA * width, height)
