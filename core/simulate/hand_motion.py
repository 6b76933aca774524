"""Motion of the hand while a picture is taken: rows read out one after another, and an exposure that takes time.

The hand goes on at its speed and trembles: physiological tremor of an arm held out has 8 to 12 Hz, and an amplitude of
some tenths of a millimetre. A camera whose shutter rolls reads the first row half its read-out before the middle one,
so each row sees the sheet of light elsewhere.

References
----------
Elble, R. J., Randall, J. E., Motor-unit activity responsible for 8- to 12-Hz component of human physiological finger
tremor, J. Neurophysiol. 39 (1976), doi:10.1152/jn.1976.39.2.370.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.model import LightPlane
from core.model.arrays import Array
from core.simulate.scene.laser import Sheet

TREMOR_HZ = (8.0, 12.0)
"""Frequency of the tremor, another in each frame."""
INSTANTS = 5
"""Instants that stand for an exposure."""


@dataclass(frozen=True, slots=True)
class HandMotion:
    """Motion of the hand while a picture is taken.

    Parameters
    ----------
    speed_mm_s
        Of laser and stripe across the scene.
    tremor_mm
        Amplitude of the tremor, of the laser and, independent of it, of where it is pointed to.
    readout_s
        Time from the first row to the last; 0: all rows at once.
    exposure_s
        Time each row collects light.
    """

    speed_mm_s: float = 0.0
    tremor_mm: float = 0.0
    readout_s: float = 0.0
    exposure_s: float = 0.0

    @property
    def is_visible(self) -> bool:
        """Whether the hand's motion within an exposure, or while rows are read out, shows in pictures."""
        return (self.speed_mm_s > 0 or self.tremor_mm > 0) and (self.readout_s > 0 or self.exposure_s > 0)

    def sheets(self, sheet: Sheet, rows: int, heading: float, rng: np.random.Generator) -> tuple[Sheet, ...]:
        """Compute the laser sheets in a picture of `rows` rows while the hand moves right (+1) or left (−1).

        Returns
        -------
        tuple of Sheet
            At instants spread over the exposure; the picture shows their mean.
        """
        rate = 2 * np.pi * rng.uniform(*TREMOR_HZ)
        phases = rng.uniform(0, 2 * np.pi, (2, 2))
        times = self.readout_s * ((np.arange(rows) + 0.5) / rows - 0.5)
        shutter = self.exposure_s * (np.arange(INSTANTS) / (INSTANTS - 1) - 0.5) if self.exposure_s > 0 else np.zeros(1)
        aim = sheet.emitter + sheet.beam.focus_mm * sheet.axis
        along = np.cross(sheet.plane.normal, sheet.axis)

        def away(time: Array, of: int) -> Array:
            moved = np.zeros((len(time), 3))
            moved[:, :2] = self.tremor_mm * np.sin(rate * time[:, None] + phases[of])
            moved[:, 0] += heading * self.speed_mm_s * time
            return moved

        def planes(time: Array) -> Array:
            emitter = sheet.emitter + away(time, 0)
            normal = np.cross(aim + away(time, 1) - emitter, along)
            normal *= (np.sign(normal @ sheet.plane.normal) / np.linalg.norm(normal, axis=1))[:, None]
            return np.column_stack([normal, (normal * emitter).sum(axis=1)])

        middle = planes(np.zeros(1))[0]
        plane = LightPlane(middle[:3] / middle[3])
        return tuple(replace(sheet, plane=plane, rows=planes(times + begun)) for begun in shutter)
