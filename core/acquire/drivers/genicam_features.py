"""Settings of GenICam cameras by the names of EMVA's Standard Features Naming Convention, whatever the driver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from core.acquire.drivers.pixel_formats import is_grey, readable
from core.acquire.settings import (
    FREE_RUNNING,
    SOFTWARE,
    Capabilities,
    Limits,
    Region,
    SourceSettings,
    check_choice,
    check_number,
    check_region,
    no_such_setting,
)
from core.errors import InputError
from core.messages import Message

TRIGGER = "TriggerSoftware"
"""The command that asks for one picture."""

_NUMBERS: dict[str, tuple[tuple[str, ...], float]] = {
    "exposure_ms": (("ExposureTime", "ExposureTimeAbs"), 1000.0),
    "gain_db": (("Gain",), 1.0),
    "rate_hz": (("AcquisitionFrameRate", "AcquisitionFrameRateAbs"), 1.0),
}
"""The names a setting has had in the standard, the newest first, and the factor to the camera's unit."""

_BY_ITSELF = {"exposure_ms": "ExposureAuto", "gain_db": "GainAuto"}
_SIZES = (("SensorWidth", "WidthMax", "Width"), ("SensorHeight", "HeightMax", "Height"))


class Features(Protocol):
    """Features of a camera by name. Asking for one that it does not have is an error of the caller's."""

    def has(self, name: str) -> bool:
        """Whether the camera has a feature of this `name` that can be used now."""

    def number(self, name: str) -> float:
        """Return the value of the number feature `name`."""

    def limits(self, name: str) -> tuple[float, float, float]:
        """Return smallest value, largest value and step of the number feature `name`; step 0 if it has none."""

    def set_number(self, name: str, value: float) -> None:
        """Set the number feature `name` to `value`."""

    def entries(self, name: str) -> tuple[str, ...]:
        """List the entries of the choice feature `name` that can be chosen now."""

    def entry(self, name: str) -> str:
        """Return the entry chosen of the choice feature `name`."""

    def choose(self, name: str, entry: str) -> None:
        """Choose `entry` of the choice feature `name`."""

    def run(self, name: str) -> None:
        """Execute the command feature `name`."""


def capabilities_of(features: Features) -> Capabilities:
    """Read which settings a camera has now, with their limits."""
    limits = {name: _limits(features, name) for name in _NUMBERS}
    can_trigger = features.has("TriggerMode") and features.has("TriggerSource")
    return Capabilities(
        exposure_ms=limits["exposure_ms"],
        gain_db=limits["gain_db"],
        rate_hz=limits["rate_hz"],
        triggers=(FREE_RUNNING, *_trigger_lines(features)) if can_trigger else (),
        pixel_formats=readable(features.entries("PixelFormat")) if features.has("PixelFormat") else (),
        sensor=sensor_size(features),
        row_time_us=row_time_us(features),
    )


def make_grey(features: Features, where: str) -> str:
    """Set a camera to a grey pixel format, else to a readable colour one, and return its name.

    Raises
    ------
    InputError
        If it gives neither.
    """
    now = features.entry("PixelFormat")
    offered = readable((now, *features.entries("PixelFormat")))
    if is_grey(now):
        return now
    if not offered:
        raise InputError(
            Message("camera.no_grey_levels", "the camera gives {now} and no grey levels", now=now),
            where=where,
            todo=Message("advice.set_mono8", "set it to Mono8"),
        )
    best = offered[0] if is_grey(offered[0]) or now not in offered else now
    if best != now:
        features.choose("PixelFormat", best)
    return best


def apply(features: Features, settings: SourceSettings, where: str) -> None:
    """Change those `settings` of a camera that are not None; messages call it `where`.

    It must not stream if they stop the stream.

    Raises
    ------
    InputError
        If it has no such setting, or does not take the value; what comes before it is set then.
    """
    if settings.pixel_format is not None:
        offered = readable(features.entries("PixelFormat")) if features.has("PixelFormat") else ()
        _must_have(bool(offered), "pixel_format", where)
        check_choice("pixel_format", settings.pixel_format, offered, where)
        features.choose("PixelFormat", settings.pixel_format)
    if settings.region is not None:
        _set_region(features, settings.region, where)
    if settings.trigger is not None:
        _set_trigger(features, settings.trigger, where)
    for name in _NUMBERS:
        value = getattr(settings, name)
        if value is not None and not (name == "rate_hz" and value == 0):
            _set_number(features, name, value, where)


def sensor_size(features: Features) -> tuple[int, int] | None:
    """Read (width, height) in px of the sensor; None if no region can be chosen on it."""
    if not (features.has("Width") and features.has("Height")):
        return None
    if features.limits("Width")[0] == features.limits("Width")[1] and not features.has("OffsetX"):
        return None
    sizes = [_largest(features, names) for names in _SIZES]
    return sizes[0], sizes[1]


