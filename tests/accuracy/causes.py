"""Precision of causes: what is told of sets with which nothing is wrong, and what is told first where something is.

A note that sends the user to mend what is in order is a false cause. Sets that are unusual and in order, 100 of them,
may have one in 20; of a hostile set, the first cause that is told has to be the true one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from core.simulate.effects.setup import Setup
from tests.accuracy.hostile import OF_EVERY_RIG, Figures
from tests.accuracy.hostile_cases import CAUSES, CHECK_POSES, EFFECTS, TOGETHER, HostileCase, base

BENIGN: Mapping[str, Mapping[str, Any]] = {
    "as usual": {},
    "30 mm": {"height_mm": 30.0},
    "70 mm": {"height_mm": 70.0},
    "100 mm": {"height_mm": 100.0},
    "narrow": {"object": "narrow-block", "height_mm": 40.0},
    "table tilted to the right": {"setup": Setup(table_right_deg=8.0)},
    "table tilted away": {"setup": Setup(table_away_deg=8.0)},
    "fan upright": {"setup": Setup(fan_turned_deg=90.0)},
    "oblique sheets": {"setup": Setup(hand_aside=1.7)},
    "12 frames": {"frames": 12},
    "150 frames": {"frames": 150},
    "dark room": {"ambient_grey": 8.0},
    "bright room": {"ambient_grey": 110.0},
    "blotchy surfaces": {"texture": 0.1},
    "turned on the table": {"yaw_deg": 35.0, "right_mm": 8.0, "away_mm": -6.0},
}
"""Sets that are unusual and in order, by name: fields of a scenario."""
SEEDS = range(301, 308)
"""Of the sets in order; each with a calibration of its own."""
TRUE: Mapping[str, frozenset[str]] = {
    "fan upright": frozenset(
        {"fan.poses_left_out", "check.pose_left_out", "gauge.unsure_and_no_faces", "gauge.too_few_faces"}
    ),
    "12 frames": frozenset({"gauge.few_frames_and_no_faces", "gauge.too_few_faces", "scan.scale_unknown"}),
    "blotchy surfaces": frozenset({"scan.speckled"}),
}
"""Codes that are true of a kind: plates are held as for a fan that lies, and blotches are a grainy surface. At a
quarter of the size most points on the table are less sure than the σ cut under an upright fan: with one of 0.1 mm, as
the refusal asks for, seeds 301 and 302 are measured, −23 ± 116 and −36 ± 122 µm, and conform."""
CLAIMS = frozenset(code for codes in CAUSES.values() for code in codes) - {"part.material_assumed"}
"""Codes that name something that is wrong with rig, room, part or pictures."""
FIRST_SEEDS = range(1, 6)


def benign_cases() -> list[HostileCase]:
    """All benign sets, each with a check of the day, those of one seed after one another."""
    return [
        HostileCase("nothing", kind, replace(base(0.25), seed=seed, check_poses=CHECK_POSES, **fields))
        for seed in SEEDS
        for kind, fields in BENIGN.items()
    ]


def false_causes(kind: str, figures: Figures) -> list[str]:
    """Codes told of a benign set that are told neither of every rig nor rightly of its kind, the gravest first."""
    return [code for code in figures["first"] if code not in OF_EVERY_RIG | TRUE.get(kind, frozenset())]


def benign_table(cases: Sequence[HostileCase], results: Mapping[str, Figures]) -> list[str]:
    """A line for each kind: errors, U, and what was told of how many; and what it comes to."""
    lines = ["| set | errors, µm | U, µm | verdicts | told of it |", "|---|---|---|---|---|"]
    known = [case for case in cases if case.name in results]
    wrong = 0
    for kind in BENIGN:
        mine = [results[case.name] for case in known if case.strength == kind]
        measured = [one for one in mine if "error" in one]
        told: dict[str, int] = {}
        for one in mine:
            causes = false_causes(kind, one)
            wrong += bool(causes)
            for code in causes:
                told[code] = told.get(code, 0) + 1
        errors = ", ".join(f"{1e3 * one['error']:+.0f}" for one in measured)
        widths = [1e3 * one["U"] for one in measured]
        spread = f"{min(widths):.0f}–{max(widths):.0f}" if widths else "–"
        verdicts = ", ".join(sorted({one.get("verdict", "refused") for one in mine}))
        said = ", ".join(f"`{code}` {count} of {len(mine)}" for code, count in sorted(told.items())) or "–"
        lines.append(f"| {kind} | {errors} | {spread} | {verdicts} | {said} |")
    return [*lines, "", f"{len(known)} sets in order: of {wrong} a cause was told (at most 1 in 20 is wanted)."]


def first_cases() -> list[HostileCase]:
    """Each effect at its greatest strength of which no others are part, with a check of the day."""
    return [
        HostileCase(effect.title, label, replace(base(0.25), seed=seed, check_poses=CHECK_POSES, **fields))
        for seed in FIRST_SEEDS
        for effect in EFFECTS
        if effect.title != "nothing" and not {label for label, _ in effect.strengths} & TOGETHER.keys()
        for label, fields in effect.strengths[-1:]
    ]


def first_cause(figures: Figures) -> str:
    """The first code told that claims something; "" if none does."""
    return next((code for code in figures["first"] if code in CLAIMS), "")


def first_table(cases: Sequence[HostileCase], results: Mapping[str, Figures]) -> list[str]:
    """A line for each effect: how often the first cause told is its own, and which others were; and the share.

    Of a scan that is right within half its U, and proves nothing wrong, nothing needs to be told: it is counted apart.
    """
    lines = ["| effect | strength | first cause is the true one | others told first |", "|---|---|---|---|"]
    known = [case for case in cases if case.name in results]
    right = untold = 0
    for title in dict.fromkeys(case.effect for case in known):
        mine = [case for case in known if case.effect == title]
        first = [first_cause(results[case.name]) for case in mine]
        true = sum(code in case.causes for case, code in zip(mine, first, strict=True))
        others = sorted({code or "nothing" for case, code in zip(mine, first, strict=True) if code not in case.causes})
        right += true
        untold += sum(not code and harmless(results[case.name]) for case, code in zip(mine, first, strict=True))
        lines.append(f"| {title} | {mine[0].strength} | {true} of {len(mine)} | {', '.join(others) or '–'} |")
    return [
        *lines,
        "",
        f"Of {len(known)} sets, {untold} are right within half their U and nothing is told of them. Of the others, the "
        f"first cause told of {right} is the true one ({right / max(len(known) - untold, 1):.0%}).",
    ]


def harmless(figures: Figures) -> bool:
    """Whether an effect left the thickness right, within half its U."""
    return "error" in figures and abs(figures["error"]) <= figures["U"] / 2
