"""Live recordings of the simulated rig, in real time, against what really is before its camera."""

import numpy as np
import pytest

from core.acquire.source import SourceChoice, SourceSettings
from core.files.recording.rig import Rig
from core.image.targets import BlackSquare, Checkerboard
from core.pipeline.live.commands import LiveRequest, Stop
from core.pipeline.live.events import LiveTaken, LiveView
from core.pipeline.live.planes import CHECK_POSES
from core.pipeline.live.session import run_live
from core.pipeline.live.sources import make_source
from core.simulate.scene.stage import table_pose
from tests.pipeline.live_bench import Window

RIG = Rig(Checkerboard(17, 12, 10.0), BlackSquare(60.0), 3, np.radians(5.0))
CHOICE = SourceChoice("simulated", "scale = 0.25")


@pytest.mark.accuracy
def test_the_growing_cloud_of_a_block_is_true(tmp_path):
    truth = make_source(CHOICE, RIG).truth
    window = Window(lambda event: Stop() if isinstance(event, LiveView) and event.recorded >= 60 else None)
    request = LiveRequest("scan", CHOICE, SourceSettings(), RIG, tmp_path / "scan", camera=truth.camera, fan=truth.fan)
    ended = run_live(request, window.next_command, window.hear, window.ready)
    assert ended.error is None
    assert ended.recorded >= 60
    cloud = []
    for detail in window.details:
        cloud = [detail.points] if detail.renewed else [*cloud, detail.points]
    points = np.concatenate([part.points for part in cloud])
    sigma = np.concatenate([part.sigma for part in cloud])
    assert len(points) > 1500
    good = points[sigma < 0.3]
    heights = heights_above_table(good)
    assert np.sum(np.abs(heights) < 1) > 300
    assert abs(np.median(heights[np.abs(heights - truth.thickness_mm) < 3]) - truth.thickness_mm) < 0.5


def heights_above_table(points):
    """True heights in mm over the table."""
    pose = table_pose()
    return (points - pose.translation) @ pose.rotation[:, 2]


@pytest.mark.accuracy
def test_views_of_the_board_are_taken_at_its_rests(tmp_path):
    window = Window(lambda event: Stop() if isinstance(event, LiveTaken) and event.name == "view02" else None)
    request = LiveRequest("camera", CHOICE, SourceSettings(), RIG, tmp_path / "camera")
    ended = run_live(request, window.next_command, window.hear, window.ready)
    assert ended.recorded == 3
    assert {"Hold still.", "Taken."} <= {str(detail.sentence) for detail in window.details}


@pytest.mark.accuracy
def test_the_pictures_of_a_check_are_taken_by_themselves_and_end(tmp_path):
    truth = make_source(CHOICE, RIG).truth
    window = Window()
    request = LiveRequest(
        "check", CHOICE, SourceSettings(), RIG, tmp_path / "check", camera=truth.camera, fan=truth.fan
    )
    ended = run_live(request, window.next_command, window.hear, window.ready)
    assert ended.error is None
    assert ended.recorded == CHECK_POSES == len(window.all(LiveTaken))
    names = sorted(path.name for path in ended.folder.glob("*.png"))
    assert names == [f"pose{n:02d}{end}.png" for n in range(CHECK_POSES) for end in ("", "_off")]
