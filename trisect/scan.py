"""A scan below the steps: pictures to light planes, points, a fused surface and its mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from core.calibrate.change import Change, Evidence, Stability, changes, judge
from core.calibrate.deviations import Deviation, calibration_deviations
from core.calibrate.results import CAMERA_PARAMETERS, CameraCalibration, FanCalibration
from core.calibrate.rig_spread import stability_by_pictures
from core.errors import InputError
from core.findings.proof import ScanFacts
from core.findings.table import gravest_first
from core.image.background import quantile_reference, sample_indices
from core.image.stripes.centreline import Centreline
from core.image.stripes.noise import UNCOMPRESSED, Compression
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.model import Camera, LightPlane
from core.pipeline.steps.scan.judgement import judged_scan, section_since, solved_scan
from core.pipeline.steps.scan.notes import assumed_shutter
from core.pipeline.steps.scan.part_light import Plates, notes_on_part_light, part_light
from core.pipeline.steps.validity import facts_of_calibration
from core.pipeline.steps.workspace import Calibration
from core.progress import Progress, silent
from core.scan.common_errors import CommonErrors
from core.scan.features.extraction import FeatureOptions, ScanFeatures, extract_features, read_reference
from core.scan.features.overexposure import notes_on_shine
from core.scan.features.picture_faults import faults_of, mosaic_of
from core.scan.method import ReconstructOptions
from core.scan.part_light import PartLight
from core.scan.results import ScanResult
from core.scan.surface import fusion, mesh
from core.scan.surface import triangulate as triangulation
from core.scan.surface.cloud import Cloud
from core.scan.surface.fused_surface import Mesh, Surface
from core.scan.surface.normals import with_normals
from trisect.pictures import checked_picture, same_size

FEWEST_FRAMES = 3
"""Without a picture of the fan alone one is made of the frames: of three, the darkest third is one."""


@dataclass(frozen=True, eq=False, slots=True)
class SolvedScan:
    """What the frames of a scan give.

    Parameters
    ----------
    cloud
        The points, with normals, their σ and what camera and fan make common to all of them.
    result
        Light planes of the sweeps, a record of each frame, and whether anything moved.
    features
        The centrelines and crossings that it rests on.
    common
        What displaced calibrations, and what may have changed since, do to the scan.
    facts
        What decides whether anything measured in it can prove conformity.
    notes
        What is to be known of it, the gravest first.
    light
        How much wider stripes are on the part than on the table; None: not known.
    """

    cloud: Cloud
    result: ScanResult
    features: ScanFeatures
    common: CommonErrors
    facts: ScanFacts
    notes: tuple[Message, ...]
    light: PartLight | None = None

    @property
    def errors(self) -> PointErrors:
        """Errors of the scan's points and how they are correlated, from which uncertainties are computed."""
        scan = self.result
        errors = PointErrors.of_scan(self.features, scan.covariance, self.common, scan.speckle, scan.pis.shape[1])
        return replace(errors, facts=self.facts, light=self.light)


def triangulate(stripe: Centreline, plane: LightPlane, camera: Camera, *, covariance: ArrayLike | None = None) -> Cloud:
    """Triangulate a stripe on its light plane: z = 1/(π·r) on each ray r.

    Parameters
    ----------
    stripe
        A centreline with n points.
    plane
        The light plane π.
    camera
        The camera that has seen it.
    covariance
        (3, 3) of π in 1/mm²; None: the plane is taken as exact, and σ is that of the centreline alone.

    Returns
    -------
    Cloud
        At most n points: saturated ones, and those behind the camera, are left out. `sigma` is that of the depth in mm.

    Raises
    ------
    InputError
        If the covariance is not (3, 3) or not finite.

    References
    ----------
    The paper, equation (5), in inverse depth.

    Examples
    --------
    >>> import numpy as np
    >>> v, u = np.mgrid[:80, :120]
    >>> picture = (20 + 150 * np.exp(-0.5 * ((u - 60) / 2.5) ** 2)).astype(np.uint8)
    >>> stripe, = extract_stripes(picture)
    >>> camera = Camera((120, 80), np.array([[500.0, 0, 59.5], [0, 500.0, 39.5], [0, 0, 1]]))
    >>> cloud = triangulate(stripe, LightPlane.from_normal([0.6, 0, 0.8], 400.0), camera)
    >>> bool(np.allclose(cloud.points @ [0.6, 0, 0.8], 400.0)), bool(np.all(cloud.sigma > 0))
    (True, True)
    """
    known = np.zeros((3, 3)) if covariance is None else np.asarray(covariance, dtype=np.float64)
    if known.shape != (3, 3) or not np.isfinite(known).all():
        raise InputError(
            Message("api.no_covariance", "an array of shape {shape} is no covariance of π", shape=str(known.shape)),
            where="covariance",
            todo=Message("api.advice_covariance", "give (3, 3) finite numbers in 1/mm²"),
        )
    return triangulation.triangulate(stripe, plane.pi, known, camera, 0, 0)


