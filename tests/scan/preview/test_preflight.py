"""The checks before a scan: each with what came of it and one sentence."""

from dataclasses import replace

import numpy as np
import pytest

from core.image.stripes.centreline import Centreline
from core.messages import plain
from core.model import Camera, Fan, LightPlane
from core.scan.changed_section import ChangedSection, Section
from core.scan.preview.preflight import Preflight

SIZE = (1920, 1374)
CAMERA = Camera(SIZE, np.array([[2486.0, 0, 960], [0, 2486, 687], [0, 0, 1]]))
FAN = Fan(tuple(LightPlane.from_normal(np.array([1.0, 0.0, 0.1 * k]), 50.0) for k in (1, 2, 3)))


def stripe(level=0.5, width=1.5, saturated=False, count=200):
    along = np.arange(count, dtype=float)
    return Centreline(
        np.column_stack([along, along]),
        np.tile([0.6, 0.8], (count, 1)),
        np.full(count, width),
        np.full(count, 255 * level),
        np.full(count, 0.1),
        np.full(count, saturated),
    )


GOOD = Preflight(3, SIZE, ((stripe(),), (stripe(),), (stripe(),)), camera=CAMERA, fan=FAN, age_s=3 * 86_400.0)


def states(preflight):
    return {check.name: check.state for check in preflight.checks()}


def sentence(preflight, name):
    return next(str(check.message) for check in preflight.checks() if check.name == name)


def test_all_is_well():
    assert set(states(GOOD).values()) == {"ok"}
    assert sentence(GOOD, "calibration") == "Camera and fan were calibrated 3 days ago."
    assert sentence(GOOD, "lines") == "All 3 lines of the fan are seen."


def test_before_the_reference_only_the_calibration_is_known():
    before = states(replace(GOOD, fan_lines=None))
    assert before.pop("calibration") == "ok"
    assert set(before.values()) == {"unknown"}


@pytest.mark.parametrize(
    ("change", "name", "state", "said"),
    [
        ({"departed": plain("the camera moved")}, "reference", "failed", "does not hold any more: the camera moved."),
        ({"fan_lines": ((stripe(),), (), (stripe(),))}, "lines", "failed", "Only 2 of the fan's 3 lines"),
        ({"camera": None, "fan": None}, "lines", "unknown", "once camera and fan are calibrated"),
        ({"camera": None}, "calibration", "failed", "The camera is not calibrated"),
        ({"fan": None}, "calibration", "failed", "The fan is not calibrated"),
        ({"fan_lines": ((stripe(0.05),),) * 3}, "exposure", "failed", "faint: they reach 5% of white"),
        ({"fan_lines": ((stripe(1.0, saturated=True),),) * 3}, "exposure", "failed", "100% of the fan's stripes"),
        ({"fan_lines": ((stripe(count=10),),) * 3}, "exposure", "unknown", "Too little of the fan"),
        ({"fan_lines": ((stripe(width=9.0),),) * 3}, "focus", "failed", "9.0 px wide (σ): focus camera and laser"),
        ({"fan_lines": ((stripe(width=5.0),),) * 3}, "focus", "unknown", "5.0 px wide"),
        ({"stripe_px": 1.4}, "focus", "ok", "1.5 px wide (σ), 1.4 px when the fan was calibrated."),
        ({"stripe_px": 1.1}, "focus", "unknown", "1.5 px wide (σ), 1.1 px when the fan was calibrated."),
        (
            {"stripe_px": 0.9},
            "focus",
            "failed",
            "0.9 px when the fan was calibrated: set the focus of camera and laser",
        ),
        ({"section": ChangedSection(0.5, 0.1, 0.02, 0.6)}, "focus", "failed", "to one side"),
        ({"section": Section.NOT_KNOWN}, "focus", "unknown", "cannot be told"),
        ({"stripe_px": 9.0, "fan_lines": ((stripe(width=9.0),),) * 3}, "focus", "ok", "9.0 px wide"),
        (
            {"image_size": (960, 687)},
            "calibration",
            "failed",
            "960 × 687 pixels, but the camera was calibrated at 1920",
        ),
        ({"age_s": None}, "calibration", "unknown", "not known when"),
        ({"age_s": 45 * 86_400.0}, "calibration", "failed", "45 days old"),
        ({"age_s": 60.0}, "calibration", "ok", "less than a day ago"),
    ],
)
def test_what_is_wrong_is_told_under_its_name(change, name, state, said):
    changed = replace(GOOD, **change)
    assert states(changed)[name] == state
    assert said in sentence(changed, name)
