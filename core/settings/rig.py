"""Settings that rig.toml holds and a page of the window asks for, by their tables: the number, its range, its words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from core.messages import label
from core.settings.setting import Number, Setting

_LENGTH = label("a length in mm above 0 and at most 5000")
_DAYS = Number(
    0.0, 36500.0, label("a number of days above 0"), label("days"), 0.1, 36500.0, decimals=1, step=1.0,
    none=label("no limit"),
)  # fmt: skip
_PROVES_NOTHING = label("What is recorded later proves nothing; empty: no limit.")

RIG: Mapping[str, Mapping[str, Setting]] = {
    "laser_fan": {
        "lines": Setting(
            Number(0.0, 20.0, label("a whole number from 1 to 20"), "", 1.0, 9.0, decimals=0, step=1.0),
            steps=("planes",),
            title=label("Lines"),
            help="How many lines the fixed laser draws.",
        ),
        "angle_deg": Setting(
            Number(
                0.0, 45.0, label("an angle between neighbouring lines above 0 and at most 45"), "°", 0.1, 45.0,
                decimals=3, step=0.1, none=label("not stated"), first=5.0,
            ),
            steps=("planes",),
            title=label("Angle"),
            help="Between neighbouring lines, as its maker states it.",
        ),
    },
    "camera": {
        "row_time_us": Setting(
            Number(
                0.0, 1e5, label("a time in µs from one row to the next, 0 to 100000"), "µs", 0.0, 1e5,
                decimals=2, step=1.0, none=label("assumed"), first=0.0, also_at=True,
            ),
            steps=("scan",),
            title=label("Time from row to row"),
            help="0: a global shutter. Empty: not known, a global one is assumed.",
        ),
    },
    "validity": {
        "calibration_days": Setting(
            replace(_DAYS, first=30.0), steps=("scan",), title=label("Calibration"), help=_PROVES_NOTHING
        ),
        "check_days": Setting(replace(_DAYS, first=1.0), steps=("scan",), title=label("check"), help=_PROVES_NOTHING),
    },
    "gauge": {
        "nominal_mm": Setting(
            Number(0.0, 5000.0, _LENGTH, "mm", 0.001, 5000.0, decimals=4, step=1.0, none=label("none")),
            steps=("gauge",),
            title=label("Nominal thickness"),
            help="What the part should be; empty: no verdict.",
        ),
        "tolerance_mm": Setting(
            Number(0.0, 5000.0, _LENGTH, "mm", 0.0001, 5000.0, decimals=4, step=0.01, none=label("none")),
            steps=("gauge",),
            title=label("Tolerance ±"),
            help="Largest permitted deviation, to either side.",
        ),
    },
}  # fmt: skip
"""By the tables of rig.toml, in the order of their forms."""
