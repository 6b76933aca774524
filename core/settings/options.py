"""What a run can be told: the table of all settings of the steps. Each has a default that suits most sets.

project.json, the commands' flags and the forms of the window are made from the table; to add a setting is to add its
row here, and to read it in its step. Light to import: every command needs it for its help.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from core.acquire.channel import CHANNELS, Channel
from core.calibrate.camera.options import CameraOptions
from core.errors import InputError
from core.image.stripes.stripe import StripeSettings
from core.messages import Message, label
from core.scan.method import MOST_SIGMA_CUT_MM, SIGMA_CUT_MM, Method, ReconstructOptions
from core.settings.setting import (
    Choice,
    Flag,
    Kind,
    Names,
    Number,
    Row,
    Setting,
    Text,
    Values,
    Whether,
    described,
    rows,
)

_FREE = Choice((None, True, False), (label("free where it helps"), label("free"), label("zero")))
_CAMERA = {
    "skew": Setting(
        _FREE,
        title=label("Skew γ"),
        help="Whether the pixel's axes may be out of square.",
        flag=Flag(
            "--skew/--no-skew",
            help="Solve for the camera's skew γ, as the paper does, or fix it to 0. Without either it is solved for "
            "only where that predicts views left out better.",
        ),
        keyed=True,
    ),
    "k3": Setting(
        _FREE,
        title=label("Radial k₃"),
        help="For strongly distorting lenses; else it makes the rest less sure.",
        flag=Flag(
            "--k3/--no-k3",
            help="Solve for the third radial coefficient, or fix it to 0. Without either it is solved for only where "
            "that predicts views left out better.",
        ),
        keyed=True,
    ),
    "fixed": Setting(
        Names("^(k1|k2|p1|p2)$", label("a list of those of k1, k2, p1, p2 that are fixed to 0")), keyed=True
    ),
    "outliers": Setting(
        Choice(
            ("gross", "all", "keep"),
            (label("leave out gross ones"), label("leave out all that stand out"), label("keep all")),
            label('"keep", "gross" or "all"'),
        ),
        title=label("Misfits"),
        help="Views and corners that do not fit the others.",
        keyed=True,
    ),
}
STRIPE = Values(
    StripeSettings,
    {
        "width_px": Setting(
            Number(0.0, math.inf, "", "px", 1.0, 200.0, decimals=1, step=0.5),
            title=label("Stripe width"),
            help="From where the light rises out of the background to where it is gone.",
            flag=Flag(
                "--stripe-width",
                help="Visible width of the stripes; 0: chosen from the pictures.",
                value="PX",
                none=0.0,
            ),
        ),
        "contrast": Setting(
            Number(0.0, math.inf, "", label("grey levels"), 1.0, 65535.0, decimals=0, step=5.0),
            title=label("Stripe contrast"),
            help="Height above the background where the stripe is rather faint.",
            flag=Flag(
                "--contrast",
                help="Height of a rather faint stripe above its background; 0: chosen.",
                value="GREY",
                none=0.0,
            ),
        ),
    },
    optional=True,
    stated=label("a table of width_px and contrast, or null"),
)


@dataclass(frozen=True, slots=True)
class Options:
    """Settings of a run.

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

    method: Method = field(
        default=Method.NETWORK,
        metadata=described(
            Choice(
                tuple(Method),
                (label("Network"), label("Three crossings a frame")),
                " or ".join(f'"{method}"' for method in Method),
                Method,
            ),
            steps=("scan",),
            title=label("Method"),
            help="Network: all frames adjusted together, the most accurate. Three crossings: each frame by itself.",
            flag=Flag(
                "--method",
                help="network: all sweeps adjusted together. three-crossings: each frame from its own crossings with "
                "the fan, the paper's method, for comparison.",
                value="METHOD",
            ),
            refused=lambda method: Message(
                "options.no_such_method", "{method!r} is not {method2}", method=method, method2=" or ".join(Method)
            ),
            reported=(label("Method"), str),
            keyed=True,
        ),
    )
    sigma_cut_mm: float = field(
        default=SIGMA_CUT_MM,
        metadata=described(
            Number(
                0.0,
                MOST_SIGMA_CUT_MM,
                label("a length in mm above 0 and at most 10"),
                "mm",
                0.001,
                MOST_SIGMA_CUT_MM,
                decimals=3,
                step=0.01,
            ),
            steps=("scan", "plan"),
            title=label("Largest σ"),
            help="Points with a larger standard uncertainty of depth are left out.",
            flag=Flag("--sigma-cut", help="Leave out points with a larger standard uncertainty.", value="MM"),
            refused=lambda sigma_cut_mm: Message(
                "options.sigma_cut_range",
                "{sigma_cut_mm:g} is not above 0 and at most 10 mm",
                sigma_cut_mm=sigma_cut_mm,
            ),
            reported=(
                label("Points kept"),
                lambda limit_mm: Message("report.points_kept", "σ up to {limit_mm:g} mm", limit_mm=limit_mm),
            ),
            keyed=True,
        ),
    )
    camera: CameraOptions = field(
        default=CameraOptions(), metadata=described(Values(CameraOptions, _CAMERA), steps=("camera",))
    )
    part: str = field(default="", metadata=described(Text()))
    stripe: StripeSettings | None = field(
        default=None,
        metadata=described(
            STRIPE,
            steps=("scan", "profile"),
            title=label("Stripe found automatically"),
            help="Width and contrast of the stripes are taken from the pictures, for each laser.",
            keyed=True,
        ),
    )
    excluded: frozenset[str] = field(
        default=frozenset(),
        metadata=described(
            Names(
                "^(camera|planes|scan)/.",
                label('a list of pictures as "camera/view00.png", "planes/pose00", "scan/frame0000.png"'),
            )
        ),
    )
    constrain_fan: bool = field(
        default=True,
        metadata=described(
            Whether(),
            steps=("planes",),
            title=label("Hold the planes to one pencil"),
            help="Steadier; used only where the free planes agree with it.",
        ),
    )
    adjust_camera: bool = field(
        default=False,
        metadata=described(
            Whether(),
            steps=("planes",),
            flag=Flag(
                "--adjust-camera",
                help="Let the poses of the plane target correct the camera, in one adjustment with the fan: for a "
                "plane target of many points, or a camera calibrated from few views.",
            ),
        ),
    )
    plane_stripe: StripeSettings | None = field(
        default=None,
        metadata=described(
            STRIPE,
            steps=("planes", "check"),
            title=label("Stripe found automatically"),
            help="Width and contrast of the stripes are taken from each pose's own pictures.",
        ),
    )
    accept_few_poses: bool = field(
        default=False,
        metadata=described(
            Whether(),
            steps=("planes",),
            flag=Flag(
                "--accept-few-poses",
                help="Use laser planes even though fewer than half of the target's poses agree with them.",
            ),
        ),
    )
    channel: Channel | None = field(
        default=None,
        metadata=described(
            Choice((None, *CHANNELS)),
            steps=("planes", "check", "scan", "profile"),
            flag=Flag(
                "--channel",
                help="Look at the lasers in this channel of colour pictures, red, green or blue, or difference of "
                "two, red-green, green-red or blue-red; else as rig.toml says, or in the one that shows their light "
                "best.",
                value="CHANNEL",
            ),
            in_file=False,
        ),
    )

    def __post_init__(self) -> None:
        for row in rows(type(self)):
            value = row.value(self)
            if (complaint := row.setting.complaint(value)) is not None:
                assert row.setting.flag is not None
                raise InputError(complaint, where=row.setting.flag.name.removeprefix("--"))
            if isinstance(row.setting.kind, Choice) and row.setting.kind.type is not None:
                object.__setattr__(self, row.key, row.setting.kind.type(value))

    @property
    def for_camera(self) -> Options:
        """Settings of the camera's calibration; all others have their defaults."""
        return self._only("camera")

    @property
    def for_planes(self) -> Options:
        """Settings of the calibration of the laser planes; all others have their defaults."""
        return self._only("planes")

    @property
    def for_scan(self) -> Options:
        """Settings of a scan or a profile and of reading the check's pictures; all others have their defaults."""
        return self._only("scan", "check")

    @property
    def for_plan(self) -> Options:
        """Settings of a scan that is only planned; all others have their defaults."""
        return self._only("plan")

    def solving(self, row_time_us: float | None = None) -> ReconstructOptions:
        """Make the settings of solving a scan; a picture's rows follow each other by `row_time_us` µs."""
        return ReconstructOptions(self.method, self.sigma_cut_mm, row_time_us)

    def run_settings(self, step: str) -> Mapping[str, Any]:
        """Make the table of the settings of a `step`, by their names, for run.json."""
        told: dict[str, Any] = {}
        for row in settings_of(step):
            if row.setting.in_file:
                value = run_value(row.setting.kind, row.value(self))
                told |= {row.key: value} if row.is_one else value
        return {**told, **run_exclusions(self.excluded_in(step))}

    def excluded_in(self, part: str) -> tuple[str, ...]:
        """List the names, in order, of the pictures of `part` (camera, planes or scan) that are left out by hand."""
        return tuple(sorted(name for name in self.excluded if name.startswith(part + "/")))

    def _only(self, *steps: str) -> Options:
        """The same with what other steps are told as usual."""
        own = {row.key for step in steps for row in settings_of(step)}
        others = {row.key: row.default for row in rows(type(self)) if row.key not in own}
        excluded = frozenset(name for step in steps for name in self.excluded_in(step))
        return replace(self, **{**others, "excluded": excluded})


