"""Checks made by hand: what the job of the check card would give."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta

from core.files.results.check_file import CheckedLine, CheckedPicture, InterimCheck
from core.files.results.rig_history import PastCheck, RigHistory
from core.messages import plain

TAKEN = datetime(2026, 5, 4, 7, 30, tzinfo=UTC)


def check(p: float = 0.4, offset_px: float = 0.05) -> InterimCheck:
    """Two pictures that say something, one that does not."""
    lines = tuple(CheckedLine(line, 0.2 * offset_px, offset_px, 0.004) for line in (1, 2, 3))
    left_out = CheckedPicture("check/c", plain("the target is not seen"))
    poses = (CheckedPicture("check/a", None, lines), CheckedPicture("check/b", None, lines), left_out)
    return InterimCheck("cam-fan", "0123456789ab", TAKEN, p, poses, 50.0, 0.012, 0.05, 0.03)


def nowhere() -> InterimCheck:
    """No stripe is where the fan was calibrated."""
    reason = plain("no stripe is near where the calibration has the fan")
    return replace(check(0.0), poses=(CheckedPicture("check/a", reason),), error_mm=float("nan"))


def chart(last: InterimCheck, before: int = 9) -> RigHistory:
    """So many steady checks on the days before, and the last one."""
    scatter = (0.010, 0.012, 0.009, 0.011, 0.010, 0.013, 0.011, 0.009, 0.012)
    past = PastCheck.of(last, 21.5)
    days = (
        replace(
            past, taken_at=TAKEN - timedelta(days=before - n), pictures_id=str(n), error_mm=scatter[n % len(scatter)],
            verdict="passed",
        )
        for n in range(before)
    )  # fmt: skip
    return RigHistory("bench", (*days, past))
