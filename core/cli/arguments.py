"""What was typed, as the pipeline's options; what can be refused by it alone is, before anything else is begun."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from core.calibrate.camera.adjustment import CameraOptions
from core.cli.options import ChannelName
from core.files.atomic import make_folder
from core.files.recording.options import Options, stated_stripe
from core.files.recording.recording_set import (
    excluded_names,
    open_set,
    require_camera,
    require_outside,
    require_planes,
    require_scan,
)
from core.image.stripes.stripe import StripeSettings
from core.scan.method import Method


def options(
    method: Method = Method.NETWORK,
    sigma_cut: float = 0.05,
    *,
    camera: CameraOptions = CameraOptions(),
    part: str = "",
    stripe: StripeSettings | None = None,
    adjust_camera: bool = False,
    accept_few_poses: bool = False,
    channel: ChannelName | None = None,
) -> Options:
    """The pipeline's options from the command line's; InputError if one is absurd.

    `stripe` is that of all stripes, in the scan and on the plane target.
    """
    return Options(
        method,
        sigma_cut,
        camera,
        part,
        stripe,
        adjust_camera=adjust_camera,
        plane_stripe=stripe,
        accept_few_poses=accept_few_poses,
        channel=None if channel is None else channel.value,
    )


def camera_options(skew: bool | None, k3: bool | None) -> CameraOptions:
    """The camera model as the command line states it."""
    return CameraOptions(skew=skew, k3=k3)


def stripe(stripe_width: float, contrast: float) -> StripeSettings | None:
    """Width and contrast of stripes, None where they are to be chosen (0); InputError where only one is given."""
    return stated_stripe(stripe_width or None, contrast or None, "--stripe-width, --contrast")


def leaving_out(chosen: Options, folder: Path, names: Sequence[str] | None) -> Options:
    """The options with the pictures `names` of the set left out; InputError if the set has no such picture."""
    return replace(chosen, excluded=excluded_names(open_set(folder), names)) if names else chosen


def require_run(folder: Path, out: Path) -> None:
    """InputError if a set lacks anything that a whole run needs, or its results cannot be written to `out`."""
    found = open_set(folder)
    for require in (require_camera, require_planes, require_scan):
        require(found)
    require_outside(found, out)
    make_folder(out)
