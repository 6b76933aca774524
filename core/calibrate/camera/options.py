"""Options of a camera calibration. Light to import: command line, files and the window need them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Outliers = Literal["keep", "gross", "all"]


@dataclass(frozen=True)
class CameraOptions:
    """Options of a camera calibration: free parameters, and which outliers are left out.

    Parameters
    ----------
    skew
        Whether γ is free; else it is 0. None: it is free only where that predicts views left out better.
    fixed
        Those of k1, k2, p1, p2 that are fixed to 0.
    k3
        Whether k3 is free; else it is 0. None: it is free only where that predicts views left out better.
    outliers
        "keep": every corner of every view counts. "gross": views out of line with the others are left out, and
        corners that stand out against the plain standard deviation of their view, which they raise themselves. "all":
        also corners that stand out against the median of their view only.

    Raises
    ------
    ValueError
        If `fixed` names another parameter.
    """

    skew: bool | None = None
    fixed: frozenset[str] = frozenset()
    k3: bool | None = None
    outliers: Outliers = "gross"

    def __post_init__(self) -> None:
        object.__setattr__(self, "fixed", frozenset(self.fixed))
        unknown = self.fixed - {"k1", "k2", "p1", "p2"}
        if unknown:
            raise ValueError(f"only k1, k2, p1 and p2 can be fixed, not {', '.join(sorted(unknown))}")
