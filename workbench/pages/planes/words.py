"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

from collections.abc import Sequence

from core.calibrate.results import FanCalibration, PlanePose
from core.findings.table import without_notes_on
from core.report.facts.of_planes import planes_sentences, told_of_pose
from workbench.language import sentence, text_of, tr


def verdict_sentence(calibration: FanCalibration | None) -> str:
    """Whether the laser is the pencil it is said to be, and what was moved since, a sentence a line."""
    return "\n".join(map(text_of, planes_sentences(calibration))) if calibration is not None else ""


def notes(calibration: FanCalibration | None) -> str:
    """What else is to be said of a calibration, a sentence a line; the poses left out are listed by themselves."""
    if calibration is None:
        return ""
    shown = without_notes_on("poses", calibration.told)
    return "\n".join(text_of(note) if note.is_sentence else sentence(text_of(note)) for note in shown)


def short_names(names: Sequence[str]) -> list[str]:
    """Only the numbers of names that differ by nothing else, for where there is little room: 00 for pose00."""
    words = {name.rstrip("0123456789") for name in names}
    numbered = len(words) == 1 and not words & set(names)
    return [name.removeprefix(*words) for name in names] if numbered else list(names)


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """What is to be said of one pose; of one that is in no calibration, the `reason` by its pictures."""
    if pose is not None:
        return text_of(told_of_pose(pose))
    return tr("{name}: left out ({reason})", name=name, reason=reason) if reason else name
