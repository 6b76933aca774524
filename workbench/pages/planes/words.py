"""What the laser planes page says: numbers with units as rows and sentences. Formats only; computes nothing."""

from __future__ import annotations

from collections.abc import Sequence

from core.calibrate.results import FanCalibration, PlanePose
from core.findings.table import without_notes_on
from core.report.facts.of_planes import planes_sentences, sentence_on_pose
from workbench.language import sentence, text_of, tr


def verdict_sentence(calibration: FanCalibration | None) -> str:
    """Write whether the laser is the stated pencil, and what a re-adjustment has moved, one sentence a line."""
    return "\n".join(map(text_of, planes_sentences(calibration))) if calibration is not None else ""


def notes(calibration: FanCalibration | None) -> str:
    """Write the notes on a calibration of the planes, one sentence a line, without those on poses left out."""
    if calibration is None:
        return ""
    shown = without_notes_on("poses", calibration.all_notes)
    return "\n".join(text_of(note) if note.is_sentence else sentence(text_of(note)) for note in shown)


def short_names(names: Sequence[str]) -> list[str]:
    """Shorten names that differ only in their numbers to the numbers: "00" for "pose00"."""
    words = {name.rstrip("0123456789") for name in names}
    numbered = len(words) == 1 and not words & set(names)
    return [name.removeprefix(*words) for name in names] if numbered else list(names)


def pose_sentence(name: str, pose: PlanePose | None, reason: str = "") -> str:
    """Write the sentence on one pose: its fit, or why it is left out; without a calibration, `reason`."""
    if pose is not None:
        return text_of(sentence_on_pose(pose))
    return tr("{name}: left out ({reason})", name=name, reason=reason) if reason else name
