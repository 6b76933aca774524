"""Cameras, network streams and video files through OpenCV: how to find them, open them and speak to them."""

from __future__ import annotations

import platform
import threading
import time
from collections import deque
from collections.abc import Callable
from math import log2
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from core.acquire.channel import Channel
from core.acquire.grey import to_grey
from core.acquire.pace import Pace
from core.acquire.source import (
    Capabilities,
    Ended,
    Frame,
    Lasers,
    Picture,
    Shown,
    SourceChoice,
    SourceInfo,
    SourceSettings,
    Unplugged,
)
from core.acquire.source_kind import DEVICE, SourceKind
from core.errors import InputError
from core.messages import Message

NETWORK_TIMEOUT_MS = 5000
"""How long in ms a network camera may take to open, and to send a frame: OpenCV's own limit is 30 s."""

Capture = Any
"""What cv2.VideoCapture makes, or what stands in for it: isOpened, read, get, set, getBackendName, release."""


def capture_of(address: str) -> Capture:
    """Open OpenCV's capture of a camera number, a video file or a network address; "" is camera 0."""
    if not address or address.isdigit():
        return cv2.VideoCapture(int(address or 0))
    if "://" in address:
        limits = [
            cv2.CAP_PROP_OPEN_TIMEOUT_MSEC,
            NETWORK_TIMEOUT_MS,
            cv2.CAP_PROP_READ_TIMEOUT_MSEC,
            NETWORK_TIMEOUT_MS,
        ]
        return cv2.VideoCapture(address, cv2.CAP_FFMPEG, limits)
    return cv2.VideoCapture(address)


def opencv_name(address: str) -> str:
    """Make the displayed name of a source: "camera N" of a number, the name of a file, a network address as it is."""
    if not address or address.isdigit():
        return f"camera {int(address or 0)}"
    return address if "://" in address else Path(address).name


def exposure_of(capture: Capture, exposure_ms: float) -> tuple[float, float]:
    """Return the value that sets a capture to manual exposure, and `exposure_ms` in the unit of its backend."""
    if capture.getBackendName() in ("DSHOW", "MSMF"):
        return 0.25, log2(exposure_ms / 1000)
    return 1.0, exposure_ms * 10  # V4L2: units of 100 µs


def list_cameras(devices: Path = Path("/sys/class/video4linux")) -> list[tuple[str, str]]:
    """List numbers and names of the cameras that OpenCV could open."""
    if platform.system() == "Linux":
        nodes = sorted(devices.glob("video*"), key=lambda path: int(path.name.removeprefix("video")))
        pictures = [node for node in nodes if _said(node / "index") == "0"]  # the others carry data about the pictures
        return [(node.name.removeprefix("video"), _said(node / "name")) for node in pictures]
    return [(str(number), opencv_name(str(number))) for number in range(4) if _answers(number)]


