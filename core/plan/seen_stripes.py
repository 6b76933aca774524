"""From exact stripes to what the extraction would find of them: centrelines with its noise and its stated σ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from core.errors import InputError
from core.image.centreline import Centreline
from core.image.stripe import filter_for
from core.plan.design import Design
from core.plan.light_lines import LitLine
from core.plan.stripe_trial import Light, StripeQuality, try_stripes
from core.simulate.rig import Beam, Optics, Rig

_WHITE_GREY = 255.0
_TAILS = (0.02, 0.98)  # quantiles of the brightness along all stripes between which trials are made


@dataclass(frozen=True, eq=False, slots=True)
class SeenStripes:
    """One kind of stripe of a plan, before and after its trial (`tried`).

    `filter_px` is the σ of the filter that suits the stripe; `single` whether it is read from one picture alone.
    """

    optics: Optics
    scale: float
    single: bool
    filter_px: float
    background_grey: float = 0.0
    quality: StripeQuality | None = None

    @classmethod
    def of_plates(cls, design: Design) -> SeenStripes:
        """The fan's stripes on the plates of its calibration, read from the difference of two pictures."""
        return cls._planned(design.rig(), design.rig().fan_beam, design, single=False)

    @classmethod
    def of_fan(cls, design: Design) -> SeenStripes:
        """The fan's stripes in a scan's reference."""
        return cls._planned(design.rig(), design.rig().fan_beam, design, single=True)

    @classmethod
    def of_hand(cls, design: Design) -> SeenStripes:
        """The hand-held laser's stripes in the frames of a scan."""
        return cls._planned(design.rig(), design.rig().sweep_beam, design, single=False)

    @classmethod
    def _planned(cls, rig: Rig, beam: Beam, design: Design, *, single: bool) -> SeenStripes:
        width = np.hypot(beam.sigma_mm * design.focal_px / design.distance_mm, rig.blur_px)
        return cls(rig.optics, rig.scale, single, filter_for(float(width)))

    def tried(self, lines: Sequence[LitLine], background_grey: float) -> SeenStripes:
        """With the quality that stripes as wide and as bright as `lines` have over this background.

        Raises
        ------
        InputError
            If they would not be found at all.
        """
        if not lines:
            return self
        height = np.concatenate([line.height for line in lines])
        width = float(np.median(np.concatenate([line.width for line in lines])))
        low, high = np.quantile(height, _TAILS)
        try:
            quality = try_stripes(
                Light(width, background_grey, self.single), (float(low), float(high)), self.optics, self.scale
            )
        except ValueError as error:
            raise InputError(
                f"the stripes would be too faint to be found ({high:.1f} grey levels high)",
                where="[plan] stripe_grey",
                todo="plan a brighter laser or a longer exposure",
            ) from error
        return replace(self, filter_px=quality.filter_px, background_grey=background_grey, quality=quality)

    def centreline(self, line: LitLine, rng: np.random.Generator) -> Centreline:
        """What the extraction would find of `line`; `rng` draws its errors."""
        assert self.quality is not None, "the stripes have not been tried"
        error = self.quality.errors(line.height, rng)
        strength = line.height * np.maximum(1 + self.quality.flicker(len(line), rng), 0.05)
        ceiling = _WHITE_GREY - self.background_grey - self.optics.black_level_grey
        return Centreline(
            line.uv + error[:, None] * line.normal,
            line.normal,
            line.width,
            strength,
            self.quality.sigma(line.height),
            strength > ceiling,
            self.quality.correlation_px,
        )
