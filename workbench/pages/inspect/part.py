"""What the project states of the part, as fields of a form: its material, its surface and its temperature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from core.inspect.uncertainty.part import Part
from core.messages import label
from workbench.language import tr
from workbench.project_model import ProjectModel

MATERIAL_NAMES: Mapping[str, str] = {
    "metal": label("Metal"),
    "steel": label("Steel"),
    "aluminium": label("Aluminium"),
    "ceramic": label("Ceramic"),
    "plastic": label("Plastic"),
    "wax": label("Wax"),
    "sprayed": label("Sprayed, of any material"),
}
"""The materials of `core.inspect.uncertainty.part`, as they are shown."""
WITH_U: Mapping[str, tuple[str, float]] = {
    "celsius": ("u_celsius", 0.5),
    "offset_mm": ("offset_sd_mm", 0.01),
    "spray_mm": ("spray_sd_mm", 0.005),
}
"""The standard uncertainty that goes with an estimate, and what stands there at first."""


class InspectPart:
    """Part of the project's rig; each change is undoable."""

    def __init__(self, model: ProjectModel) -> None:
        self._model = model

    @property
    def part(self) -> Part:
        """Statements on the part in the project's rig."""
        return self._model.project.rig.part

    def values(self) -> dict[str, Any]:
        """Return the statements on the part as the fields of a form; None where nothing is stated."""
        pairs = {key: getattr(self.part, key) for key in WITH_U}
        pairs |= {u: getattr(self.part, u) for u, _ in WITH_U.values()}
        return {"material": self.part.material or "", **pairs}

    def set_value(self, key: str, value: Any) -> None:
        """Change one statement on the part; undoable. A value and its uncertainty are cleared together."""
        if key == "material":
            changed: dict[str, Any] = {key: value or None}
        else:
            estimate, (u, usual) = next(pair for pair in WITH_U.items() if key in (pair[0], pair[1][0]))
            changed = {key: None if value is None else float(value)}
            if value is None:
                changed = dict.fromkeys((estimate, u))
            elif key == estimate and getattr(self.part, u) is None:
                changed[u] = usual
            elif key == u and getattr(self.part, estimate) is None:
                changed[estimate] = 20.0 if estimate == "celsius" else 0.0
        rig = self._model.project.rig
        after = replace(self._model.project, rig=replace(rig, part=replace(self.part, **changed)))
        self._model.edit(tr("change what is known of the part"), after, f"part {key}")
