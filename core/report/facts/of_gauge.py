"""What is told of a thickness: the value, as of any characteristic, and the two faces."""

from __future__ import annotations

import math

from core.inspect.characteristic import thickness_characteristic
from core.inspect.results import Face, GaugeResult
from core.messages import label
from core.report.facts.fact import Fact, Reader, named
from core.report.facts.of_features import characteristic_facts

UPPER, LOWER = label("upper face"), label("lower face")


def gauge_facts(gauge: GaugeResult) -> tuple[Fact, ...]:
    """Thickness, deviation, nominal value and limits, and the faces; the verdict is told of the part."""
    *thickness, _verdict = characteristic_facts(thickness_characteristic(gauge))
    return (
        *thickness,
        angle_fact(gauge),
        *named(UPPER, face_facts(gauge.upper)),
        *named(LOWER, face_facts(gauge.lower)),
    )


def angle_fact(gauge: GaugeResult) -> Fact:
    """The angle between the faces."""
    about = label("Angle between the two faces when each is fitted by itself")
    angle = None if gauge.parallelism is None else math.degrees(gauge.parallelism)
    return Fact(label("angle of the faces"), angle, "°", 3, about, Reader.AUDITOR)


def face_facts(face: Face) -> tuple[Fact, ...]:
    """How flat a face is, and what its plane rests on."""
    about = label("Width of the zone that holds the face's form, free of its points' noise, and its U (k = 2)")
    U = None if face.flatness_u_mm is None else 2 * face.flatness_u_mm
    return (
        Fact(label("flatness"), face.flatness_mm, "mm", 3, about, Reader.AUDITOR, sd=U),
        Fact(label("points"), len(face.indices), tip=label("Points the plane rests on"), level=Reader.AUDITOR),
        Fact(label("RMS of the residuals"), face.rms_mm, "mm", 3, label("Of the points used"), Reader.METROLOGIST),
    )
