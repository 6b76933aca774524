"""Scan step: reference and frames → cloud.ply, mesh.ply, scan.npz."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.errors import InputError
from core.files.pictures import Picture
from core.files.ply import write_cloud, write_mesh
from core.files.recording_set import RecordingSet, require_scan
from core.files.scan_file import ScanFile, write_scan
from core.model import Camera
from core.pipeline.options import Options
from core.pipeline.workspace import Workspace, check_size
from core.progress import Progress, silent
from core.scan.features import FeatureOptions, ScanFeatures, extract_features
from core.scan.fusion import fuse
from core.scan.mesh import build_mesh
from core.scan.network import SILENCED
from core.scan.normals import with_normals
from core.scan.reconstruct import ReconstructOptions, reconstruct
from core.scan.reference import quantile_reference, sample_indices
from core.scan.results import FrameRecord, ScanResult
from core.scan.surface import Mesh

FEWEST_FOR_QUANTILE = 3


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What the scan step gives in memory; the same is in its files."""

    scan: ScanResult
    mesh: Mesh


def scan_step(work: Workspace, options: Options | None = None, progress: Progress = silent) -> Measured:
    """Measure the surface with the calibration in camera.json and planes.json.

    Raises
    ------
    InputError
        If a calibration is missing or wrong, there are no usable frames, or no sweep can be located.
    """
    options = options or Options()
    found = work.found
    require_scan(found)
    calibration = work.calibration()
    camera, fan = calibration.camera.camera, calibration.fan.fan
    with work.step("scan") as log:
        log.settings.update(options.scan_settings)
        reference, note = _reference(found, camera)
        log.notes.extend(note)
        looking = FeatureOptions(sweep_stripe=options.stripe, fan_stripe=options.stripe)
        features = extract_features(reference, found.stream(found.frames), len(found.frames), looking, progress)
        solving = ReconstructOptions(method=options.method, sigma_cut_mm=options.sigma_cut_mm)
        scan = reconstruct(features, camera, fan, solving, progress)
        scan = replace(scan, cloud=with_normals(scan.cloud, progress=progress))
        log.frames.extend(scan.frames)
        log.notes.extend(_left_out(scan.frames))
        log.notes.extend(scan.notes)
        write_cloud(work.path("cloud"), scan.cloud, calibration.id)
        write_scan(work.path("scan"), _file(features, scan, calibration.id))
        surface = with_normals(fuse(scan.cloud, camera.image_size, progress=progress), progress=progress)
        mesh = build_mesh(surface, progress=progress)
        write_mesh(work.path("mesh"), mesh, calibration.id)
    return Measured(scan, mesh)


def _reference(found: RecordingSet, camera: Camera) -> tuple[Picture, list[str]]:
    """The picture with the fan alone, taken or made from the frames, and a note on how it was made."""
    if found.reference is not None:
        reference = found.read(found.reference)
        check_size(found.reference, reference, camera)
        return reference, []
    sample = [found.frames[index] for index in sample_indices(len(found.frames))]
    pictures = [picture for _, picture in found.stream(sample) if not isinstance(picture, str)]
    if len(pictures) < FEWEST_FOR_QUANTILE:
        raise InputError(
            f"there is no reference.png, and {len(pictures)} readable frames are too few to make one from",
            where=found.folder / "scan",
            todo="record reference.png with the fan alone, or more frames",
        )
    check_size(sample[0], pictures[0], camera)
    note = f"There is no scan/reference.png: the darkest third of {len(pictures)} frames stands for it, pixel by pixel."
    return quantile_reference(pictures), [note]


def _left_out(frames: tuple[FrameRecord, ...]) -> list[str]:
    """One sentence for every reason why frames gave no points."""
    reasons: dict[str, list[str]] = {}
    for frame in frames:
        if not frame.used:
            reasons.setdefault(frame.reason, []).append(frame.name)
    return [
        f"{len(names)} of {len(frames)} frames gave no points ({reason}): {', '.join(names[:3])}"
        + (" and others." if len(names) > 3 else ".")
        for reason, names in reasons.items()
    ]


def _file(features: ScanFeatures, scan: ScanResult, calibration_id: str) -> ScanFile:
    shown = _shown(scan.frames)
    mine = (scan.crossings.a == shown) & scan.crossings.with_fan & (scan.crossing_weights > SILENCED)
    return ScanFile(
        features=features,
        pis=scan.pis,
        covariance=scan.covariance,
        sweep_frames=scan.sweep_frames,
        fan_line=scan.fan_lines.line,
        crossings_used=np.asarray(scan.crossings.uv[mine]),
        shown=shown,
        calibration_id=calibration_id,
    )


def _shown(frames: tuple[FrameRecord, ...]) -> int | None:
    """The frame to show: of those that meet most lines of the fan, the one with most points."""
    used = [frame for frame in frames if frame.used]
    return max(used, key=lambda frame: (frame.fan_lines_met, frame.points, -frame.index)).index if used else None
