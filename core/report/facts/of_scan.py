"""What is told of a measured scan: its points, how sure they are, what they cover, and the known planes in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from core.messages import Message, decimals_of, label, plain
from core.model.arrays import Array
from core.report.facts.fact import Fact, Reader
from core.report.facts.of_checks import CHANCE
from core.report.facts.pictures import Picture, used_fact
from core.report.facts.table import Column, FactTable

if TYPE_CHECKING:  # what is compiled: takes time that a window has not at its start
    from core.scan.known_planes.points_on_planes import PlaneAgreement
    from core.scan.plane_check import PlaneCheck

SMALL_MM = 10.0
"""A scan that is smaller than this in all directions is told with decimals."""


def scan_facts(
    frames: Sequence[Picture],
    points: int,
    triangles: int | None = None,
    sigma_mm: tuple[float, float] | None = None,
    share: float | None = None,
    extent_mm: Array | None = None,
) -> tuple[Fact, ...]:
    """Make the facts on the quality of a scan: points, frames used, triangles, σ, coverage, extent; None: not known.

    `sigma_mm` are the median and the 95 % quantile of its points' σ, `share` (0 … 1) what there is of what was lit, and
    `extent_mm` (3,) how large it is along x, y and z.
    """
    facts = [Fact(label("points"), points, tip=label("Measured points, each with its own σ"))]
    if frames:
        facts.append(used_fact(label("frames used"), frames, label("Frames that gave points, and all there are")))
    if sigma_mm is not None:
        half, most = sigma_mm
        tip = Message(
            "told.tip_sigma",
            "Half of the points have a smaller standard uncertainty of depth, 95 % one below {most_mm:.2g} mm; without "
            "what is common to the scan",
            most_mm=most,
        )
        facts += [
            Fact(label("median σ"), half, "mm", max(decimals_of(half), 0), tip),
            Fact(
                label("95 % of σ"), most, "mm", max(decimals_of(half), 0),
                label("95 % of the points have a smaller σ"), Reader.AUDITOR,
            ),
        ]  # fmt: skip
    if share is not None:
        tip_share = label("Share of the picture between all laser light in which there are points")
        facts.append(Fact(label("covered of what was lit"), 100 * share, "%", 0, tip_share))
    if triangles is not None:
        tip_mesh = label("Of the mesh made from the points")
        facts.append(Fact(label("triangles"), triangles, tip=tip_mesh, level=Reader.AUDITOR))
    if extent_mm is not None:
        x, y, z = (float(one) for one in extent_mm)
        size = {"x": x, "y": y, "z": z}
        large = Message("told.extent", "{x:.0f} × {y:.0f} × {z:.0f} mm", **size)
        small = Message("told.extent_small", "{x:.2f} × {y:.2f} × {z:.2f} mm", **size)
        whole = large if max(x, y, z) >= SMALL_MM else small
        facts.append(Fact(label("extent x, y, z"), whole, level=Reader.AUDITOR))
    return tuple(facts)


def plane_tables(planes: Sequence[PlaneAgreement], check: PlaneCheck | None) -> tuple[FactTable, ...]:
    """Make the table of the known planes of a scan, and of those that its check has left out; () if there are none.

    A row has the points on the board and how they agree with it, and how far off it the fan is.
    """
    used, off = {one.name: one for one in planes}, {} if check is None else {one.name: one for one in check.planes}
    columns = (
        Column(label("known plane")),
        Column(label("points")),
        Column(label("left out")),
        Column(label("RMS"), "mm", 3, label("RMS distance in depth of the sweeps' points from the board")),
        Column(label("fan off by"), "mm", 3, label("How much farther away the fan has the board"), signed=True),
        Column(label("turned by"), "°", 3, label("Angle between the board and where the fan has it")),
    )
    rows = tuple(
        (
            plain(name),
            *((None,) * 3 if (one := used.get(name)) is None else (one.points, one.left_out, one.rms_mm)),
            *((None,) * 2 if (its := off.get(name)) is None else (its.mm, its.degrees)),
        )
        for name in {**used, **off}
    )
    return (FactTable(columns, rows, level=Reader.AUDITOR),) if rows else ()


def plane_check_facts(check: PlaneCheck | None) -> tuple[Fact, ...]:
    """Make the facts on the comparison of the fan with known planes; () where there was none."""
    if check is None:
        return ()
    return (
        Fact(
            label("fan against planes: χ²"), check.squares, "", 1,
            Message("told.tip_squares", "Of {n} numbers that are compared", n=check.freedom), Reader.METROLOGIST,
        ),
        Fact(
            CHANCE, check.p, tip=label("Probability that chance alone would set fan and known planes as far apart"),
            level=Reader.AUDITOR, significant=2,
        ),
        Fact(
            label("changes it would show"), 100 * check.sees, "%", 0,
            label("Share of usual changes of a rig since its calibration that the comparison would tell"),
            Reader.AUDITOR,
        ),
    )  # fmt: skip


def sigma_of(sigma: Array) -> tuple[float, float] | None:
    """Compute the median and the 95 % quantile of the points' σ (N,) in mm; None if no σ is known."""
    known = sigma[np.isfinite(sigma)]
    if not len(known):
        return None
    half, most = np.quantile(known, [0.5, 0.95])
    return float(half), float(most)
