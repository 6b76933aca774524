"""What was typed, as the pipeline's options; what can be refused by it alone is, before anything else is begun."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum
from pathlib import Path
from typing import Any

from core.files.atomic import make_folder
from core.files.recording.recording_set import (
    excluded_names,
    open_set,
    require_camera,
    require_outside,
    require_planes,
    require_scan,
)
from core.settings.options import STRIPE, Options, stated_stripe
from core.settings.setting import rows, rows_within


def options(typed: Mapping[str, Any], part: str = "") -> Options:
    """Convert the flags typed, by their words, to the pipeline's options; InputError if a value is not possible.

    A stripe that is typed is that of all stripes, in the scan and on the plane target.
    """
    chosen: dict[str, Any] = {}
    for row in rows(Options):
        within = {
            one.key: _value(typed[flag.word])
            for one in rows_within(row)
            if (flag := one.setting.flag) is not None and flag.word in typed
        }
        if row.setting.kind is STRIPE:
            if within:
                width_px, contrast = (value or None for value in within.values())
                chosen[row.key] = stated_stripe(width_px, contrast, "--stripe-width, --contrast")
        elif row.is_one:
            chosen |= within
        else:
            chosen[row.key] = replace(row.default, **within)
    return Options(**chosen, part=part)


def _value(typed: Any) -> Any:
    return typed.value if isinstance(typed, Enum) else typed


def leaving_out(chosen: Options, folder: Path, names: Sequence[str] | None) -> Options:
    """Add the pictures called `names` of a set to the pictures left out; InputError if the set lacks one of them."""
    return replace(chosen, excluded=excluded_names(open_set(folder), names)) if names else chosen


def require_run(folder: Path, out: Path) -> None:
    """Raise InputError if a set lacks something a whole run needs, or if results cannot be written to `out`."""
    found = open_set(folder)
    require_camera(found)
    if found.rig.has_fan:
        require_planes(found)
    require_scan(found)
    require_outside(found, out)
    make_folder(out)
