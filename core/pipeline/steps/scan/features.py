"""What the pictures of a scan show: kept of an earlier scan, looked at beside, or looked at now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from core.errors import InputError
from core.files.recording.picture_reader import PictureReader
from core.findings.table import note_of
from core.messages import Command, Message
from core.model import Camera, Fan
from core.pipeline.steps.kept_features import stored_features
from core.pipeline.steps.scan.known_planes import BoardsSeen, see_boards, states_no_fan
from core.pipeline.steps.scan.pictures import SeenScan, look_at_scan
from core.pipeline.steps.workspace import Calibration, check_size
from core.progress import Progress, silent
from core.scan.features.extraction import FeatureOptions, FrameFeatures, ReferenceFeatures, ScanFeatures, crossed
from core.scan.method import Method
from core.scan.preview.frames import Preview
from core.scan.preview.shown import FramePreview, stripes_alone
from core.settings.options import Options

__all__ = ["boards_of_scan", "crossed_scan", "scan_features", "states_no_fan"]


def boards_of_scan(
    pictures: PictureReader, calibration: Calibration, settings: Options, progress: Progress
) -> BoardsSeen:
    """Find the boards of a scan where its method ties sweeps to known planes; else they are not looked for, and told.

    Raises
    ------
    InputError
        As of `see_boards`, or if there is no fan and the method needs one.
    """
    recording_set = pictures.recording_set
    if settings.method == Method.NETWORK:
        return see_boards(pictures, calibration, progress)
    if not recording_set.rig.has_fan:
        raise InputError(
            Message(
                "scan.three_crossings_without_fan",
                "the method three-crossings locates each sweep by the fan alone, and the rig has none",
            ),
            where="scan",
            todo=Message(
                "scan.advice_network", "choose the method network{command}", command=Command("--method network")
            ),
        )
    return BoardsSeen(calibration, (note_of("scan.boards_not_used"),) if recording_set.known_planes else ())


def scan_features(
    pictures: PictureReader,
    calibration: Calibration,
    settings: Options,
    progress: Progress,
    watch: Callable[[FramePreview], None] | None = None,
    earlier: Path | None = None,
    seen: Callable[[], SeenScan] | None = None,
) -> ScanFeatures:
    """Extract centrelines and crossings of all pictures of a scan, or read them where they were stored before.

    Parameters
    ----------
    pictures, calibration, settings, progress
        What is looked at, how, and who is told.
    watch
        Shown each frame with what it would give by itself, if the pictures are looked at now.
    earlier
        A scan.npz, whose features are taken if they are those of these pictures, settings and camera; so are those that
        were kept while the frames were recorded.
    seen
        Gives what the pictures show, if they are looked at already.

    Raises
    ------
    InputError
        If the reference shows no line of the fan, no frame a sweep, or a picture has another size than the camera's.
    """
    camera = calibration.camera.camera
    kept = stored_features(earlier, pictures, settings, camera, progress) if seen is None else None
    if kept is not None and kept.image_size == camera.image_size:
        return kept
    if seen is None:
        watching = None if watch is None else _watching(watch, camera, calibration.fan.fan)
        looked = look_at_scan((pictures.recording_set, settings), progress=progress, camera=camera, watching=watching)
    else:
        looked = seen()
    width, height = looked.lines.image_size
    check_size(looked.reference, (height, width), camera)
    pictures.learn(looked.hashes, looked.channels)
    return crossed_scan(looked, camera, progress)


def crossed_scan(looked: SeenScan, camera: Camera, progress: Progress = silent) -> ScanFeatures:
    """Cross the centrelines extracted from a scan's pictures, as `camera` sees them: the features of the scan."""
    features = crossed(looked.lines, looked.averaged, FeatureOptions(camera=camera), progress)
    notes, faults = (*looked.notes, *features.notes), (*looked.faults, *features.faults)
    return replace(features, notes=notes, faults=faults, too_fine_for_mosaic=looked.too_fine_for_mosaic)


def _watching(
    watch: Callable[[FramePreview], None], camera: Camera, fan: Fan
) -> Callable[[ReferenceFeatures], Callable[[FrameFeatures], None]]:
    """How each frame is shown with what it would give by itself, once the reference is read."""

    def watching(reference: ReferenceFeatures) -> Callable[[FrameFeatures], None]:
        if not fan.lines:  # a frame by itself has nothing to be located by, and is not to be found fault with
            return lambda seen: watch(stripes_alone(seen.index, seen.name, seen.exclusion, seen.centrelines))
        preview = Preview(reference, camera, fan)

        def show(features: FrameFeatures) -> None:
            watch(preview(features))
            while preview.has_more:
                preview.go_on()

        return show

    return watching