def row_time_us(features: Features) -> float | None:
    """Read the time in µs from one row's exposure to the next; 0 of a global shutter; None if it is not stated.

    The standard has `SensorShutterMode`, but no time of a row: of a rolling shutter that is the time of the whole
    read-out, in µs, over its rows, where the camera has `SensorReadoutTime`. Rows that begin together and end one after
    another (`GlobalReset`) are neither.
    """
    mode = features.entry("SensorShutterMode") if features.has("SensorShutterMode") else ""
    if mode == "Global":
        return 0.0
    if mode != "Rolling" or not (features.has("SensorReadoutTime") and features.has("Height")):
        return None
    return features.number("SensorReadoutTime") / max(features.number("Height"), 1.0) or None


def is_software_triggered(features: Features) -> bool:
    """Whether the camera takes each picture only when the command TriggerSoftware requests it."""
    if not (features.has("TriggerMode") and features.has("TriggerSource")):
        return False
    return features.entry("TriggerMode") == "On" and features.entry("TriggerSource") == SOFTWARE


def _trigger_lines(features: Features) -> tuple[str, ...]:
    return tuple(name for name in features.entries("TriggerSource") if name.isalnum())


def _largest(features: Features, names: Sequence[str]) -> int:
    """The first of the sizes `names` that the camera has; of the last one its largest value."""
    for name in names[:-1]:
        if features.has(name):
            return int(features.number(name))
    return int(features.limits(names[-1])[1])


def _limits(features: Features, name: str) -> Limits | None:
    feature, factor = _feature(features, name)
    if not feature:
        return None
    low, high, _ = features.limits(feature)
    return low / factor, high / factor


def _feature(features: Features, name: str) -> tuple[str, float]:
    """What the camera calls a number and its factor; "" if it has none."""
    names, factor = _NUMBERS[name]
    return next((one for one in names if features.has(one)), ""), factor


def _set_number(features: Features, name: str, value: float, where: str) -> None:
    by_itself = _BY_ITSELF.get(name, "")
    if by_itself and features.has(by_itself) and "Off" in features.entries(by_itself):
        features.choose(by_itself, "Off")
    if name == "rate_hz" and features.has("AcquisitionFrameRateEnable"):
        features.set_number("AcquisitionFrameRateEnable", 1)
    feature, factor = _feature(features, name)
    _must_have(bool(feature), name, where)
    low, high, _ = features.limits(feature)
    check_number(name, value, (low / factor, high / factor), where)
    features.set_number(feature, min(max(value * factor, low), high))


def _set_trigger(features: Features, trigger: str, where: str) -> None:
    _must_have(features.has("TriggerMode") and features.has("TriggerSource"), "trigger", where)
    check_choice("trigger", trigger, (FREE_RUNNING, *_trigger_lines(features)), where)
    if features.has("TriggerSelector") and "FrameStart" in features.entries("TriggerSelector"):
        features.choose("TriggerSelector", "FrameStart")
    if trigger == FREE_RUNNING:
        features.choose("TriggerMode", "Off")
        return
    features.choose("TriggerSource", trigger)
    features.choose("TriggerMode", "On")


def _set_region(features: Features, region: Region, where: str) -> None:
    """Offsets to 0 first: a wide region does not fit behind an old offset."""
    sensor = sensor_size(features)
    if sensor is None:
        raise no_such_setting("region", where)
    check_region(region, sensor, where)
    shifts = {"OffsetX": region.left, "OffsetY": region.top}
    for name in shifts:
        if features.has(name):
            features.set_number(name, 0)
    wanted = {"Width": region.width, "Height": region.height}
    wanted |= {name: shift for name, shift in shifts.items() if shift or features.has(name)}
    for name, value in wanted.items():
        if not features.has(name):
            raise InputError(
                Message(
                    "camera.region_fixed",
                    "the camera's region begins at its first pixel: it has no {name}",
                    name=name,
                ),
                where=where,
            )
        _check_step(name, value, features.limits(name), where)
        features.set_number(name, value)


def _check_step(name: str, value: int, limits: tuple[float, float, float], where: str) -> None:
    low, high, step = limits
    if not low <= value <= high or (step > 1 and (value - low) % step):
        steps = f" in steps of {step:g}" if step > 1 else ""
        raise InputError(
            Message(
                "camera.region_range",
                "the region's {name} of {value} is not between {low:g} and {high:g}{steps}",
                name=name,
                value=value,
                low=low,
                high=high,
                steps=steps,
            ),
            where=where,
        )


def _must_have(there: bool, name: str, where: str) -> None:
    if not there:
        raise no_such_setting(name, where)
