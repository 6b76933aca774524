"""What a camera can be told, and what one of them lets itself be told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from core.errors import InputError
from core.messages import Message, label

LARGEST_REGION_PX = 65_536
"""Furthest column or row of a region in pixels: no sensor is larger, and a larger number is a slip of the pen."""

FREE_RUNNING = "Off"
"""The trigger of a camera that takes pictures by itself."""
SOFTWARE = "Software"
"""The trigger with which reading a picture also requests it."""

TITLES = {
    "exposure_ms": (label("exposure time"), "ms"),
    "gain_db": (label("gain"), "dB"),
    "rate_hz": (label("frame rate"), "Hz"),
    "trigger": (label("trigger"), ""),
    "pixel_format": (label("pixel format"), ""),
    "region": (label("region"), ""),
}
"""What each setting is called, and its unit."""

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Region:
    """Part of the sensor that is read: column and row of its first pixel, width and height, in pixels.

    Calibrations hold for the region their pictures were taken with.

    Raises
    ------
    InputError
        If it is empty, or not within any sensor.
    """

    left: int
    top: int
    width: int
    height: int

    def __post_init__(self) -> None:
        ends = (self.left + self.width, self.top + self.height)
        if min(self.left, self.top) < 0 or min(self.width, self.height) < 1 or max(ends) > LARGEST_REGION_PX:
            raise InputError(
                Message("source.no_region", "{region} is not within a sensor", region=self.message),
                where="region",
                todo=Message("advice.give_part_of_sensor", "give columns and rows of it"),
            )

    @property
    def message(self) -> Message:
        """Text that tells size and place of the region, for messages."""
        return Message(
            "source.region", "{width} × {height} pixels from column {left}, row {top}",
            width=self.width, height=self.height, left=self.left, top=self.top,
        )  # fmt: skip

    def __str__(self) -> str:
        return str(self.message)


@dataclass(frozen=True, slots=True)
class SourceSettings:
    """Settings of a camera; None leaves one as it is.

    Parameters
    ----------
    exposure_ms
        Exposure time in ms.
    gain_db
        Amplification in dB.
    rate_hz
        Frames per second; for a replay, 0 means as fast as they are read.
    trigger
        "Off": pictures are taken by themselves. "Software": whoever reads a picture asks for it. Else the camera's own
        name of a line, such as "Line1": each pulse there takes one.
    pixel_format
        GenICam's name, such as "Mono8" or "Mono12".
    region
        The part of the sensor that is read.

    Raises
    ------
    InputError
        If a value is out of any camera's range.
    """

    exposure_ms: float | None = None
    gain_db: float | None = None
    rate_hz: float | None = None
    trigger: str | None = None
    pixel_format: str | None = None
    region: Region | None = None

    def __post_init__(self) -> None:
        if self.exposure_ms is not None and not 0 < self.exposure_ms <= 60_000:
            raise InputError(
                Message(
                    "source.exposure_range",
                    "{exposure_ms:g} ms is not above 0 and at most 60 000 ms",
                    exposure_ms=self.exposure_ms,
                ),
                where="exposure",
            )
        if self.gain_db is not None and not -40 <= self.gain_db <= 80:
            raise InputError(
                Message("source.gain_range", "{gain_db:g} dB is not between -40 and 80 dB", gain_db=self.gain_db),
                where="gain",
            )
        if self.rate_hz is not None and not 0 <= self.rate_hz <= 10_000:
            raise InputError(
                Message("source.rate_range", "{rate_hz:g} Hz is not between 0 and 10 000 Hz", rate_hz=self.rate_hz),
                where="frame rate",
            )
        for name in ("trigger", "pixel_format"):
            word = getattr(self, name)
            if word is not None and not (word.isascii() and word.isalnum()):
                raise InputError(
                    Message("source.no_such_word", "{word!r} is no {titles}", word=word, titles=TITLES[name][0]),
                    where=TITLES[name][0],
                )

    @property
    def stated(self) -> dict[str, Any]:
        """Those settings, by name, that are not None."""
        pairs = ((field.name, getattr(self, field.name)) for field in fields(self))
        return {name: value for name, value in pairs if value is not None}

    @property
    def stops_the_stream(self) -> bool:
        """Whether a camera must stop taking pictures to change these settings."""
        return not (self.trigger is None and self.pixel_format is None and self.region is None)

    def only(self, names: Sequence[str]) -> SourceSettings:
        """Keep the settings whose names are in `names`; the others become None."""
        return SourceSettings(**{name: value for name, value in self.stated.items() if name in names})

    def updated(self, newer: SourceSettings) -> SourceSettings:
        """Replace settings by those of `newer` that are not None."""
        return replace(self, **newer.stated)


@dataclass(frozen=True, slots=True)
class Capabilities:
    """Settings that a source has, with their limits.

    Parameters
    ----------
    exposure_ms, gain_db, rate_hz
        Smallest and largest value; None if it cannot be told.
    triggers, pixel_formats
        What can be chosen; () if nothing can.
    sensor
        (width, height) within which a region can be chosen; None if it cannot.
    row_time_us
        Time from one row to the next as the camera tells it, in µs: 0 of a global shutter; None if it does not.
    """

    exposure_ms: Limits | None = None
    gain_db: Limits | None = None
    rate_hz: Limits | None = None
    triggers: tuple[str, ...] = ()
    pixel_formats: tuple[str, ...] = ()
    sensor: tuple[int, int] | None = None
    row_time_us: float | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the settings in SourceSettings that the source can change."""
        there = {
            "exposure_ms": self.exposure_ms is not None,
            "gain_db": self.gain_db is not None,
            "rate_hz": self.rate_hz is not None,
            "trigger": bool(self.triggers),
            "pixel_format": bool(self.pixel_formats),
            "region": self.sensor is not None,
        }
        return tuple(name for name, can in there.items() if can)

    def check(self, settings: SourceSettings, where: str) -> None:
        """Raise InputError if one of `settings` that is not None cannot be set; messages call the source `where`."""
        for name, value in settings.stated.items():
            if name not in self.names:
                raise no_such_setting(name, where)
            match name:
                case "exposure_ms" | "gain_db" | "rate_hz":
                    check_number(name, value, getattr(self, name), where)
                case "trigger":
                    check_choice(name, value, self.triggers, where)
                case "pixel_format":
                    check_choice(name, value, self.pixel_formats, where)
                case "region" if self.sensor is not None:
                    check_region(value, self.sensor, where)