def _said(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:  # unplugged this moment
        return ""


def _answers(number: int) -> bool:
    capture = cv2.VideoCapture(number)
    try:
        return bool(capture.isOpened())
    finally:
        capture.release()


WAITING = 3
"""Frames kept for a reader that is a little late; older ones are dropped and counted."""

JOIN_S = 3.0
"""How long in s a driver may take to return from its last picture, before its thread is left alone."""
FILE_RATE_HZ = 25.0
"""Frames per second of a film or camera that does not state its rate."""

CAMERA = Capabilities(exposure_ms=(0.001, 60_000.0), gain_db=(-40.0, 80.0), rate_hz=(0.0, 10_000.0))
FILE = Capabilities(rate_hz=(0.0, 10_000.0))


class OpenCVSource:
    """Camera, file or network stream of OpenCV as a :class:`core.acquire.source.FrameSource`.

    A camera or stream is read on a thread, so that the newest frames are there whenever they are asked for. OpenCV does
    not tell what a driver loses; `dropped` counts the frames that came and were not read in time. A video file is read
    frame by frame at its own rate, loses nothing, and ends.

    Parameters
    ----------
    address
        Number of a camera, path of a video file, or network address; "" is camera 0.
    channel
        Which colour to take; without it, colour is reduced to grey.
    capture
        Opens it.
    clock
        Time in s that only runs forward.
    """

    def __init__(
        self,
        address: str = "",
        channel: Channel | None = None,
        *,
        capture: Callable[[str], Capture] = capture_of,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = opencv_name(address)
        self._address, self._channel, self._make, self._clock = address, channel, capture, clock
        self._is_file = not address.isdigit() and Path(address).is_file()
        self._wanted = SourceSettings()
        self._capture: Capture | None = None
        self._grabber: _Grabber | None = None
        self._pace = Pace(FILE_RATE_HZ)
        self._count = 0
        self._origin = 0.0

    @property
    def capabilities(self) -> Capabilities:
        """Settings that can be tried: the rate, and for a camera exposure and gain, which its driver may refuse."""
        return FILE if self._is_file else CAMERA

    def open(self) -> None:
        """Open the camera, file or address; InputError says what to do if that fails."""
        self.close()
        capture = self._make(self._address)
        if not capture.isOpened():
            capture.release()
            raise self._cannot_open()
        self._capture, self._count, self._origin = capture, 0, self._clock()
        self._pace = Pace(capture.get(cv2.CAP_PROP_FPS) or FILE_RATE_HZ)
        try:
            self._apply(self._wanted)
        except InputError:
            self.close()
            raise
        if not self._is_file:
            self._grabber = _Grabber(capture, self._clock, self._origin)

    def configure(self, settings: SourceSettings) -> None:
        """Set exposure, gain (in the driver's own unit where it knows no dB) and rate, now or when it is opened."""
        self.capabilities.check(settings, self.name)
        if self._capture is not None:
            self._apply(settings)
        self._wanted = self._wanted.updated(settings)

    def prepare(self, step: Shown) -> None:
        """Do nothing: a real camera sees whatever is in front of it."""

    def lasers(self, lasers: Lasers) -> bool:
        """Return False: the user must switch the lasers of a real rig."""
        return False

    def read(self, timeout_s: float) -> Frame | None:
        """Return the next frame, None if none comes in time; Unplugged if the camera is gone, Ended after a file."""
        if self._is_file:
            return self._read_file(timeout_s)
        if self._grabber is None:
            raise self._unplugged()
        raw, index, time_s, dropped = self._grabber.take(timeout_s)
        if raw is None:
            if not self._grabber.lost:
                return None
            self.close()
            raise self._unplugged()
        return Frame(self._grey(raw), index, time_s, dropped)

    def close(self) -> None:
        """Stop reading and release the source."""
        if self._grabber is not None:
            self._grabber.stop()
        elif self._capture is not None:
            self._capture.release()
        self._grabber = self._capture = None

    def _read_file(self, timeout_s: float) -> Frame | None:
        if self._capture is None:
            raise Ended
        if not self._pace.wait(timeout_s):
            return None
        done, raw = self._capture.read()
        if not done:
            raise Ended
        index, self._count = self._count, self._count + 1
        return Frame(self._grey(raw), index, index / (self._pace.rate_hz or FILE_RATE_HZ), 0)

    def _grey(self, raw: Any) -> Picture:
        picture = to_grey(raw, self._channel)
        if picture.dtype not in (np.uint8, np.uint16):
            raise InputError(
                Message("camera.pictures_hold_values", "the pictures hold {dtype} values", dtype=str(picture.dtype)),
                where=self.name,
                todo=Message("advice.set_8_or_16_bit", "set 8 or 16 bit"),
            )
        return picture

    def _apply(self, settings: SourceSettings) -> None:
        if settings.rate_hz is not None and self._is_file:
            self._pace.rate_hz = settings.rate_hz
        elif settings.rate_hz:
            self._set(cv2.CAP_PROP_FPS, settings.rate_hz, "frame rate")
        if settings.exposure_ms is not None:
            manual, value = exposure_of(self._capture, settings.exposure_ms)
            self._set(cv2.CAP_PROP_AUTO_EXPOSURE, manual, "exposure time")
            self._set(cv2.CAP_PROP_EXPOSURE, value, "exposure time")
        if settings.gain_db is not None:
            self._set(cv2.CAP_PROP_GAIN, settings.gain_db, "gain")

    def _set(self, key: int, value: float, what: str) -> None:
        assert self._capture is not None
        if not self._capture.set(key, value):
            raise InputError(
                Message("camera.setting_refused", "the camera does not let its {what} be set", what=what),
                where=self.name,
                todo=Message("advice.set_in_its_program", "leave it as it is, or set it with the camera's own program"),
            )

    def _cannot_open(self) -> InputError:
        if self._is_file:
            return InputError(
                Message("camera.unreadable_video", "this is no video that can be read"), where=self._address
            )
        todo = Message(
            "advice.check_plug_and_programs", "see that it is plugged in, and close other programs that use it"
        )
        if "://" in self._address:
            todo = Message("advice.check_address", "see that the address is right and the camera is on the network")
        elif self._address and not self._address.isdigit():
            return InputError(Message("camera.no_such_video", "there is no such video file"), where=self._address)
        return InputError(Message("camera.cannot_be_opened", "the camera cannot be opened"), where=self.name, todo=todo)

    def _unplugged(self) -> Unplugged:
        return Unplugged(
            Message("camera.stopped", "the camera sends no pictures any more"),
            where=self.name,
            todo=Message("advice.plug_in_again", "plug it in again"),
        )


class _Grabber:
    """Reads a capture on a thread, keeps the newest frames, and lets go of the capture at the end."""

    def __init__(self, capture: Capture, clock: Callable[[], float], origin: float) -> None:
        self._capture, self._clock, self._origin = capture, clock, origin
        self._frames: deque[tuple[Any, int, float]] = deque()
        self._changed = threading.Condition()
        self._stopping = False
        self._dropped = 0
        self.lost = False
        """Whether the capture gives no more frames."""
        self._thread = threading.Thread(target=self._run, name="OpenCV camera", daemon=True)
        self._thread.start()

    def take(self, timeout_s: float) -> tuple[Any, int, float, int]:
        """The oldest waiting frame with its number, its time and the frames dropped; None instead of it if none."""
        with self._changed:
            self._changed.wait_for(lambda: self._frames or self.lost, timeout_s)
            if not self._frames:
                return None, 0, 0.0, self._dropped
            return *self._frames.popleft(), self._dropped

    def stop(self) -> None:
        """End the thread; a driver that does not return is left to let go of its camera by itself."""
        with self._changed:
            self._stopping = True
        self._thread.join(JOIN_S)

    def _run(self) -> None:
        index = 0
        try:
            while not self._stopping:
                done, raw = self._capture.read()
                with self._changed:
                    if not done:
                        self.lost = True
                        self._changed.notify_all()
                        return
                    if len(self._frames) == WAITING:
                        self._frames.popleft()
                        self._dropped += 1
                    self._frames.append((raw, index, self._clock() - self._origin))
                    self._changed.notify_all()
                index += 1
        finally:
            self._capture.release()


def _make(id_: str, rig: Any) -> OpenCVSource:
    return OpenCVSource(id_, None if rig is None else rig.live_channel)


def _list() -> tuple[SourceInfo, ...]:
    return tuple(
        SourceInfo(SourceChoice("opencv", number), name, opencv_name(number)) for number, name in list_cameras()
    )


KIND = SourceKind(
    "opencv",
    Message("source.opencv", "Camera or video"),
    Message("source.opencv_help", "A camera of this computer, a network camera, or a video file"),
    DEVICE,
    Message("source.opencv_device", "Number of the camera (0, 1, …) or its address (rtsp://…, http://…)"),
    Message("source.opencv_usual", "0, the first camera"),
    _make,
    _list,
)
