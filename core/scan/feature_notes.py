"""What a scan's frames tell the technician: that something moved, or that the room's light changed."""

from __future__ import annotations

from collections.abc import Sequence

from core.scan.frame_reader import LOST, MOVED, FrameFeatures


def notes_on(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    """Sentences on all frames of a scan."""
    return _moved_notes(frames) + _light_notes(frames)


def _light_notes(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    changed = [frame for frame in frames if frame.light_change]
    if not changed:
        return ()
    most = max(changed, key=lambda frame: abs(frame.light_change))
    which = "brighter" if most.light_change > 0 else "darker"
    return (
        f"The room's light changed in {len(changed)} of {len(frames)} frames, the first {changed[0].name}: the "
        f"background is up to {100 * abs(most.light_change):.0f} % {which} than in the reference, which makes stripes "
        "less sure. Keep the light as it is during a scan, or scan again.",
    )


def _moved_notes(frames: Sequence[FrameFeatures]) -> tuple[str, ...]:
    moved = [frame for frame in frames if frame.reason in (MOVED, LOST)]
    if not moved:
        return ()
    first = moved[0]
    return (
        f"Object or camera moved during the scan: {len(moved)} of {len(frames)} frames were left out, the first "
        f"{first.name} (the fan's light is {first.shift_px:.1f} px or more aside, measured across its lines). "
        "Hold both still and scan again to use them all.",
    )
