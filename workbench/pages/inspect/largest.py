"""Why U is as large as it is: the largest row of a budget, and what makes that smaller."""

from __future__ import annotations

from collections.abc import Mapping

from core.inspect.causes import Cause
from core.inspect.characteristic import Characteristic
from core.messages import label
from core.report.facts.of_budget import largest_row
from workbench.language import sentences, text_of, tr
from workbench.pages.words import percent

_MORE_SWEEPS = label("More sweeps over the faces make it smaller.")
_CHECK = label("Take 3 pictures of the check on the day of the scan, on the Scan page.")
HELPS: Mapping[Cause, str] = {
    Cause.POINT_NOISE: _MORE_SWEEPS,
    Cause.SAMPLING: _MORE_SWEEPS,
    Cause.SWEEP_PLANES: label("More sweeps that cross all fixed lines, at other tilts, make it smaller."),
    Cause.FAN_SPECKLE: label("It is another one wherever the part lies: take the mean of scans at several places."),
    Cause.FORM: label("The faces are not flat: draw round what is meant of them."),
    Cause.LIGHT_FROM_BELOW_ASSUMED: label("State the material, under The part."),
    Cause.CAMERA: label("More views that fill the picture, some strongly tilted, make it smaller."),
    Cause.FAN_CALIBRATION: label("More poses of the plate, over all distances, make it smaller."),
    Cause.FAN_ASSUMED: label("State how flat the plate is, on the Laser planes page."),
    Cause.SCALE_ASSUMED: label("State how the plate was made, on the Laser planes page."),
    Cause.SCALE: label("A plate whose size is better known makes it smaller."),
    Cause.CHANGE: _CHECK,
    Cause.CHANGE_ASSUMED: _CHECK,
    Cause.CHANGE_CHARTED: _CHECK,
    Cause.PART_TEMPERATURE_ASSUMED: label("State its temperature, under The part."),
    Cause.PART_EXPANSION_ASSUMED: label("State the material, under The part."),
    Cause.SCALE_TEMPERATURE_ASSUMED: label("State the temperature of the plate, on the Laser planes page."),
}
"""What makes a row of a budget smaller, of the causes that something here is known to help against."""


def why_so_large(one: Characteristic) -> str:
    """Write what contributes most to a characteristic's U, how much, and what helps; "" if not known."""
    found = largest_row(one)
    if found is None:
        return ""
    row, share = found
    said = tr("Largest part of U, {share} of U²: {cause}.", share=percent(share), cause=text_of(row.words))
    return sentences(said, tr(HELPS[row.source]) if isinstance(row.source, Cause) and row.source in HELPS else "")