def solve_scan(
    frames: Sequence[ArrayLike],
    camera: CameraCalibration,
    fan: FanCalibration,
    *,
    reference: ArrayLike | None = None,
    stability: Stability | None = None,
    options: ReconstructOptions | None = None,
    compression: Compression = UNCOMPRESSED,
    progress: Progress = silent,
) -> SolvedScan:
    """Measure a still surface by frames in which a line laser is moved over it by hand.

    Parameters
    ----------
    frames
        In the order they were taken, each (height, width) uint8 or uint16.
    camera, fan
        The calibrations.
    reference
        The scene with the fan alone, (height, width) of the same type; None: made of the frames, three at least.
    stability
        How far the rig may have changed since its calibration; None: not known, and what is assumed is in the
        uncertainty.
    options
        `method`: how sweeps are located; `sigma_cut_mm`: points whose depth is less sure are left out; `row_time_us`:
        from one row of a picture to the next of a rolling shutter, 0 for a global one, None where it is not known.
    compression
        Of the files, by `compression_of`.
    progress
        Called with how far it is.

    Returns
    -------
    SolvedScan
        Its `cloud` has n points with σ.

    Raises
    ------
    InputError
        If an array is no picture or of another size than the camera's, the fan is not seen, no frame shows a sweep, no
        sweep crosses the fan, or no point is sure enough.

    References
    ----------
    The paper, section 2.4, with all frames in one network: π_i·r = π_k·r at each crossing.

    Examples
    --------
    >>> views = [find_target(read_picture(path), small.rig.camera_target, name=path.stem) for path in small.camera]
    >>> camera = calibrate_camera(views, (768, 550))
    >>> pairs = [(read_picture(pose.on), read_picture(pose.off)) for pose in small.planes]
    >>> fan = calibrate_fan(pairs, small.rig.plane_target, camera, angle=small.rig.angle)
    >>> frames = [read_picture(path) for path in small.frames]
    >>> coarse = ReconstructOptions(sigma_cut_mm=0.3)
    >>> scan = solve_scan(frames, camera, fan, reference=read_picture(small.reference), options=coarse)
    >>> scan.cloud.points.shape == (len(scan.cloud), 3), len(scan.cloud) > 1000
    (True, True)
    """
    solving = _checked(options or ReconstructOptions())
    _check_known(camera)
    pictures = [checked_picture(frame, _name(number)) for number, frame in enumerate(frames)]
    if reference is not None:
        base = checked_picture(reference, "reference")
    elif len(pictures) >= FEWEST_FRAMES:
        base = quantile_reference([pictures[number] for number in sample_indices(len(pictures))])
    else:
        raise InputError(
            Message(
                "api.too_few_frames",
                "of {n} frames none of the fan alone can be made",
                n=len(pictures),
            ),
            where="frames",
            todo=Message("api.advice_reference", "give at least three frames, or a reference"),
        )
    for number, picture in enumerate(pictures):
        same_size(picture, base, _name(number))
    width, height = camera.camera.image_size
    same_size(base, np.empty((height, width), base.dtype), "camera")
    looking = FeatureOptions(camera=camera.camera, compression=compression)
    seen = read_reference(base, looking)
    named = ((_name(number), picture) for number, picture in enumerate(pictures))
    features = extract_features(seen, named, len(pictures), looking, progress)
    sweeps = [piece for frame in features.frames for piece in frame.centrelines]
    mosaic = mosaic_of(seen.fan, seen.base)
    faults = (*faults_of(seen, mosaic), *notes_on_shine(features.fan, sweeps, seen.full_scale), *features.faults)
    features = replace(features, faults=faults, too_fine_for_mosaic=mosaic.too_fine)
    calibration = Calibration(camera, fan)
    solved = solved_scan(features, calibration, solving, progress)
    change_by = partial(_change_by_scan, calibration, stability)
    of_day, section = facts_of_calibration(calibration), section_since(calibration, fan.stripes, features.fan)
    judgement = judged_scan(solved, change_by, of_day, section, method=solving.method, progress=progress)
    cloud = with_normals(solved.scan.cloud, progress=progress)
    cloud = replace(cloud, sigma_common=judgement.common.sigma(cloud))
    notes = (*solved.scan.notes, *assumed_shutter(solving.row_time_us, solved.scan))
    scan = replace(solved.scan, cloud=cloud, notes=notes)
    light = part_light(solved, _plates(fan))
    notes = gravest_first((*judgement.notes, *notes, *notes_on_part_light(light)))
    return SolvedScan(cloud, scan, solved.features, judgement.common, judgement.facts, notes, light)


