"""The target of a calibration: as the fields of a form and back, changed by the user, printed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from PySide6.QtCore import QObject, Signal

from core.calibrate.board_shape import MADE, BoardTolerance
from core.image.targets import BlackSquare, Charuco, Checkerboard, CircleGrid, Rectangle, Target
from core.image.targets.kinds import DICTIONARIES, USUAL, USUAL_MARKER
from core.inspect.uncertainty.part import SUSPECTED_CELSIUS, Part, TargetTemperature
from workbench.bench import Bench
from workbench.language import text_of, tr
from workbench.work import jobs

PAPERS = ("A4", "A3", "A2", "Letter", "Tabloid")
"""What a target can be printed on (core.report.target_sheet.PAPER_MM)."""


def values_of(target: Target) -> dict[str, Any]:
    """Convert a calibration target to the fields of the form: kind, columns, rows, sizes."""
    match target:
        case Checkerboard():
            return {
                "kind": "checkerboard",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.square_mm,
            }
        case Charuco():
            return {
                "kind": "charuco",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.square_mm,
                "marker_mm": target.marker_mm,
                "dictionary": target.dictionary_id,
            }
        case CircleGrid():
            return {
                "kind": "circle_grid",
                "columns": target.columns,
                "rows": target.rows,
                "size_mm": target.pitch_mm,
                "asymmetric": target.asymmetric,
            }
        case BlackSquare():
            return {"kind": "black_square", "size_mm": target.side_mm}
        case Rectangle():
            raise ValueError("no target of a calibration is a rectangle")


def target_of(values: Mapping[str, Any]) -> Target:
    """Convert the fields of the form to a calibration target; ValueError, a sentence, if there is no such target."""
    columns, rows, size = int(values.get("columns", 0)), int(values.get("rows", 0)), float(values["size_mm"])
    match values["kind"]:
        case "checkerboard":
            return Checkerboard(columns, rows, size)
        case "charuco":
            return Charuco(columns, rows, size, float(values["marker_mm"]), str(values["dictionary"]))
        case "circle_grid":
            return CircleGrid(columns, rows, size, bool(values["asymmetric"]))
        case "black_square":
            return BlackSquare(size)
    raise ValueError(f"{values['kind']!r} is no kind of target")


def changed_target(target: Target, field: str, value: Any) -> Target:
    """Change one field of a target; for another "kind", usual sizes. ValueError if there is no such target."""
    values = values_of(target)
    if field != "kind":
        return target_of({**values, field: value})
    if value == values["kind"]:
        return target
    columns, rows, size = USUAL[value]
    usual = {"kind": value, "columns": columns, "rows": rows, "size_mm": size}
    return target_of({**usual, "marker_mm": USUAL_MARKER * size, "dictionary": DICTIONARIES[0], "asymmetric": False})


MADE_FIELDS = ("made", "size_per_mille", "flatness_mm")
"""Fields that say how true a target is."""


WARM_FIELDS = ("celsius", "u_celsius")
"""Fields that say how warm the plane target was in its pictures."""
USUAL_U = 0.5
"""u in K of a temperature that was just entered."""


def values_of_tolerance(tolerance: BoardTolerance) -> dict[str, Any]:
    """Convert a target's tolerance to the fields of the form; "made" is "" if nothing is stated."""
    usual = next((name for name, one in MADE.items() if one == tolerance), "stated")
    scale = tolerance.scale_sd
    return {
        "made": "" if tolerance == BoardTolerance() else usual,
        "size_per_mille": None if scale is None else round(scale * 1e3, 9),
        "flatness_mm": tolerance.flatness_mm,
    }


def changed_tolerance(tolerance: BoardTolerance, field: str, value: Any) -> BoardTolerance:
    """Change one field of a target's tolerance: "made", the size's error in ‰, or the flatness in mm."""
    match field:
        case "made":
            return tolerance if value == "stated" else MADE.get(value, BoardTolerance())
        case "size_per_mille":
            return replace(tolerance, scale_sd=None if value is None else value / 1e3)
    return replace(tolerance, flatness_mm=value)


