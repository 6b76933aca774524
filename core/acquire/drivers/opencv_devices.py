"""What OpenCV can capture from: how to find it, open it and speak to it."""

from __future__ import annotations

import platform
from math import log2
from pathlib import Path
from typing import Any

import cv2

NETWORK_TIMEOUT_MS = 5000
"""How long in ms a network camera may take to open, and to send a frame: OpenCV's own limit is 30 s."""

Capture = Any
"""What cv2.VideoCapture makes, or what stands in for it: isOpened, read, get, set, getBackendName, release."""


def capture_of(address: str) -> Capture:
    """OpenCV's capture of a camera's number, a file or a network address; "" is camera 0."""
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
    """What a person calls a source of this address."""
    if not address or address.isdigit():
        return f"camera {int(address or 0)}"
    return address if "://" in address else Path(address).name


def exposure_of(capture: Capture, exposure_ms: float) -> tuple[float, float]:
    """What a backend calls manual exposure, and `exposure_ms` in its unit."""
    if capture.getBackendName() in ("DSHOW", "MSMF"):
        return 0.25, log2(exposure_ms / 1000)
    return 1.0, exposure_ms * 10  # V4L2: units of 100 µs


def list_cameras(devices: Path = Path("/sys/class/video4linux")) -> list[tuple[str, str]]:
    """Numbers and names of the cameras that OpenCV could open."""
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
