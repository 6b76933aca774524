"""GenICam cameras, whichever driver speaks to them: a GenTL producer through harvesters, or Aravis."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

from core.acquire.channel import Channel
from core.acquire.drivers.genicam_features import (
    TRIGGER,
    Features,
    apply,
    capabilities_of,
    is_software_triggered,
    make_grey,
)
from core.acquire.drivers.pixel_formats import decode
from core.acquire.source import Capabilities, Frame, Lasers, Shown, SourceSettings, Unplugged
from core.errors import InputError, WrongValue
from core.messages import Message

BUFFERS = 8
"""Frames that a driver keeps for a reader that is a little late; it counts those it has no room for."""
ASK_AGAIN_S = 5.0
"""A picture that was asked for and has not come for so long is asked for again."""
_MOST_16_BIT = 0xFFFF
"""The largest frame number of cameras that count in 16 bits; 0 or 1 follows."""


class DriverError(Exception):
    """Error of a driver, in its own words."""


@dataclass(frozen=True, eq=False, slots=True)
class Grabbed:
    """Frame as a driver returns it.

    Parameters
    ----------
    data
        The buffer, flat, no longer the driver's; None if a part of it was lost on the way.
    pixel_format, width, height
        What it holds.
    number
        The camera's own number of the frame; None if it does not count.
    time_s
        When the camera exposed it, by a clock of its own; None if it does not say.
    """

    data: NDArray[Any] | None
    pixel_format: str = ""
    width: int = 0
    height: int = 0
    number: int | None = None
    time_s: float | None = None


class Driver(Protocol):
    """Open camera of a driver. All but `close` may raise DriverError."""

    name: str
    """What a person calls the camera."""
    features: Features

    def start(self) -> None:
        """Start the camera taking pictures."""

    def stop(self) -> None:
        """Stop the camera taking pictures, so that their format can be changed."""

    def grab(self, timeout_s: float) -> Grabbed | None:
        """Return the camera's next frame; None if there is none within `timeout_s`."""

    def gone(self) -> bool:
        """Whether the camera is disconnected; asked when no frame comes."""

    def close(self) -> None:
        """Release the camera, whether it is still connected or not."""


class FrameNumbers:
    """Counter of the gaps in a camera's frame numbers.

    Numbers of 16 bits (GigE Vision 1) begin again at 1 behind 65535, 0 being none. A number that goes back in another
    way is a camera that counts anew: nothing is known to be missing then.
    """

    def __init__(self) -> None:
        self._last: int | None = None

    def restart(self) -> None:
        """Forget the last frame number: no frame counts as missing before the next one."""
        self._last = None

    def missing_before(self, number: int) -> int:
        """Count the frames missing between the number of the last call and `number`; 0 if unknown."""
        last, self._last = self._last, number
        if last is None or number == last:
            return 0
        if number > last:
            return number - last - 1
        wrapped = _MOST_16_BIT - last + max(number - 1, 0)
        return wrapped if last <= _MOST_16_BIT and wrapped < _MOST_16_BIT // 2 else 0


