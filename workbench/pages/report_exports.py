"""What can be handed over: the kinds of `core.pipeline.export_kinds`, without the libraries that write them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Export:
    """How its file ends, what it is made from, and what its name says beside the part's."""

    ending: str
    needs: Literal["camera", "scan", "inspect"]
    called: str = ""


EXPORTS: dict[str, Export] = {
    "pdf": Export(".pdf", "scan"),
    "cloud": Export(".ply", "scan"),
    "e57": Export(".e57", "scan"),
    "csv": Export(".csv", "scan"),
    "mesh": Export(".ply", "scan", "surface"),
    "stl": Export(".stl", "scan"),
    "obj": Export(".obj", "scan"),
    "3mf": Export(".3mf", "scan"),
    "table": Export(".csv", "inspect", "results"),
    "xlsx": Export(".xlsx", "inspect", "results"),
    "results": Export(".json", "inspect", "results"),
    "dfq": Export(".dfq", "inspect", "results"),
    "qif": Export(".qif", "inspect", "results"),
    "json": Export(".json", "inspect", "thickness"),
    "opencv": Export(".yml", "camera", "camera"),
    "opencv-json": Export(".json", "camera", "camera"),
    "ros": Export(".yaml", "camera", "camera"),
}
"""By name, in the order in which they are offered."""

AT_HAND = ("pdf", "cloud", "csv", "stl", "xlsx", "json")
"""Those with a button of their own; the others are in a menu."""
