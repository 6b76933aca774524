"""How far the report is, what can be made and what can be handed over, told by plain facts."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from core.files.results.export_list import exports
from workbench.reasons import first, why


class Stage(StrEnum):
    """Stage of the report."""

    NONE = "none"
    READY = "ready"
    MAKING = "making"
    MADE = "made"
    OUTDATED = "outdated"


class WhyNot(StrEnum):
    """Reason why an action is not possible now; "": it is."""

    NOTHING = ""
    MAKING = "making"
    NO_SCAN = "no scan"
    NO_CAMERA = "no camera"
    NO_THICKNESS = "no thickness"
    READ_ONLY = "read-only"


class Facts(NamedTuple):
    """Facts from which the stage follows; `camera` to `report`: there is such a result."""

    camera: bool
    scan: bool
    thickness: bool
    features: bool
    report: bool
    outdated: bool
    """The report is not what the project would give now."""
    making: bool
    read_only: bool
    """The project cannot be written to."""


def stage_of(facts: Facts) -> Stage:
    """Derive how far the report is (`Stage`) from which results there are."""
    if facts.making:
        return Stage.MAKING
    if not facts.scan:
        return Stage.NONE
    if not facts.report:
        return Stage.READY
    return Stage.OUTDATED if facts.outdated else Stage.MADE


def why_not_make(facts: Facts) -> WhyNot:
    """Return the reason why the report cannot be stored in the project's results; `WhyNot` "" if it can."""
    reason = first(
        why(facts.making, WhyNot.MAKING),
        why(not facts.scan, WhyNot.NO_SCAN),
        why(facts.read_only, WhyNot.READ_ONLY),
    )
    return WhyNot(reason)


def why_not_export(facts: Facts, kind: str) -> WhyNot:
    """Return the reason why an export of this kind is not possible; `WhyNot` "" if it is."""
    needs = exports()[kind].needs
    if needs == "camera":
        return WhyNot.NOTHING if facts.camera else WhyNot.NO_CAMERA
    if not facts.scan:
        return WhyNot.NO_SCAN
    if kind == "pdf" and facts.making:
        return WhyNot.MAKING
    measured = facts.thickness or (facts.features and kind != "json")
    return WhyNot.NO_THICKNESS if needs == "gauge" and not measured else WhyNot.NOTHING
