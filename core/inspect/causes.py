"""What makes a measured value uncertain, as the rows of uncertainty budgets name it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from core.messages import Message, plain


class Cause(Enum):
    """Cause of uncertainty that the program has a name for; what is done with a row of a budget is decided by it."""

    POINT_NOISE = Message("inspection.cause_point_noise", "noise, hand laser")
    SWEEP_PLANES = Message("inspection.cause_sweep_planes", "position, hand laser")
    FAN_SPECKLE = Message("inspection.cause_fan_speckle", "noise, fixed laser")
    FORM = Message("inspection.cause_form", "form of the faces")
    UNEVEN_LIGHT = Message("inspection.cause_uneven_light", "light that lies unevenly on the curved surface")
    SAMPLING = Message("inspection.cause_sampling", "which stripes were scanned (range of 95 %)")
    SKEWED_LIGHT = Message("inspection.cause_skewed_light", "light that comes from below the surface, or to one side")
    LIGHT_FROM_BELOW = Message(
        "inspection.cause_light_from_below", "light from below the surface, as far as nothing excludes it"
    )
    LIGHT_FROM_BELOW_ASSUMED = Message(
        "inspection.cause_light_from_below_assumed",
        "light from below the surface, as far as nothing excludes it (material assumed)",
    )
    FORM_NOISE = Message("inspection.cause_form_noise", "noise of points, light planes and calibrations in the form")
    FORM_SMOOTHED = Message("inspection.cause_form_smoothed", "peaks of the form that smoothing takes")
    FACETS = Message("inspection.cause_facets", "flat triangles in place of the nominal surface's curved faces")
    FACE_TILT = Message("inspection.cause_face_tilt", "tilt of the faces against the light plane")

    CAMERA = Message("inspection.cause_camera", "camera calibration")
    FAN_CALIBRATION = Message("inspection.cause_fan", "fan calibration")
    FAN_ASSUMED = Message("inspection.cause_fan_assumed", "fan calibration (flatness of the plane target assumed)")
    BENT_LIGHT = Message("inspection.cause_bent_light", "light of the fan that lies in no planes")
    SCALE = Message("inspection.cause_scale", "scale of the targets")
    SCALE_ASSUMED = Message("inspection.cause_scale_assumed", "scale of the targets (assumed)")
    CHANGE = Message("inspection.cause_change", "change since the calibration")
    READJUSTED = Message("inspection.cause_readjusted", "change since the calibration, re-adjusted")
    CHANGE_CHARTED = Message(
        "inspection.cause_change_charted", "change since the calibration (control chart of the rig)"
    )
    CHANGE_ASSUMED = Message("inspection.cause_change_assumed", "change since the calibration (assumed)")
    KNOWN_POSE = Message("inspection.cause_known_pose", "known planes: pose")
    KNOWN_FLATNESS = Message("inspection.cause_known_flatness", "known planes: flatness")
    KNOWN_FLATNESS_ASSUMED = Message("inspection.cause_known_flatness_assumed", "known planes: flatness (assumed)")
    KNOWN_SIZE = Message("inspection.cause_known_size", "known planes: size")
    KNOWN_SIZE_ASSUMED = Message("inspection.cause_known_size_assumed", "known planes: size (assumed)")
    SKEWED_FAN = Message("inspection.cause_skewed_fan", "light of the fan, skewed otherwise than in its calibration")

    JOINT_MARKS = Message("inspection.cause_joint_marks", "joint: marks")
    JOINT_CARRIER = Message("inspection.cause_joint_carrier", "joint: carrier")
    JOINT_TEMPERATURE = Message("inspection.cause_joint_temperature", "joint: carrier's temperature")
    JOINT_TEMPERATURE_ASSUMED = Message(
        "inspection.cause_joint_temperature_assumed", "joint: carrier's temperature (assumed)"
    )
    JOINT_DEPTH_BIAS = Message("inspection.cause_joint_depth_bias", "joint: common depth bias (twice)")
    JOINT_DEPTH_BIAS_ASSUMED = Message(
        "inspection.cause_joint_depth_bias_assumed", "joint: common depth bias (twice; material assumed)"
    )

    PART_OFFSET = Message("inspection.cause_part_offset", "how far below its surface the part's material is seen")
    SPRAY = Message("inspection.cause_spray", "layer of spray on the part")
    SPRAY_ASSUMED = Message("inspection.cause_spray_assumed", "layer of spray on the part (assumed)")

    PART_TEMPERATURE = Message("inspection.cause_part_temperature", "temperature of the part")
    PART_EXPANSION = Message("inspection.cause_part_expansion", "expansion coefficient of the part")
    PART_TEMPERATURE_ASSUMED = Message("inspection.cause_part_temperature_assumed", "temperature of the part (assumed)")
    PART_EXPANSION_ASSUMED = Message(
        "inspection.cause_part_expansion_assumed", "expansion coefficient of the part (assumed)"
    )
    SCALE_TEMPERATURE = Message("inspection.cause_target_temperature", "temperature of the calibration target")
    SCALE_EXPANSION = Message("inspection.cause_target_expansion", "expansion coefficient of the calibration target")
    SCALE_TEMPERATURE_ASSUMED = Message(
        "inspection.cause_target_temperature_assumed", "temperature of the calibration target (assumed)"
    )
    SCALE_EXPANSION_ASSUMED = Message(
        "inspection.cause_target_expansion_assumed", "expansion coefficient of the calibration target (assumed)"
    )
    CERTIFICATE = Message("inspection.cause_certificate", "certificate of the master")
    MASTER_MEASURED = Message("inspection.cause_master_measured", "measurement of the master")

    OBSERVED = Message("study.cause_observed", "repeatability of the scans, above their stated noise")
    REPEATABILITY = Message("study.cause_repeatability", "repeatability of the scans")
    STATED = Message("study.cause_stated", "uncertainty stated by each scan, as if common to all")
    GIVEN = Message("study.cause_given", "common to all scans, as given")

    @property
    def message(self) -> Message:
        """Name of the cause in words."""
        return self.value

    def __str__(self) -> str:
        return str(self.message)


Source = Cause | Message
"""What a row of a budget comes from: a cause, or, as plans may state, words that are no cause of the program's."""


