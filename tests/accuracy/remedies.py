"""Remedies done on the twin: a set with which something is wrong is rendered again with what the note asks for.

A remedy helps if neither the error nor U is worse with it and one of them is better by more than chance, or if a part
conforms that was refused or not proven. A shadow that passes, and coma, are left out: a thickness is right with them,
so to take them away has nothing to gain, and such a set proves nothing of what their notes ask for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from core.inspect.conformity import Verdict
from core.simulate.effects.laser import GAUSSIAN_LASER
from core.simulate.effects.plates import PlateEffects
from core.simulate.effects.room import RoomEffects
from core.simulate.effects.sensor import SensorEffects
from core.simulate.effects.warming import NO_WARMING
from core.simulate.scenario import Scenario
from tests.accuracy.causes import BENIGN
from tests.accuracy.hostile import Figures
from tests.accuracy.hostile_cases import BOUNCES, CHECK_POSES, EFFECTS, HostileCase, base

SEED = 1
"""Of the sets that are rendered again."""
CHANCE = 0.1
"""Share of U by which an error, or U itself, may differ between two sets by chance; half of it by which U may grow."""
USUAL_SPECKLE = base(0.25).speckle
"""Contrast of the speckle behind an aperture that is opened, or of wider lines."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """What a note asks for: the effect that it is told of, in words, and as fields of a scenario.

    `fields` makes them of the scenario before; `of` names the effect or the benign kind.
    """

    of: str
    asked: str
    fields: Callable[[Scenario], Mapping[str, Any]]


def _less_light(stops: float) -> Callable[[Scenario], Mapping[str, Any]]:
    """A sensor that sees so many stops less."""
    return lambda scenario: {
        "sensor": replace(scenario.sensor, brightness=scenario.sensor.brightness / 2**stops, bloom=0.0, smear=0.0)
    }


def _with(**fields: Any) -> Callable[[Scenario], Mapping[str, Any]]:
    return lambda scenario: fields


REMEDIES: Sequence[Remedy] = (
    Remedy(BOUNCES, "spray the part matt", _with(mirror_share=0.0)),
    Remedy("lamps that flicker at 100 Hz", "keep the light as it is", _with(room=RoomEffects(), readout_ms=0.0)),
    Remedy("a lamp switched within the scan", "keep the light as it is", _with(room=RoomEffects())),
    Remedy("the rig warms within the scan", "let camera and lasers warm up", _with(warming=NO_WARMING)),
    Remedy(
        "the rig warmed since its calibration",
        "calibrate again",
        _with(drifted_px=0.0, turned_urad=0.0, warming=NO_WARMING),
    ),
    Remedy("the rig was knocked since its calibration", "calibrate again", _with(drifted_px=0.0, turned_urad=0.0)),
    Remedy("exposed too long, blooming", "1 stop less of light, and again until it is not told", _less_light(3.0)),
    Remedy("automatic exposure", "fix exposure and gain", _with(sensor=SensorEffects())),
    Remedy("camera's target bowed", "fix it to something flat", _with(plates=PlateEffects())),
    Remedy("plane target bowed", "a flat target", _with(plates=PlateEffects())),
    Remedy("plane target larger", "measure its size", _with(plates=PlateEffects())),
    Remedy("lasers that are no Gaussian across", "another laser", _with(laser=GAUSSIAN_LASER)),
    Remedy("JPEG", "record PNG", _with(sensor=SensorEffects())),
    Remedy("Bayer mosaic", "a grey camera", _with(sensor=SensorEffects())),
    Remedy("hot pixels", "map them out", _with(sensor=SensorEffects())),
    Remedy("translucent part", "spray the part matt", _with(inner_share=0.0)),
    Remedy("glossy part", "1.5 EV less", _less_light(1.5)),
    Remedy("glossy part with a lay", "spray the part matt", _with(gloss=1.0)),
    Remedy("fan lines that bow", "mend the lines", _with(fan_bow=0.0)),
    Remedy("speckle", "open the aperture, wider lines", _with(speckle=USUAL_SPECKLE)),
    Remedy("hand that moves", "move slower, rest the hand", _with(hand_mm_s=7.0, tremor_mm=0.05)),
    Remedy("something moves within the scan", "hold both still", _with(bumped_px=0.0, lifted_mm=0.0)),
    Remedy("12 frames", "record 30 frames or more", _with(frames=30)),
    Remedy("nothing, not checked", "take 3 pictures of the plane target", _with(check_poses=CHECK_POSES)),
)
"""What the notes on each effect ask for, as far as a scenario can hold it."""


def before(remedy: Remedy) -> HostileCase:
    """The set with which something is wrong: an effect at its greatest strength, or a benign kind."""
    if remedy.of == "nothing, not checked":
        return HostileCase("nothing", "not checked", replace(base(0.25), seed=SEED))
    if remedy.of in BENIGN:
        fields: Mapping[str, Any] = BENIGN[remedy.of]
        return HostileCase("nothing", remedy.of, replace(base(0.25), seed=SEED, check_poses=CHECK_POSES, **fields))
    (effect,) = (one for one in EFFECTS if one.title == remedy.of)
    label, fields = effect.strengths[-1]
    return HostileCase(effect.title, label, replace(base(0.25), seed=SEED, check_poses=CHECK_POSES, **fields))


def after(remedy: Remedy) -> HostileCase:
    """The same set with what was asked for."""
    case = before(remedy)
    scenario = replace(case.scenario, **remedy.fields(case.scenario))
    effect = case.effect if not case.states_size else "nothing"
    return HostileCase(effect, f"{remedy.asked} ({remedy.of})", scenario)


def helps(first: Figures, then: Figures) -> bool:
    """Whether a part conforms that did not, or error or U is better by a tenth of U and the other no worse."""
    if _conforms(then) and not _conforms(first) and first.get("verdict") != Verdict.NOT_CONFORMING:
        return True
    if "error" not in first or harms(first, then):
        return False
    grown, times = abs(then["error"]) - abs(first["error"]), then["U"] / first["U"]
    return bool(grown < -CHANCE * first["U"] or times < 1 - CHANCE)


def harms(first: Figures, then: Figures) -> bool:
    """Whether a thickness is not measured any more, or conforms no more, or error or U is worse by more than chance."""
    if "error" not in first:
        return False
    if "error" not in then or (_conforms(first) and not _conforms(then)):
        return True
    grown, times = abs(then["error"]) - abs(first["error"]), then["U"] / first["U"]
    return bool(grown > CHANCE * first["U"] or times > 1 + CHANCE / 2)


def suffices(first: Figures, then: Figures) -> bool:
    """Whether a remedy helps, or does no harm to a part that conforms without it, as with most lamps that flicker."""
    return helps(first, then) or (_conforms(first) and not harms(first, then))


def _conforms(figures: Figures) -> bool:
    return figures.get("verdict") == Verdict.CONFORMING


def remedies_table(results: Mapping[str, Figures]) -> list[str]:
    """A line for each remedy of which both sets are measured: errors and U before and after in µm."""
    lines = ["| effect | asked for | error, U before, µm | after | helps |", "|---|---|---|---|---|"]
    for remedy in REMEDIES:
        one, other = before(remedy).name, after(remedy).name
        if one in results and other in results:
            helped = "yes" if helps(results[one], results[other]) else "**no**"
            lines.append(
                f"| {remedy.of} | {remedy.asked} | {_shown(results[one])} | {_shown(results[other])} | {helped} |"
            )
    return lines


def _shown(figures: Figures) -> str:
    if "error" not in figures:
        return "refused"
    return f"{1e3 * figures['error']:+.1f}, {1e3 * figures['U']:.1f}"
