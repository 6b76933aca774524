"""A report of an inspection with everything in it: characteristics, studies, deviations, calibrations, a template."""

import io
import math
from datetime import UTC, datetime, timedelta

import numpy as np
from PIL import Image

from core.checks.repeats import repeat_statistics
from core.inspect.causes import cause_named
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.gauge import RULE
from core.inspect.results import Contribution
from core.messages import Message, label, plain
from core.report.content import CalibrationMark, Deviations, ReportedStudy
from core.report.facts.of_repeats import repeat_facts
from core.report.facts.of_verdict import verdict_fact
from core.report.facts.table import Column, FactTable, Uncertain
from core.report.plots.run_chart import run_chart_figure
from core.report.template import ReportTemplate

from .report_samples import block_content, repeats

STATED = Message(
    "feature.stated_at_20",
    "Stated at 20 °C: {change_um:+.2f} µm for a part at {part_celsius:g} °C.",
    change_um=-0.75,
    part_celsius=21.3,
)

INF = math.inf
VALUES = [50.004, 50.011, 50.008, 50.015, 50.012]
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


def chart(look, width):
    """The run chart of the second study."""
    return run_chart_figure(look, VALUES, (), {label("mean"): 50.01}, "mm", width, 42.0)


def studies():
    """Two, as a wing might read them from its files."""
    known = repeat_facts(repeat_statistics(VALUES, 50.0), nominal=50.0)
    columns = (
        Column(label("quantity")),
        Column(label("largest error"), "mm", signed=True),
        Column(label("limit"), "mm"),
    )
    rows = tuple((plain(f"p{n}"), Uncertain(0.01 + n / 1000, 0.002 + n / 9000), 0.05 + n / 100) for n in range(12))
    note = Message("report.note_of_result", "{name}: {note}", name="p1", note=STATED)
    return (
        ReportedStudy(
            label("Gauge R&R"), "", (verdict_fact("acceptable"), *known), (FactTable(columns, rows),), (note,)
        ),
        ReportedStudy(label("Series"), label("thickness"), (verdict_fact("not proven"), *known), (), (), chart),
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
