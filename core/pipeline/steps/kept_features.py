"""What a scan's pictures showed, kept from the measurement before: solving again with other settings needs no picture.

The pictures are known by their bytes, so nothing is taken over that they might not show; and the program by its own
text, so that a version that looks at pictures in another way looks at them again.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from importlib.resources import files
from pathlib import Path

from core.errors import InputError
from core.files.pictures import read_bytes
from core.files.recording_set import RecordingSet
from core.files.scan_file import read_scan
from core.model import Camera
from core.pipeline.options import Options
from core.progress import Progress, silent, steps
from core.scan.features import ScanFeatures

_SEES = ("acquire", "image", "scan")
"""The rooms that read a scan's pictures and make features of them."""


def kept_features(
    scan: Path, found: RecordingSet, options: Options, camera: Camera, progress: Progress = silent
) -> ScanFeatures | None:
    """The features that `scan`, an earlier scan.npz, holds, if they are those of these pictures, settings and camera.

    Takes the hashes of the pictures, as reading them would.
    """
    if not scan.exists():
        return None
    try:
        earlier = read_scan(scan)
    except InputError:
        return None  # damaged: it will be replaced
    if not earlier.features_key:
        return None
    take_hashes(found, _pictures(found, options), progress)
    return earlier.features if earlier.features_key == features_key(found, options, camera) else None


def features_key(found: RecordingSet, options: Options, camera: Camera) -> str:
    """What the features of a scan rest on, in 16 hex digits; the hashes of its pictures must have been taken.

    The camera's distortion is one of it: centrelines are crossed without it.
    """
    pictures = [(found.name_of(path), found.hashes.get(found.name_of(path), "")) for path in _pictures(found, options)]
    rests_on = {
        "program": program_text(_SEES),
        "channel": found.rig.channel,
        "camera": [camera.matrix.tolist(), camera.distortion.tolist()],
        "stripe": asdict(options.stripe) if options.stripe else None,
        "frames": [found.name_of(path) for path in found.frames],
        "pictures": pictures,
    }
    return hashlib.sha256(json.dumps(rests_on).encode()).hexdigest()[:16]


def take_hashes(found: RecordingSet, pictures: Sequence[Path], progress: Progress = silent) -> None:
    """The hashes of pictures, as reading them would take them; one that cannot be read has none."""
    for path in steps(pictures, progress, "comparing the pictures", len(pictures)):
        with suppress(InputError):
            found.hashes[found.name_of(path)] = hashlib.sha256(read_bytes(path)).hexdigest()


def _pictures(found: RecordingSet, options: Options) -> list[Path]:
    """The reference and the frames that are not left out by hand."""
    frames = [path for path in found.frames if found.name_of(path) not in options.excluded]
    return frames if found.reference is None else [found.reference, *frames]


@cache
def program_text(rooms: tuple[str, ...]) -> str:
    """The text of some rooms of core, as a hash."""
    digest = hashlib.sha256()
    for room in rooms:
        sources = [source for source in files("core").joinpath(room).iterdir() if source.name.endswith(".py")]
        for source in sorted(sources, key=lambda source: source.name):
            digest.update(source.read_bytes())
    return digest.hexdigest()
