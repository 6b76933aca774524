"""A mask pushed aside by three tenths of a millimetre half way through a rendered scan."""

import pytest

from core.image.exclusion import Exclusion
from core.scan.features.extraction import FeatureOptions, extract_features
from core.scan.method import ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.records import MOVED_FRAME
from core.simulate.recording import scan_of
from core.simulate.scan import ScanStage
from core.simulate.scenario import Scenario
from core.simulate.scene.image import Sensor
from core.simulate.scene.stage import WORK_POINT
from tests.scan.centreline_scan import shifted

FRAMES, AT = 48, 30


@pytest.mark.accuracy
@pytest.mark.parametrize("seed", [1, 3, 5])
def test_frames_after_the_push_are_not_used(seed):
    """Crossings alone find it in two of these scans at once, in one seven frames late, in one not at all."""
    scenario = Scenario(object="mask", scale=0.4, frames=FRAMES, seed=seed)
    stage, sheets, _ = scan_of(scenario)
    pushed = ScanStage(
        stage.rig,
        shifted(stage.scene, [0.3, 0.0, 0.0]),
        Sensor(stage.rig.optics, scenario.bits, scenario.noise),
        seed=scenario.seed,
        texture=scenario.texture,
        aim=WORK_POINT,
    )
    pictures = ((f"frame{i:04d}", (stage if i < AT else pushed).frame(i, sheet)) for i, sheet in enumerate(sheets))
    camera = stage.rig.camera
    features = extract_features(stage.reference(), pictures, FRAMES, FeatureOptions(camera=camera))
    result = reconstruct(features, camera, stage.rig.fan, ReconstructOptions(sigma_cut_mm=0.2))
    assert {frame.reason for frame in result.frames[AT:]} <= {Exclusion.MOVED.message, MOVED_FRAME}
    assert sum(frame.used for frame in result.frames[:AT]) > 0.8 * AT
    assert result.datum.scale < 0.003
    assert "moved" in " ".join(map(str, result.notes))
