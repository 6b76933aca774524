"""What is told of a measured scan: its points, how sure they are, and what they cover."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.messages import Message, decimals_of, label
from core.model.arrays import Array
from core.report.facts.fact import Fact, Reader
from core.report.facts.pictures import Picture, used_fact

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


def sigma_of(sigma: Array) -> tuple[float, float] | None:
    """Compute the median and the 95 % quantile of the points' σ (N,) in mm; None if no σ is known."""
    known = sigma[np.isfinite(sigma)]
    if not len(known):
        return None
    half, most = np.quantile(known, [0.5, 0.95])
    return float(half), float(most)
