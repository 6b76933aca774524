"""Reading the pictures of a recording set, in the channel that shows the laser, with a hash of each for run.json."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain, islice
from pathlib import Path

from core.acquire.channel import Channel, is_difference
from core.acquire.folder import read_ahead
from core.acquire.grey import has_colours, to_grey
from core.errors import InputError
from core.files.pictures import Picture, decode_colours
from core.files.reading import file_hash, read_bytes
from core.files.recording.laser_channel import (
    LOOKED_AT,
    LaserChannel,
    LitPicture,
    against_background,
    laser_channel,
)
from core.files.recording.recording_set import RecordingSet
from core.image.background import sample_indices
from core.image.exclusion import Exclusion, Reason
from core.image.mosaic import ALL_SITES, Sites, even_grey, sites_of
from core.image.repeated import Repeats, pixels_of
from core.messages import Message
from core.progress import Progress, silent, steps
from core.stage_times import StageTimes, stage


class PictureReader:
    """Reader of the pictures of one set for one step, with a record of which it has read.

    Parameters
    ----------
    recording_set
        The set.
    channels
        By part: the channel in which its pictures are looked at, if it has been found already.

    Attributes
    ----------
    hashes
        SHA-256 of every picture read, by its name within the set.
    channels
        Those that were given, and those found since.
    """

    def __init__(self, recording_set: RecordingSet, channels: Mapping[str, LaserChannel] | None = None) -> None:
        self.recording_set = recording_set
        self.hashes: dict[str, str] = {}
        self.channels: dict[str, LaserChannel] = dict(channels or {})

    def of(self, recording_set: RecordingSet) -> PictureReader:
        """Make a reader for `recording_set`, a selection of the same pictures; both share hashes and channels."""
        other = PictureReader(recording_set)
        other.hashes, other.channels = self.hashes, self.channels
        return other

    def learn(self, hashes: Mapping[str, str], channels: Mapping[str, LaserChannel]) -> None:
        """Add the picture hashes and the parts' channels that another reader of the set has found."""
        self.hashes.update(hashes)
        self.channels.update(channels)

    def read(self, path: Path) -> Picture:
        """Read a picture of the set as grey levels (H, W) of its part's channel, and record its hash.

        Raises
        ------
        InputError
            If it is damaged or unreadable; names the file.
        """
        part = self.recording_set.part_of(path)
        if part == "camera":
            return self._decoded_target(self._hashed(path), path, self.recording_set.rig.channel_of("camera"))
        return to_grey(self.read_colours(path), self.laser_channel(part).channel)

    def read_colours(self, path: Path) -> Picture:
        """Read a laser picture of the set as its file has it, grey (H, W) or colour (H, W, 3), and record its hash.

        Raises
        ------
        InputError
            As `read`.
        """
        return decode_colours(self._hashed(path), path, self.recording_set.rig.mosaic)

    def _hashed(self, path: Path) -> bytes:
        data = read_bytes(path)
        self.hashes[self.recording_set.name_of(path)] = hashlib.sha256(data).hexdigest()
        return data

    def read_further(self, path: Path, number: int) -> Picture | None:
        """Read further exposure `number`, 2 or 3, of the picture `path`; None if there is none."""
        other = self.recording_set.further.get(path, {}).get(number)
        return None if other is None else self.read(other)

    def read_target(self, path: Path) -> Picture:
        """Read a picture of the set as grey levels (H, W) of the channel in which its target is searched.

        That is the laser's, unless targets cannot be seen in it; then it is the camera's. In a raw picture all sites
        show it.
        """
        laser = self.laser_channel(self.recording_set.part_of(path)).channel
        seen = self.recording_set.rig.channel_of("camera") if is_difference(laser) else laser
        return self._decoded_target(read_bytes(path), path, seen)

    def read_board(self, path: Path) -> Picture:
        """Read a picture of targets alone, in the set or not, in the channel of the camera's target."""
        return self._decoded_target(read_bytes(path), path, self.recording_set.rig.channel_of("camera"))

    def _decoded_target(self, data: bytes, path: Path, channel: Channel | None) -> Picture:
        picture = decode_colours(data, path)
        if self.recording_set.rig.mosaic is not None and picture.ndim == 2:
            return even_grey(picture)
        return to_grey(picture, channel)

    def sites(self, part: str) -> Sites:
        """Return the mosaic sites that see a part's laser: all, unless pictures are raw and one colour is used."""
        channel, mosaic = self.laser_channel(part).channel, self.recording_set.rig.mosaic
        if mosaic is None or channel is None or is_difference(channel):
            return ALL_SITES
        return sites_of(mosaic, channel)

    def laser_channel(self, part: str) -> LaserChannel:
        """Return the channel in which the pictures of a part are read: the rig's, else chosen at the first call.

        Where none is stated, it is the one that shows the laser best; the camera's target is looked at in grey then.
        """
        stated = self.recording_set.rig.channel_of(part)
        if stated is not None or part == "camera":
            return LaserChannel(stated)
        if part not in self.channels:
            self.channels[part] = _best_channel(self.recording_set, part)
        return self.channels[part]

    def take_hashes(self, paths: Sequence[Path], progress: Progress = silent) -> None:
        """Compute and record the hashes of those pictures not read yet; one that cannot be read gets none."""
        for path in steps(paths, progress, "comparing the pictures", len(paths)):
            with suppress(InputError):  # told where it is looked at
                self.hashes[self.recording_set.name_of(path)] = file_hash(path)

    def named_hashes(self, paths: Iterable[Path]) -> list[tuple[str, str]]:
        """List name within the set and recorded hash of pictures; "" where none was recorded."""
        names = map(self.recording_set.name_of, paths)
        return [(name, self.hashes.get(name, "")) for name in names]

    def id_of(self, paths: Iterable[Path]) -> str:
        """Compute twelve hex digits that identify these pictures by content; computes missing hashes first."""
        named = {self.recording_set.name_of(path): path for path in paths}
        self.take_hashes([path for name, path in named.items() if name not in self.hashes])
        text = "\n".join(sorted(self.hashes.get(name, "") for name in named))
        return hashlib.sha256(text.encode()).hexdigest()[:12]

    def stream(self, paths: Iterable[Path], times: StageTimes | None = None) -> Iterator[tuple[str, Picture | Reason]]:
        """Yield name and picture of each of `paths`, or the reason why it is damaged, a few being read ahead.

        For one that is an earlier one again, `Exclusion.REPEATED`. `times` learns what decoding costs.

        Raises
        ------
        InputError
            If a picture's depth (8 or 16 bit) is not that of the first one.
        """

        def attempt(path: Path) -> tuple[Picture | Message, bytes]:
            try:
                with stage(times, "decoding"):
                    picture = self.read(path)
                    return picture, pixels_of(picture)
            except InputError as error:
                return error.what, b""

        first: tuple[str, Picture] | None = None
        repeats = Repeats()
        paths = iter(paths)
        begin = tuple(islice(paths, 1))
        for path in begin:
            self.laser_channel(self.recording_set.part_of(path))  # once, before several threads ask for it
        for path, (result, pixels) in read_ahead(chain(begin, paths), attempt):
            name = self.recording_set.name_of(path)
            if not isinstance(result, Message):
                first = first or (name, result)
                _check_depth(path, result, *first)
            yield name, Exclusion.REPEATED if repeats.is_repeat(pixels) else result


