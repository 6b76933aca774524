"""A report of an inspection with everything in it: characteristics, studies, deviations, calibrations, a template."""

import io
import math
from datetime import UTC, datetime, timedelta

import numpy as np
from PIL import Image

from core.inspect.causes import cause_named
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.gauge import RULE
from core.inspect.results import Contribution
from core.messages import Message
from core.report.content import CalibrationMark, Deviations
from core.report.template import ReportTemplate
from core.study.acceptance import Reading, acceptance_check
from core.study.budget import from_stated
from core.study.grr import grr_study
from core.study.repeats import Requirement, repeat_study
from core.study.series import StatedUncertainty, series_study
from core.study.type1 import type1_study

from .report_samples import block_content, repeats

STATED = Message(
    "feature.stated_at_20",
    "Stated at 20 °C: {change_um:+.2f} µm for a part at {part_celsius:g} °C.",
    change_um=-0.75,
    part_celsius=21.3,
)

INF = math.inf
MEASURED = datetime(2026, 3, 14, 15, 9, 26, tzinfo=UTC)


def characteristics():
    budget = (
        Contribution(cause_named("centreline noise of the points"), 0.0049, 0.0245),
        Contribution(cause_named("camera calibration"), 0.0033),
        Contribution(cause_named("temperature of the part"), 0.0012, 0.5, "rectangular", INF, 21.3, "°C"),
        Contribution(cause_named("repeatability of the scans"), 0.0021, 0.0021, "t", 9.0),
    )
    u = math.sqrt(sum(row.u_mm**2 for row in budget))
    rule = RULE
    rows = [
        Characteristic("block thickness", "thickness", 50.0123, u, k=2.05, limits=Limits(50, -0.2, 0.2), budget=budget,
                       rule=rule, notes=(STATED,), at_20=True, doubts=()),
        Characteristic("top flatness", "flatness", 0.031, 0.004, limits=Limits(0, -INF, 0.05), doubts=()),
        Characteristic("top to side", "angle", math.radians(89.95), math.radians(0.02), "angle",
                       limits=Limits(math.radians(90), math.radians(-0.06), math.radians(0.06)),
                       budget=(Contribution(cause_named("camera calibration"), math.radians(0.02)),), doubts=()),
        Characteristic("step 2 height", "height", 10.2, 0.01, limits=Limits(10, -0.05, 0.05), doubts=()),
        Characteristic("ball diameter", "diameter", 24.98, 0.02, doubts=()),
        Characteristic("unknown", "distance", math.nan, math.nan, limits=Limits(3, -INF, 0.03), doubts=()),
    ]  # fmt: skip
    return tuple(rows)


def studies():
    """One of each kind."""
    rng = np.random.default_rng(4)
    values = 50.0 + rng.normal(0.002, 0.004, 25)
    parts = 49.9 + 0.05 * rng.standard_normal((5, 1, 1)) + 0.002 * rng.standard_normal((5, 3, 2))
    repeated = (50.004 + 0.006 * rng.standard_normal(12)).tolist()
    budget = from_stated(repeated, [0.01] * 12)
    known = {"complete": True, "U": [0.02] * 12, "asked": Requirement(50.0, (-0.1, 0.1))}
    series = (50.0 + 0.01 * rng.standard_normal(40)).tolist()
    series[25] += 0.06
    readings = [Reading("form", f"p{place}", 0.02 + 0.001 * place, u=0.001) for place in range(10)]
    readings += [Reading("size", f"p{place}", 50.01 - 0.002 * place, 50.0, 0.001) for place in range(4)]
    return (
        type1_study(values, 50.0, 0.4),
        grr_study(parts, tolerance=0.4),
        series_study(series, (49.9, 50.1), stated=StatedUncertainty(0.003, 0.006), name="width"),
        repeat_study(repeated, budget, **known),
        acceptance_check(readings, {"form": 0.05, "size": 0.012}),
    )


def logo():
    data = io.BytesIO()
    Image.new("RGB", (300, 90), "#702030").save(data, "PNG")
    return data.getvalue()


def whole_content(**changes):
    from dataclasses import replace

    content = block_content()
    faces = {"top": content.gauge.upper.indices, "bottom": content.gauge.lower.indices}
    top = content.cloud.select(content.gauge.upper.indices)
    deviation = 0.08 * np.sin(top.uv[:, 0] / 40)
    template = ReportTemplate(
        name="Werkzeugbau Süd GmbH",
        address=("Messraum 2", "Industriestraße 5", "70565 Stuttgart"),
        logo=logo(),
        accent="#702030",
        footer="Amtsgericht Stuttgart HRB 12345 · www.example.com",
        text="Results refer to the item measured only.",
        signatures=("M. Jørgensen", "Dr. A. Brandt"),
    )
    given = {
        "inspected": characteristics(),
        "points": faces,
        "features": {"top flatness": "top", "top to side": "side", "step 2 height": "cut A"},
        "seen_at": {"side": "bottom"},
        "sections": {"cut A": np.column_stack([np.linspace(0, 80, 400), 10.2 * (np.arange(400) > 150)])},
        "deviations": (Deviations("top to CAD", top.uv, deviation, 0.1),),
        "studies": studies(),
        "calibrations": (
            CalibrationMark("camera", "c3f1a09b22d4", "ab" * 32, MEASURED - timedelta(days=12, hours=3)),
            CalibrationMark("planes", "9b22d4c3f1a0", "cd" * 32),
        ),
        "rig_id": "0123456789ab",
        "template": template,
        "customer": "Brandt & Söhne",
        "air_celsius": 20.4,
        "part_celsius": 21.3,
        "repeats": repeats(),
        "remarks": "Cleaned with alcohol.",
    }
    return replace(content, **(given | changes))
