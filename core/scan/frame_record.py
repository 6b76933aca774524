"""What became of each frame of a scan. Light to import: a window holds these."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FrameRecord:
    """What became of one frame.

    `stripes` centrelines of `stripe_px` points in all; `fan_crossings` with the fan on `fan_lines_met` different lines
    and `sweep_crossings` with other sweeps, of which `left_out` did not count, for `left_out_reasons` (reason, how
    many); `condition` of the fan crossings alone
    (ratio of singular values); `sigma_mm` the median σ of its points. A frame that gave no points says why in `reason`.
    """

    index: int
    name: str
    used: bool
    reason: str = ""
    stripes: int = 0
    stripe_px: int = 0
    fan_crossings: int = 0
    fan_lines_met: int = 0
    sweep_crossings: int = 0
    left_out: int = 0
    condition: float = float("inf")
    points: int = 0
    sigma_mm: float = float("nan")
    left_out_reasons: tuple[tuple[str, int], ...] = ()
