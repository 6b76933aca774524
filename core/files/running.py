"""Whether a program of this computer still runs, by the number of its process."""

from __future__ import annotations

import ctypes
import os
import sys
from datetime import UTC, datetime, timedelta
from typing import Any, Protocol

_ACCESS = 0x00100000 | 0x1000
"""Windows: SYNCHRONIZE, to look whether it has ended, and PROCESS_QUERY_LIMITED_INFORMATION, to ask when it began."""
_WAIT_TIMEOUT = 0x102
"""Windows: what WaitForSingleObject returns for a process that has not ended."""
_ACCESS_DENIED = 5
"""Windows: the error for a process that is there and belongs to another user."""
_FILETIME_BEGAN = datetime(1601, 1, 1, tzinfo=UTC)
_CLOCK_S = 2.0
"""What a file says and what the system says of one moment differ by less."""


class Kernel(Protocol):
    """Functions of Windows that are used: those of kernel32, and the error of the last one."""

    def OpenProcess(self, access: int, inherit: bool, pid: int, /) -> int | None: ...
    def WaitForSingleObject(self, handle: int, ms: int, /) -> int: ...
    def GetProcessTimes(self, handle: int, created: Any, ended: Any, kernel: Any, user: Any, /) -> int: ...
    def CloseHandle(self, handle: int, /) -> int: ...
    def last_error(self) -> int: ...


def is_running(pid: int, since: datetime | None = None) -> bool:
    """Whether the process `pid` runs now, and, if `since` is given, ran already then: numbers are reused.

    `os.kill(pid, 0)`, which asks elsewhere, would end the process on Windows.
    """
    if pid <= 0:
        return False
    if sys.platform == "win32":
        return runs_on_windows(_kernel(), pid, since)
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True  # it is somebody else's
    return True


def runs_on_windows(kernel: Kernel, pid: int, since: datetime | None) -> bool:
    """Whether the process `pid` runs on Windows now, and ran at `since`, if that is given.

    References
    ----------
    Microsoft, Win32 API: OpenProcess, WaitForSingleObject, GetProcessTimes.
    """
    handle = kernel.OpenProcess(_ACCESS, False, pid)
    if not handle:
        return kernel.last_error() == _ACCESS_DENIED
    try:
        if kernel.WaitForSingleObject(handle, 0) != _WAIT_TIMEOUT:
            return False
        times = [ctypes.c_uint64() for _ in range(4)]
        if since is None or not kernel.GetProcessTimes(handle, *map(ctypes.byref, times)):
            return True
        began = _FILETIME_BEGAN + timedelta(microseconds=times[0].value // 10)
        return began <= since + timedelta(seconds=_CLOCK_S)
    finally:
        kernel.CloseHandle(handle)


if sys.platform == "win32":

    def _kernel() -> Kernel:
        library = ctypes.WinDLL("kernel32", use_last_error=True)
        library.OpenProcess.restype = ctypes.c_void_p
        for name in ("WaitForSingleObject", "CloseHandle"):
            getattr(library, name).argtypes = [ctypes.c_void_p, *([ctypes.c_uint32] if name[0] == "W" else [])]
        library.GetProcessTimes.argtypes = [ctypes.c_void_p] * 5
        library.last_error = ctypes.get_last_error
        return library  # type: ignore[return-value]