def message_of(source: Source) -> Message:
    """Return the words that name a source of uncertainty: a known `Cause`, or a name that a user gave it."""
    return source.message if isinstance(source, Cause) else source


OF_TARGET = frozenset(
    (Cause.SCALE_TEMPERATURE, Cause.SCALE_EXPANSION, Cause.SCALE_TEMPERATURE_ASSUMED, Cause.SCALE_EXPANSION_ASSUMED)
)
"""What the warmth of the calibration target does: the same to all that is measured with one calibration."""
IN_TWO_VIEWS = {
    Cause.LIGHT_FROM_BELOW: Cause.JOINT_DEPTH_BIAS,
    Cause.LIGHT_FROM_BELOW_ASSUMED: Cause.JOINT_DEPTH_BIAS_ASSUMED,
}
"""What light from below the surface is called in what reaches across views."""
FROM_BELOW = frozenset((*IN_TWO_VIEWS, *IN_TWO_VIEWS.values()))
"""Light from below the surface that is not seen."""
OF_BOARDS = frozenset(
    (
        Cause.KNOWN_POSE,
        Cause.KNOWN_FLATNESS,
        Cause.KNOWN_FLATNESS_ASSUMED,
        Cause.KNOWN_SIZE,
        Cause.KNOWN_SIZE_ASSUMED,
    )
)
"""What errs in the known planes of a scan: a calibration's id does not tell whether a master's scan had the same."""
CHANGES = frozenset((Cause.CHANGE, Cause.CHANGE_ASSUMED, Cause.CHANGE_CHARTED))
"""What may have changed since the calibration, where nothing on the day of the scan has measured it."""

CALIBRATIONS: Mapping[str, Cause] = {
    "camera": Cause.CAMERA,
    "fan": Cause.FAN_CALIBRATION,
    "assumed fan": Cause.FAN_ASSUMED,
    "bend": Cause.BENT_LIGHT,
    "scale": Cause.SCALE,
    "assumed scale": Cause.SCALE_ASSUMED,
    "change": Cause.CHANGE,
    "assumed change": Cause.CHANGE_ASSUMED,
    "charted change": Cause.CHANGE_CHARTED,
    "readjusted": Cause.READJUSTED,
    "skewed fan": Cause.SKEWED_FAN,
    "known pose": Cause.KNOWN_POSE,
    "known flatness": Cause.KNOWN_FLATNESS,
    "assumed known flatness": Cause.KNOWN_FLATNESS_ASSUMED,
    "known size": Cause.KNOWN_SIZE,
    "assumed known size": Cause.KNOWN_SIZE_ASSUMED,
}
"""By the sources of `core.calibrate.deviations`: what errs in all points of a scan at once."""

_EARLIER = {
    "centreline noise of the sweeps' points": Cause.POINT_NOISE,
    "light planes of the sweeps (network)": Cause.SWEEP_PLANES,
    "centreline noise of the fan's points (speckle)": Cause.FAN_SPECKLE,
    "form of the faces beyond the stated noise": Cause.FORM,
}
"""By what earlier versions called them, in files and plans."""
_KNOWN = {str(one): one for one in Cause} | {one.message.code: one for one in Cause} | _EARLIER


def known_cause(kept: Message) -> Source:
    """Find the cause of uncertainty whose code or English name a results file holds; return any other name as it is."""
    return _KNOWN.get(kept.code or str(kept), kept)


def cause_named(text: str) -> Source:
    """Find the cause of uncertainty with the English name `text`, as a plan has it; else return `text` as a message.

    Examples
    --------
    >>> cause_named("camera calibration").name, str(cause_named("my own reason"))
    ('CAMERA', 'my own reason')
    """
    return known_cause(plain(text))