def _plates(fan: FanCalibration) -> Plates:
    """The plates of a calibration with the stripes on them; none of one read from a file, which holds no stripes."""
    seen = zip(fan.poses, fan.stripes, strict=bool(fan.stripes))
    return [(pose.pose, stripes) for pose, stripes in seen if pose.used]


def _change_by_scan(
    calibration: Calibration, stability: Stability | None, evidence_of: Callable[[Sequence[Deviation]], Evidence]
) -> Change:
    """What may have changed since the calibration, by the pictures of the scan alone."""
    camera, fan = calibration.camera.camera, calibration.fan.fan
    deviations = (*calibration_deviations(calibration.camera, calibration.fan), *changes(camera, fan))
    evidence = evidence_of(deviations)
    return judge(camera, fan, deviations, evidence, stability, assumed=stability_by_pictures(deviations, evidence))


def _checked(options: ReconstructOptions) -> ReconstructOptions:
    """Return options that can be; InputError for other ones."""
    complaint = options.complaint
    if complaint is None:
        return options
    raise InputError(
        complaint,
        where="options",
        todo=Message("api.advice_options", "give a σ cut above 0 and at most 10 mm, and a time not below 0, or None"),
    )


def _check_known(camera: CameraCalibration) -> None:
    """InputError if it is not known how sure a camera is: every uncertainty would be too small."""
    covariance = np.asarray(camera.covariance)
    size = len(CAMERA_PARAMETERS)
    if covariance.shape == (size, size) and np.isfinite(covariance).all():
        variances = np.diag(covariance)
        if (variances >= 0).all() and variances.any():
            return
    raise InputError(
        Message("api.no_camera_covariance", "the camera has no covariance of its parameters"),
        where="camera",
        todo=Message("api.advice_camera", "take the camera as calibrate_camera gives it"),
    )


def _name(number: int) -> str:
    return f"frame {number + 1}"


def fuse(cloud: Cloud, image_size: tuple[int, int], *, progress: Progress = silent) -> Surface:
    """Fuse the points of a scan into one surface over the picture's grid.

    Parameters
    ----------
    cloud
        The points of all sweeps.
    image_size
        (width, height) of the picture in px.
    progress
        Called with how far it is.

    Returns
    -------
    Surface
        One point (3,) in mm a cell, with σ and normal; what camera and fan have in common is not in its σ.

    Raises
    ------
    InputError
        If the cloud holds no point with finite depth and σ above 0.

    References
    ----------
    Weighted mean of each cell's largest layer; the paper, section 2.4, takes the points as they are.

    Examples
    --------
    >>> surface = fuse(flat, (768, 550))
    >>> surface.points.shape[1], len(surface.points) <= len(flat)
    (3, True)
    """
    return with_normals(fusion.fuse(cloud, image_size, progress=progress), progress=progress)


def build_mesh(surface: Surface, *, progress: Progress = silent) -> Mesh:
    """Triangulate a fused surface, cut where its depth jumps.

    Parameters
    ----------
    surface
        As `fuse` gives it.
    progress
        Called with how far it is.

    Returns
    -------
    Mesh
        `vertices` (n, 3) in mm and `triangles` (m, 3), indices of them.

    Raises
    ------
    InputError
        If no triangle can be made.

    References
    ----------
    Delaunay triangulation in the picture's plane.

    Examples
    --------
    >>> mesh = build_mesh(fuse(flat, (768, 550)))
    >>> mesh.vertices.shape[1], mesh.triangles.shape[1]
    (3, 3)
    """
    return mesh.build_mesh(surface, progress=progress)
