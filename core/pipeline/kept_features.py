"""What a scan's pictures showed, kept from the measurement before: solving again with other settings needs no picture.

The pictures are known by their bytes, so nothing is taken over that they might not show; and the program by its own
text, so that a version that looks at pictures in another way looks at them again.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from functools import cache
from importlib.resources import files
from pathlib import Path

from core.errors import InputError
from core.files.pictures import read_bytes
from core.files.recording_set import RecordingSet
from core.files.scan_file import read_scan
from core.pipeline.options import Options
from core.progress import Progress, silent, steps
from core.scan.features import ScanFeatures

_SEES = ("acquire", "image", "scan")
"""The rooms that read pictures and make features of them."""


def kept_features(
    scan: Path, found: RecordingSet, options: Options, progress: Progress = silent
) -> ScanFeatures | None:
    """The features that `scan`, an earlier scan.npz, holds, if they are those of these very pictures and settings.

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
    pictures = _pictures(found, options)
    for path in steps(pictures, progress, "comparing the pictures", len(pictures)):
        try:
            found.hashes[found.name_of(path)] = hashlib.sha256(read_bytes(path)).hexdigest()
        except InputError:
            continue  # as it was then, or the key differs
    return earlier.features if earlier.features_key == features_key(found, options) else None


def features_key(found: RecordingSet, options: Options) -> str:
    """What the features of a scan rest on, in 16 hex digits; the hashes of its pictures must have been taken."""
    pictures = [(found.name_of(path), found.hashes.get(found.name_of(path), "")) for path in _pictures(found, options)]
    rests_on = {
        "program": _program(),
        "channel": found.rig.channel,
        "stripe": asdict(options.stripe) if options.stripe else None,
        "frames": [found.name_of(path) for path in found.frames],
        "pictures": pictures,
    }
    return hashlib.sha256(json.dumps(rests_on).encode()).hexdigest()[:16]


def _pictures(found: RecordingSet, options: Options) -> list[Path]:
    """The reference and the frames that are not left out by hand."""
    frames = [path for path in found.frames if found.name_of(path) not in options.excluded]
    return frames if found.reference is None else [found.reference, *frames]


@cache
def _program() -> str:
    """The text of all that makes features of pictures, as a hash."""
    digest = hashlib.sha256()
    for room in _SEES:
        sources = [source for source in files("core").joinpath(room).iterdir() if source.name.endswith(".py")]
        for source in sorted(sources, key=lambda source: source.name):
            digest.update(source.read_bytes())
    return digest.hexdigest()