class TargetChoice(QObject):
    """Choice of the target of the rig that is named by `which`; `label` names the edit in the undo list."""

    target_refused = Signal(str, str)
    """Field and why it cannot be so; an empty sentence if it can."""

    def __init__(
        self, bench: Bench, which: Literal["camera_target", "plane_target"], label: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._bench, self._model, self._which, self._label = bench, bench.model, which, label
        self._board = {"camera_target": "camera_board", "plane_target": "plane_board"}[which]

    @property
    def target(self) -> Target:
        """Calibration target of this step in the project."""
        target: Target = getattr(self._model.project.rig, self._which)
        return target

    def target_values(self) -> dict[str, Any]:
        """Return the target and its tolerance as the fields of the form."""
        rig = self._model.project.rig
        values = values_of(self.target) | values_of_tolerance(getattr(rig, self._board))
        if self._which != "plane_target":
            return values
        warm = {name: getattr(rig.part.target, name) for name in WARM_FIELDS}
        return values | {"margin_mm": rig.plane_margin_mm} | warm

    def set_target(self, field: str, value: Any) -> None:
        """Change one field of the target or its tolerance; undoable. `target_refused` says why if impossible."""
        try:
            changed = self._changed(field, value)
        except ValueError as error:
            self.target_refused.emit(field, text_of(error))
            return
        self.target_refused.emit(field, "")
        project = self._model.project
        after = replace(project, rig=replace(project.rig, **changed))
        self._model.edit(self._label, after, f"{self._which} {field}")

    def take_counted(self, columns: int, rows: int) -> None:
        """Set the target's columns and rows to those counted in the pictures; undoable."""
        target = changed_target(changed_target(self.target, "columns", columns), "rows", rows)
        changed: dict[str, Any] = {self._which: target}
        project = self._model.project
        self._model.edit(self._label, replace(project, rig=replace(project.rig, **changed)))

    def _changed(self, field: str, value: Any) -> dict[str, Any]:
        """Fields of the rig that change; ValueError as `changed_target`."""
        if field == "margin_mm":
            return {"plane_margin_mm": value}
        if field in WARM_FIELDS:
            return {"part": self._warm(field, value)}
        if field in MADE_FIELDS:
            return {self._board: changed_tolerance(getattr(self._model.project.rig, self._board), field, value)}
        changed: dict[str, Any] = {self._which: changed_target(self.target, field, value)}
        if field == "kind" and value != self.target_values()["kind"]:
            changed[self._board] = BoardTolerance()
            if self._which == "plane_target":
                part = replace(self._model.project.rig.part, target=TargetTemperature())
                changed |= {"plane_margin_mm": None, "part": part}
        return changed

    def _warm(self, field: str, value: float | None) -> Part:
        """The part with the target's temperature changed; that and its uncertainty come and go together."""
        part = self._model.project.rig.part
        warm = part.target
        match field:
            case _ if value is None:
                warm = replace(warm, celsius=None, u_celsius=None)
            case "celsius":
                warm = replace(warm, celsius=value, u_celsius=USUAL_U if warm.u_celsius is None else warm.u_celsius)
            case _:
                warm = replace(
                    warm, celsius=SUSPECTED_CELSIUS if warm.celsius is None else warm.celsius, u_celsius=value
                )
        return replace(part, target=warm)

    def print_target(self, path: Path, paper: str) -> None:
        """Write a PDF with the target to scale on `paper` to `path`, in the background."""
        self._bench.run_quick(
            self,
            jobs.TARGET_SHEET,
            path,
            self.target,
            paper,
            self._model.project.info.name,
            label=tr("Drawing the target"),
            on_done=lambda done: self._bench.notices.info(
                tr("The target was written to {path}. Print it at 100 % and measure its rulers.", path=done)
            ),
        )
