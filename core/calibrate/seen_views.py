"""What the pictures of the camera target show, before anything is calibrated from them."""

from __future__ import annotations

from dataclasses import dataclass

from core.calibrate.results import CameraCalibration
from core.image.target_view import TargetView


@dataclass(frozen=True, eq=False, slots=True)
class SeenView:
    """One picture: the target found in it, or the reason why it was not; size (width, height) if it could be read."""

    name: str
    view: TargetView | None = None
    reason: str = ""
    size: tuple[int, int] | None = None


@dataclass(frozen=True, eq=False, slots=True)
class SeenViews:
    """What all pictures of the camera target show, in the order of the set; `where` they lie, for messages."""

    views: tuple[SeenView, ...]
    where: str

    @property
    def size(self) -> tuple[int, int] | None:
        """(width, height) of the pictures; None if none could be read."""
        return next((one.size for one in self.views if one.size is not None), None)

    @property
    def found(self) -> tuple[TargetView, ...]:
        """The targets that were found."""
        return tuple(one.view for one in self.views if one.view is not None)

    @property
    def lost(self) -> tuple[SeenView, ...]:
        """The pictures in which there is no usable target."""
        return tuple(one for one in self.views if one.view is None)


@dataclass(frozen=True, eq=False, slots=True)
class RecalledCamera:
    """The accepted calibration; what the project's pictures show, if it was made from these very ones.

    `as_it_is`: it is what these pictures give with the project's settings as they are.
    """

    calibration: CameraCalibration
    seen: SeenViews | None
    as_it_is: bool


def seen_again(calibration: CameraCalibration, where: str) -> SeenViews:
    """What the pictures showed that `calibration` was made from, so that it can be solved again without them."""
    size = calibration.camera.image_size
    return SeenViews(
        tuple(
            SeenView(quality.view.name, quality.view if len(quality.view.uv) else None, quality.reason, size)
            for quality in calibration.views
        ),
        where,
    )
