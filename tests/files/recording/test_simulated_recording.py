"""Whether pictures are rendered is known of a recording that states it or whose log names the simulated rig."""

import platform
from datetime import UTC, datetime
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from core.acquire.source import FrameSource, SourceChoice
from core.files.pictures import write_picture
from core.files.recording.recording_log import LoggedFrame, RecordingLog
from core.files.recording.recording_set import open_set
from core.files.recording.rig import read_rig, rig_to_toml
from core.pipeline.live.sources import camera_name


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "scan").mkdir()
    write_picture(tmp_path / "scan" / "a.png", np.zeros((8, 8), np.uint8))
    (tmp_path / "rig.toml").write_text("")
    return tmp_path


@pytest.mark.parametrize(
    ("stated", "known"), [("", None), ("simulated = true\n", True), ("simulated = false\n", False)]
)
def test_rig_toml_says_it_or_it_is_not_known(folder: Path, stated: str, known: bool | None) -> None:
    (folder / "rig.toml").write_text(stated)
    assert open_set(folder).simulated is known
    assert stated in rig_to_toml(read_rig(folder / "rig.toml"))


@pytest.mark.parametrize(("kind", "known"), [("simulated", True), ("opencv", None)])
def test_the_log_of_a_recording_names_the_simulated_rig(folder: Path, kind: str, known: bool | None) -> None:
    class Source:
        name = "Camera"

    camera = camera_name(SourceChoice(kind, "0"), cast(FrameSource, Source()))
    assert platform.node() in camera
    log = RecordingLog(folder / "scan")
    log.add(LoggedFrame("a.png", 0, 0.0, 0, datetime.now(UTC), camera))
    log.close()
    assert open_set(folder).simulated is known