def settings_of(step: str) -> list[Row]:
    """List the settings that a step's result rests on, those that few other steps use first."""
    return sorted((row for row in rows(Options) if step in row.setting.steps), key=lambda row: len(row.setting.steps))


def run_value(kind: Kind, value: Any) -> Any:
    """Convert a setting's value for run.json: an object to a table, names sorted, None of an object to "automatic"."""
    if isinstance(kind, Values):
        if value is None:
            return "automatic"
        return {name: run_value(within.kind, getattr(value, name)) for name, within in kind.settings.items()}
    return sorted(value) if isinstance(kind, Names) else value


def run_exclusions(names: Collection[str]) -> Mapping[str, Any]:
    """Make run.json's entry of the pictures left out by hand, {"excluded": names in order}; {} if there are none."""
    return {"excluded": tuple(sorted(names))} if names else {}


@dataclass(frozen=True, slots=True)
class StatedTilt:
    """Tilt of the faces, where one line does not show it.

    `stage` is the pose of the plane target ("planes/pose03") that lay on what the part stands on; "": the light plane
    stands at right angles on the faces. `sd` is the standard uncertainty in rad; None: as usual for a stage.
    """

    stage: str = ""
    sd: float | None = None


def stated_stripe(width_px: float | None, contrast: float | None, where: str) -> StripeSettings | None:
    """Make the stripe of stated width in px and contrast; None if neither is stated, InputError if only one is.

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
