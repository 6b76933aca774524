"""What the widths of a scan's stripes tell of the hand's motion within its exposures."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.image.stripes.centreline import Centreline
from core.model import LightPlane
from core.scan.exposure_blur import exposure_blurs, notes_on_blur
from core.scan.features.frames import FrameFeatures
from core.scan.surface.cloud import Cloud
from core.simulate.scenario import Scenario
from tests.scan.centreline_scan import ExactScan

FRAMES, LENS_PX, SHEET_MM = 60, 0.5, 0.4
LEANS = np.radians([0.0, 25.0, -15.0, 40.0, -30.0, 10.0, 50.0])
"""By how much sheets lean over, one frame after another."""


def leaning(sheet, up, foot, lean):
    """The sheet turned about its light on the table."""
    along = np.cross(sheet.plane.normal, up)
    turned = Rotation.from_rotvec(lean * along / np.linalg.norm(along)).as_matrix()
    line = np.array([sheet.plane.normal, up, along])
    on_it = np.linalg.solve(line, [sheet.plane.d_mm, up @ foot, along @ foot])
    normal = turned @ sheet.plane.normal
    plane = LightPlane.from_normal(normal, normal @ on_it)
    return replace(sheet, plane=plane, emitter=on_it + turned @ (sheet.emitter - on_it), axis=turned @ sheet.axis)


@cache
def scanned(oblique):
    """A flat table under sheets of light, upright or `oblique`."""
    scan = ExactScan.of(Scenario(object="plane", scale=0.35, frames=FRAMES))
    if not oblique:
        return scan
    up, foot = scan.scene.pose_cam_table.rotation[:, 2], scan.scene.pose_cam_table.translation
    sheets = tuple(leaning(one, up, foot, LEANS[k % len(LEANS)]) for k, one in enumerate(scan.sheets))
    return ExactScan.of(Scenario(object="plane", scale=0.35, frames=FRAMES), sheets=sheets)


def sections(scan, sheet, curve, uneven) -> np.ndarray:
    """Widths in px at rest: the sheet's on the table as the camera sees it, and the lens's."""
    up, normal = scan.scene.pose_cam_table.rotation[:, 2], sheet.plane.normal
    across = normal - (normal @ up) * up
    moved = scan.rig.camera.project(curve.points + 1e-3 * across / (across @ across))
    px_per_mm = np.abs(((moved - scan.rig.camera.project(curve.points)) * curve.normal).sum(axis=1)) / 1e-3
    focus = 1 + uneven * curve.uv[:, 0] / scan.rig.camera.image_size[0]
    return np.hypot(LENS_PX, SHEET_MM * focus * px_per_mm)


def swept(blur_px, uneven: float = 0.0, *, oblique: bool = True, frames: int = FRAMES):
    """What `exposure_blurs` is told of a scan whose frames are blurred by so many px each.

    At rest the sheet is `uneven` times thicker at the right edge of the picture than at the left.
    """
    scan, rng = scanned(oblique), np.random.default_rng(1)
    features = []
    for number, blur in enumerate(np.broadcast_to(blur_px, frames)):
        lines = []
        for curve in scan.sweeps[number]:
            one = np.ones(len(curve.uv))
            width = np.hypot(sections(scan, scan.sheets[number], curve, uneven), blur)
            width *= 1 + 0.04 * rng.normal(size=len(one))
            lines.append(Centreline(curve.uv, curve.normal, width, 100 * one, 0.05 * one, one > 2))
        features.append(FrameFeatures(number, f"{number:03d}.png", tuple(lines)))
    uv, points = (np.vstack([getattr(c, name) for c in sum(scan.sweeps, ())]) for name in ("uv", "points"))
    nothing, index = np.zeros(len(uv)), np.zeros(len(uv), dtype=np.int64)
    cloud = Cloud(points, uv, nothing, nothing, index, index, np.zeros((len(uv), 3)))
    return features, dict(enumerate(scan.pis)), cloud, scan.rig.camera


def trembling() -> np.ndarray:
    """Blur of a hand that stands still now and then, in px."""
    return 1.5 * np.abs(np.sin(1.7 * np.arange(FRAMES)))


@pytest.mark.parametrize("oblique", [False, True], ids=["upright", "oblique"])
def test_the_blur_of_each_frame_is_found_by_its_width_against_the_others(oblique):
    blur = trembling()
    found, _ = exposure_blurs(*swept(blur, oblique=oblique)).T
    known = np.isfinite(found)
    clear = known & (blur > 0.7)
    assert known.sum() > 0.9 * FRAMES and clear.sum() > 15
    assert np.median(np.abs(found - blur)[clear]) < 0.35
    assert np.corrcoef(found[known], blur[known])[0, 1] > 0.85


@pytest.mark.parametrize("oblique", [False, True], ids=["upright", "oblique"])
@pytest.mark.parametrize("uneven", [0.0, 0.8], ids=["even", "wider at one side"])
@pytest.mark.parametrize("steady_px", [0.0, 0.8], ids=["at rest", "steady"])
def test_a_hand_that_rests_or_goes_on_evenly_is_told_nothing(steady_px, uneven, oblique):
    """Nor is a stripe that is not in focus everywhere, or a sheet that meets the surface obliquely."""
    blurs = exposure_blurs(*swept(steady_px, uneven, oblique=oblique))
    assert np.isfinite(blurs).mean() > 0.9
    assert notes_on_blur(blurs) == ()


def test_many_blurred_frames_are_told_and_a_single_one_is_not():
    (note,) = notes_on_blur(exposure_blurs(*swept(trembling(), oblique=False)))
    assert note.code == "scan.exposure_blur"
    assert 0.3 * FRAMES < note.values["n"] < 0.8 * FRAMES
    assert note.values["blur_px"] == pytest.approx(1.5, abs=0.4)
    alone = exposure_blurs(*swept(np.where(np.arange(FRAMES) == 7, 1.5, 0.0)))
    assert alone[7, 0] == pytest.approx(1.5, abs=0.25)
    assert notes_on_blur(alone) == ()


def test_frames_that_hardly_share_a_part_of_the_picture_tell_nothing():
    features, sheets, cloud, camera = swept(0.0)
    few = exposure_blurs(features[:3], sheets, cloud, camera)
    assert np.isnan(few).all() and notes_on_blur(few) == ()
    assert np.isnan(exposure_blurs([FrameFeatures(0, "a.png", ())], sheets, cloud, camera)).all()
    assert np.isnan(exposure_blurs(features, {}, cloud, camera)).all(), "no frame was located"