def _best_channel(recording_set: RecordingSet, part: str) -> LaserChannel:
    """By three pictures of a part; grey where the first one is grey, or they cannot be read.

    Frames without a picture of the fan alone are set against their own background, as their stripes will be.
    """
    mosaic = recording_set.rig.mosaic
    if part == "scan":
        pairs = [(frame, recording_set.reference) for frame in recording_set.frames]
    else:
        pairs = [(pair.on, pair.off) for pair in (recording_set.planes or recording_set.check)]
    alone = part == "scan" and recording_set.reference is None
    few = pairs[:: max(1, len(pairs) // LOOKED_AT)][:LOOKED_AT]
    chosen = [pairs[at] for at in sample_indices(len(pairs))] if alone else few
    pictures = []
    for on, off in chosen:
        try:
            data = read_bytes(on)
            lit = decode_colours(data, on, mosaic)
            dark = None if off is None else decode_colours(read_bytes(off), off, mosaic)
        except InputError:
            continue  # told when it is measured
        if not has_colours(lit):
            return LaserChannel()
        same = dark is not None and dark.shape == lit.shape
        pictures.append(LitPicture(lit, dark if same else None, data))
    return laser_channel(against_background(pictures) if alone else pictures, raw=mosaic is not None)


def _check_depth(path: Path, picture: Picture, first_name: str, first: Picture) -> None:
    if picture.dtype != first.dtype:
        raise InputError(
            Message(
                "set.depth_differs",
                "the picture has {itemsize} bit, but {first_name} has {itemsize2}",
                itemsize=picture.dtype.itemsize * 8,
                first_name=first_name,
                itemsize2=first.dtype.itemsize * 8,
            ),
            where=path,
            todo=Message("advice.record_with_one_depth", "record all pictures with one depth"),
        )
