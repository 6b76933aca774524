"""What a run can be told; everything has a default that suits most sets."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from core.acquire.grey import Channel
from core.calibrate.camera.adjustment import CameraOptions
from core.errors import InputError
from core.files.recording.step_settings import SIGMA_CUT_MM, CameraSettings, PlanesSettings, ScanSettings
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.scan.method import Method


@dataclass(frozen=True, slots=True)
class Options:
    """What a run can be told.

    Parameters
    ----------
    method
        How sweeps are located; its name will do.
    sigma_cut_mm
        Points with a larger standard uncertainty of depth are left out.
    camera
        Which camera parameters are free.
    stripe
        Width and contrast of the stripes in the scan's pictures; None: chosen from the pictures, for each laser.
    plane_stripe
        The same of the stripes on the plane target.
    channel
        The channel of colour pictures in which the lasers are looked at; None: as the rig says, or chosen.
    part
        Name of the part for the report; else it is named like the set.
    excluded
        Pictures left out by hand, named as in a set: "camera/view03.png", "planes/pose02", "scan/frame0007.png".
    constrain_fan
        Hold the fan's planes to one pencil where that suits the laser; else they are free.
    adjust_camera
        Let the poses of the plane target correct the camera, in one adjustment with the fan; else it stays as its own
        views gave it.
    accept_few_poses
        Use laser planes even though fewer than half of the poses agree with them.

    Raises
    ------
    InputError
        If the method is unknown or the cut is absurd.
    """

    method: Method = Method.NETWORK
    sigma_cut_mm: float = SIGMA_CUT_MM
    camera: CameraOptions = field(default_factory=CameraOptions)
    part: str = ""
    stripe: StripeSettings | None = None
    excluded: frozenset[str] = frozenset()
    constrain_fan: bool = True
    adjust_camera: bool = False
    plane_stripe: StripeSettings | None = None
    accept_few_poses: bool = False
    channel: Channel | None = None

    def __post_init__(self) -> None:
        if self.method not in list(Method):
            raise InputError(
                Message(
                    "options.no_such_method",
                    "{method!r} is not {method2}",
                    method=self.method,
                    method2=" or ".join(Method),
                ),
                where="method",
            )
        object.__setattr__(self, "method", Method(self.method))
        if not 0 < self.sigma_cut_mm <= 10:
            raise InputError(
                Message(
                    "options.sigma_cut_range",
                    "{sigma_cut_mm:g} is not above 0 and at most 10 mm",
                    sigma_cut_mm=self.sigma_cut_mm,
                ),
                where="sigma-cut",
            )

    @property
    def for_camera(self) -> CameraSettings:
        """What the camera's calibration is told of it."""
        return CameraSettings(self.camera, frozenset(self.excluded_in("camera")))

    @property
    def for_planes(self) -> PlanesSettings:
        """What the calibration of the light planes is told of it."""
        excluded = frozenset(self.excluded_in("planes"))
        return PlanesSettings(
            self.plane_stripe, excluded, self.constrain_fan, self.adjust_camera, self.accept_few_poses
        )

    @property
    def for_scan(self) -> ScanSettings:
        """What a scan, or a profile, is told of it."""
        excluded = frozenset(self.excluded_in("scan"))
        return ScanSettings(self.method, self.sigma_cut_mm, self.stripe, excluded, self.plane_stripe)

    def excluded_in(self, part: str) -> tuple[str, ...]:
        """The pictures left out by hand of one part (camera, planes or scan), in the order of their names."""
        return tuple(sorted(name for name in self.excluded if name.startswith(part + "/")))


@dataclass(frozen=True, slots=True)
class StatedTilt:
    """How the faces stand, where one line does not show it.

    `stage` is the pose of the plane target ("planes/pose03") that lay on what the part stands on; "": the light plane
    stands at right angles on the faces. `sd` is the standard uncertainty in rad; None: as usual for a stage.
    """

    stage: str = ""
    sd: float | None = None


def stated_stripe(width_px: float | None, contrast: float | None, where: str) -> StripeSettings | None:
    """The stripe that was stated, None where nothing was; InputError that names `where` for anything but both or none.

    Parameters
    ----------
    width_px, contrast
        As StripeSettings has them; None: to be chosen from the pictures.
    where
        What they are called where they were stated.
    """
    if width_px is None and contrast is None:
        return None
    if width_px is not None and contrast is not None and 0 < width_px < math.inf and 0 < contrast < math.inf:
        return StripeSettings(width_px, contrast)
    raise InputError(
        Message("options.stripe_incomplete", "width and contrast of the stripes belong together, both above 0"),
        where=where,
        todo=Message("advice.give_both_or_neither", "give both, or neither to have them chosen from the pictures"),
    )