class GenICamSource:
    """GenICam camera as a :class:`core.acquire.source.FrameSource`.

    The camera's own settings are kept where nothing else is said; colour is reduced to grey, where the camera gives no
    grey itself.

    Parameters
    ----------
    name
        What it is called until it is open.
    connect
        Finds the camera and opens it; InputError says what to do if there is none.
    channel
        Which colour to take.
    clock
        Time in s that only runs forward, for cameras that do not tell theirs.
    """

    def __init__(
        self,
        name: str,
        connect: Callable[[], Driver],
        channel: Channel | None = None,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = name
        self._connect, self._channel, self._clock = connect, channel, clock
        self._wanted = SourceSettings()
        self._driver: Driver | None = None
        self._numbers = FrameNumbers()
        self._index = self._dropped = 0
        self._ask, self._ask_again_s = False, float("-inf")
        self._origin: float | None = None

    @property
    def capabilities(self) -> Capabilities:
        """Settings that the open camera has, with their limits; none while it is closed."""
        if self._driver is None:
            return Capabilities()
        try:
            return capabilities_of(self._driver.features)
        except DriverError as problem:
            raise self._gone(str(problem)) from problem

    def open(self) -> None:
        """Find the camera, open it and let it take pictures."""
        self.close()
        driver = self._connect()
        self.name = driver.name
        self._index = self._dropped = 0
        self._origin = None
        try:
            make_grey(driver.features, self.name)
            apply(driver.features, self._wanted, self.name)
            self._start(driver)
        except DriverError as problem:
            driver.close()
            todo = Message("advice.close_other_programs", "see that no other program uses it, then try again")
            raise InputError(
                Message("camera.cannot_be_opened_why", "the camera cannot be opened ({reason})", reason=str(problem)),
                where=self.name,
                todo=todo,
            ) from problem
        except BaseException:
            driver.close()
            raise
        self._driver = driver

    def configure(self, settings: SourceSettings) -> None:
        """Change these camera settings, now or when it is opened; it stops for a moment if one of them needs it."""
        driver = self._driver
        if driver is not None:
            try:
                self._tell(driver, settings)
            except DriverError as problem:
                if driver.gone():
                    raise self._gone(str(problem)) from problem
                raise InputError(
                    Message(
                        "camera.setting_refused_why",
                        "the camera does not take this setting ({reason})",
                        reason=str(problem),
                    ),
                    where=self.name,
                ) from problem
        self._wanted = self._wanted.updated(settings)

    def prepare(self, step: Shown) -> None:
        """Do nothing: a real camera sees whatever is in front of it."""

    def lasers(self, lasers: Lasers) -> bool:
        """Return False: the user must switch the lasers of a real rig."""
        return False

    def read(self, timeout_s: float) -> Frame | None:
        """Return the camera's next frame; None if none comes within `timeout_s`; Unplugged when the camera is gone."""
        driver = self._driver
        if driver is None:
            raise self._unplugged(Message("camera.not_open", "it is not open"))
        try:
            if self._ask and self._clock() >= self._ask_again_s:
                driver.features.run(TRIGGER)
                self._ask_again_s = self._clock() + ASK_AGAIN_S
            grabbed = driver.grab(timeout_s)
            if grabbed is None:
                if driver.gone():
                    raise self._gone(Message("camera.pulled_out", "it was pulled out"))
                return None
        except DriverError as problem:
            raise self._gone(str(problem)) from problem
        self._ask_again_s = float("-inf")
        return self._frame(grabbed)

    def close(self) -> None:
        """Stop the camera and release it."""
        driver, self._driver = self._driver, None
        if driver is not None:
            driver.close()

    def _tell(self, driver: Driver, settings: SourceSettings) -> None:
        if not settings.stops_the_stream:
            apply(driver.features, settings, self.name)
            return
        driver.stop()
        try:
            apply(driver.features, settings, self.name)
        finally:
            self._start(driver)

    def _start(self, driver: Driver) -> None:
        self._numbers.restart()
        self._ask, self._ask_again_s = is_software_triggered(driver.features), float("-inf")
        driver.start()

    def _frame(self, grabbed: Grabbed) -> Frame | None:
        """The picture, or None if the connection lost a part of it."""
        lost = 0 if grabbed.number is None else self._numbers.missing_before(grabbed.number)
        self._dropped += lost + (grabbed.data is None)
        index = self._index + lost
        self._index = index + 1
        time_s = self._clock() if grabbed.time_s is None else grabbed.time_s
        self._origin = time_s if self._origin is None else self._origin
        if grabbed.data is None:
            return None
        try:
            picture = decode(grabbed.data, grabbed.pixel_format, grabbed.width, grabbed.height, self._channel)
        except WrongValue as wrong:
            raise InputError(
                Message("camera.picture_damaged", "the picture is damaged ({wrong})", wrong=wrong.what), where=self.name
            ) from wrong
        return Frame(picture, index, time_s - self._origin, self._dropped)

    def _gone(self, why: Message | str) -> Unplugged:
        self.close()
        return self._unplugged(why)

    def _unplugged(self, why: Message | str) -> Unplugged:
        return Unplugged(
            Message("camera.stopped_why", "the camera sends no pictures any more ({why})", why=why),
            where=self.name,
            todo=Message("advice.plug_in_again", "plug it in again"),
        )
