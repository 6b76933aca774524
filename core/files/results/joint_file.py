"""joint.json: the joint of several views, what speaks against it, and the thickness across them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from core import __version__
from core.files.atomic import write_text
from core.files.json_text import to_json
from core.files.results.gauge_file import gauge_summary
from core.files.tables import kept, row_tables
from core.inspect.results import GaugeResult
from core.views.joint import Joint
from core.views.joint_check import JointCheck


def joint_table(joint: Joint) -> list[dict[str, Any]]:
    """Make the table of each view of a joint: its pose (4 × 4) with covariance (6 × 6), and the marks seen.

    The pose maps the view's camera frame to that of the first view, in mm; the covariance is that of a small motion
    (ω in rad, τ in mm) after it.
    """
    found = []
    for number, name in enumerate(joint.views):
        pose, residuals = joint.pose(number), joint.residuals[number]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = pose.rotation, pose.translation
        left_out = joint.left_out(number)
        used = ~np.isin(joint.seen[number].numbers, left_out)
        found.append(
            {
                "name": name,
                "pose": matrix,
                "covariance": joint.covariance(number),
                "marks": joint.seen[number].numbers,
                "marks_left_out": left_out,
                "rms_px": float(np.sqrt(np.mean(residuals[used] ** 2))),
            }
        )
    return found


def write_joint(path: Path, check: JointCheck, gauge: GaugeResult, calibration_id: str) -> None:
    """Write the joint of several views with its check and the thickness across them; InputError if that fails."""
    joint = check.joint
    write_text(
        path,
        to_json(
            {
                "carrier": joint.carrier.name,
                "views": joint_table(joint),
                "chi2": check.chi2,
                "redundancy": check.redundancy,
                "scale": joint.scale,
                "pairs": [_fields(pair) for pair in check.pairs],
                "without_mark": [_fields(one) for one in check.without],
                "overlaps": [_fields(one) for one in check.overlaps],
                "thickness": {
                    **gauge_summary(gauge),
                    "complete": not gauge.doubts,
                    "doubts": [doubt.fact for doubt in gauge.doubts],
                    "notes": [kept(note) for note in gauge.notes],
                    "budget": [row_tables(row, "u_mm") for row in gauge.budget],
                    "points": dict(zip(("upper", "lower"), gauge.points_used, strict=True)),
                },
                "calibration_id": calibration_id,
                "version": __version__,
            }
        ),
    )


def _fields(record: Any) -> dict[str, Any]:
    return {name: getattr(record, name) for name in record.__slots__}
