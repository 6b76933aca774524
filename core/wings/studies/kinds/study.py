"""The kinds of study, and what each is called."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, TypeAlias

from core.messages import label
from core.wings.studies.kinds.acceptance import AcceptanceCheck
from core.wings.studies.kinds.grr import GrrStudy
from core.wings.studies.kinds.repeats import RepeatStudy
from core.wings.studies.kinds.series import SeriesStudy
from core.wings.studies.kinds.type1 import Type1Study

Study: TypeAlias = RepeatStudy | Type1Study | GrrStudy | AcceptanceCheck | SeriesStudy
InOrder: TypeAlias = RepeatStudy | Type1Study | SeriesStudy
"""Those whose `values` (n,) stand in the order of measuring."""
Kind: TypeAlias = Literal["repeats", "type1", "grr", "acceptance", "series"]

KINDS: Mapping[str, str] = {
    "repeats": label("Repeats"),
    "type1": label("Type-1 study"),
    "grr": label("Gauge R&R"),
    "acceptance": label("Acceptance check"),
    "series": label("Series"),
}
"""What each kind is called, by its key in files."""


def kind_of(study: Study) -> Kind:
    """Return the key of a study's kind: "repeats", "type1", "grr", "acceptance" or "series"."""
    match study:
        case RepeatStudy():
            return "repeats"
        case Type1Study():
            return "type1"
        case GrrStudy():
            return "grr"
        case AcceptanceCheck():
            return "acceptance"
        case SeriesStudy():
            return "series"
