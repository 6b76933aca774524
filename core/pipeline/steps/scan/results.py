"""What the scan step gives: in memory, and in cloud.ply, mesh.ply and scan.npz."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.files.recording.picture_reader import PictureReader
from core.files.results.ply import write_cloud, write_mesh
from core.files.results.scan_file import ScanFile, write_scan
from core.pipeline.steps.kept_features import features_key
from core.pipeline.steps.scan.judgement import Judgement
from core.pipeline.steps.workspace import Calibration, StepLog
from core.progress import Progress
from core.scan.features.extraction import ScanFeatures
from core.scan.network.adjustment import SILENCED
from core.scan.part_light import PartLight
from core.scan.plane_check import PlaneCheck
from core.scan.results import FrameRecord, ScanResult
from core.scan.surface.fused_surface import Mesh
from core.settings.options import Options
from core.stage_times import StageTimes, stage


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """Results of the scan step in memory: solved scan, mesh, check by known planes; its files hold the same."""

    scan: ScanResult
    mesh: Mesh
    check: PlaneCheck | None = None


def write_measured(log: StepLog, measured: Measured, file: ScanFile, progress: Progress) -> None:
    """Write cloud, mesh and scan.npz of a measured scan, and remove results measured by profiles.

    The time that it takes is recorded where `progress` is a StageTimes.

    Raises
    ------
    InputError
        If one of them cannot be written.
    """
    with stage(progress if isinstance(progress, StageTimes) else None, "writing"):
        log.gone.update(("profiles", "profile", "profile_table"))
        write_cloud(log.path("cloud"), measured.scan.cloud, file.calibration_id)
        write_scan(log.path("scan"), file)
        write_mesh(log.path("mesh"), measured.mesh, file.calibration_id)


def scan_file(
    features: ScanFeatures,
    scan: ScanResult,
    judgement: Judgement,
    calibration: Calibration,
    pictures: PictureReader,
    settings: Options,
    light: PartLight | None,
    check: PlaneCheck | None = None,
) -> ScanFile:
    """Collect the content of scan.npz; `pictures` must have taken the hashes of the files it rests on."""
    shown = _shown(scan.frames)
    with_fan = scan.crossings.with_fan & ~scan.crossings.on_plane
    mine = (scan.crossings.a == shown) & with_fan & (scan.crossing_weights > SILENCED)
    return ScanFile(
        features=features,
        pis=scan.pis,
        covariance=scan.covariance,
        sweep_frames=scan.sweep_frames,
        fan_line=scan.fan_lines.line,
        crossings_used=np.asarray(scan.crossings.uv[mine]),
        shown=shown,
        calibration_id=calibration.id,
        features_key=features_key(pictures, settings, calibration.camera.camera),
        speckle=scan.speckle,
        second_bounces=tuple(sorted(scan.second_bounces.pieces)),
        unsure_share=scan.unsure_share,
        common=judgement.common,
        facts=judgement.facts,
        causes=judgement.causes,
        part_light=light,
        planes=scan.planes,
        plane_check=check,
    )


def _shown(frames: tuple[FrameRecord, ...]) -> int | None:
    """The frame to show: of those that meet most lines of the fan, the one with most points."""
    used = [frame for frame in frames if frame.used]
    return max(used, key=lambda frame: (frame.fan_lines_met, frame.points, -frame.index)).index if used else None
