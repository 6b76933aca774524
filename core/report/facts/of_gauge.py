"""What is told of a thickness: the value, as of any characteristic, and the two faces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from core.inspect.characteristic import thickness_characteristic
from core.inspect.results import Face, GaugeResult
from core.messages import label, plain
from core.report.facts.fact import Fact, Reader, named
from core.report.facts.of_features import characteristic_facts
from core.report.facts.pictures import Picture, used_fact
from core.report.facts.table import Column, FactTable, Uncertain

UPPER, LOWER = label("upper face"), label("lower face")


def gauge_facts(gauge: GaugeResult) -> tuple[Fact, ...]:
    """Make the facts on a thickness: value, deviation, nominal value, limits and both faces."""
    *thickness, _verdict = characteristic_facts(thickness_characteristic(gauge))
    return (
        *thickness,
        angle_fact(gauge),
        *named(UPPER, face_facts(gauge.upper)),
        *named(LOWER, face_facts(gauge.lower)),
    )


def angle_fact(gauge: GaugeResult) -> Fact:
    """Make the fact on the angle between the upper and the lower face."""
    about = label("Angle between the two faces when each is fitted by itself")
    angle = None if gauge.parallelism is None else math.degrees(gauge.parallelism)
    return Fact(label("angle of the faces"), angle, "°", 3, about, Reader.AUDITOR)


def face_facts(face: Face) -> tuple[Fact, ...]:
    """Make the facts on a face: its flatness, and how many points its plane rests on."""
    about = label("Width of the zone that holds the face's form, free of its points' noise, and its U (k = 2)")
    U = None if face.flatness_u_mm is None else 2 * face.flatness_u_mm
    return (
        Fact(label("flatness"), face.flatness_mm, "mm", 3, about, Reader.AUDITOR, U=U),
        Fact(label("points"), len(face.indices), tip=label("Points the plane rests on"), level=Reader.AUDITOR),
        Fact(label("RMS of the residuals"), face.rms_mm, "mm", 3, label("Of the points used"), Reader.METROLOGIST),
    )


class PictureStep(Picture, Protocol):
    """Result of one picture of the fan alone, as `core.files.results.profile_file.PictureStep`."""

    @property
    def thickness_mm(self) -> float: ...
    @property
    def own_mm(self) -> float: ...


def pictures_fact(pictures: Sequence[PictureStep]) -> Fact:
    """Make the fact on how many pictures of the fan alone, without a sweep, gave a step height."""
    return used_fact(label("pictures"), pictures, label("Pictures that gave a thickness, and all there are"))


def pictures_table(pictures: Sequence[PictureStep]) -> FactTable:
    """Make the table of the step heights from pictures of the fan alone, one row for each picture that gave one."""
    own = label("Standard uncertainty that is the picture's own (k = 1)")
    columns = (Column(label("picture")), Column(label("thickness"), "mm"), Column(label("own u"), "mm", tip=own))
    rows = (
        (plain(one.name), Uncertain(one.thickness_mm, one.own_mm), Uncertain(one.own_mm, one.own_mm))
        for one in pictures
        if one.used
    )
    return FactTable(columns, tuple(rows))