def no_such_setting(name: str, where: str) -> InputError:
    """Make the error that the source called `where` does not have the setting `name`."""
    return InputError(
        Message("source.setting_fixed", "the source does not let its {titles} be set", titles=TITLES[name][0]),
        where=where,
        todo=Message("advice.leave_setting", "leave it as it is"),
    )


def check_number(name: str, value: float, limits: Limits, where: str) -> None:
    """Raise InputError unless `value` of the setting `name` is within `limits`; `where` names the source."""
    title, unit = TITLES[name]
    if not limits[0] <= value <= limits[1]:
        raise InputError(
            Message(
                "source.value_range",
                "the {title} of {value:g} {unit} is not between {limits:g} and {limits2:g} {unit}",
                title=title,
                value=value,
                unit=unit,
                limits=limits[0],
                limits2=limits[1],
            ),
            where=where,
        )


def check_choice(name: str, value: str, choices: tuple[str, ...], where: str) -> None:
    """Raise InputError unless `value` of the setting `name` is one of `choices`; `where` names the source."""
    if value not in choices:
        raise InputError(
            Message(
                "source.value_not_one_of",
                "the {titles} {value} is not one of {choices}",
                titles=TITLES[name][0],
                value=value,
                choices=tuple(choices),
            ),
            where=where,
        )


def check_region(region: Region, sensor: tuple[int, int], where: str) -> None:
    """Raise InputError unless `region` lies within a `sensor` of (width, height) px; `where` names the source."""
    if region.left + region.width > sensor[0] or region.top + region.height > sensor[1]:
        raise InputError(
            Message(
                "source.region_beyond_sensor",
                "{region} is not within its {sensor} × {sensor2}",
                region=region.message,
                sensor=sensor[0],
                sensor2=sensor[1],
            ),
            where=where,
        )
