"""A public film of a hand-held line (giulioz/laser-scanning @ f5ba292, docs/input.gif), where it is given.

No licence is stated for it: it is read, and never kept here.
"""

from dataclasses import replace

import numpy as np
import pytest

from core.files.pictures import compression_of
from core.files.recording.import_pictures import import_pictures
from core.files.recording.import_plan import ImportRequest, Where, plan_import
from core.files.recording.picture_reader import PictureReader
from core.files.recording.recording_set import open_set
from core.files.recording.rig import default_rig, rig_to_toml
from core.image.background import quantile_reference, sample_indices
from core.image.stripes.extraction import choose_settings, extract_centrelines
from core.image.stripes.noise import estimate_noise
from core.scan.features.reference import picture_difference
from tests.shared import REAL_SETS

FILM = REAL_SETS / "laser-scanning" / "input.gif"

pytestmark = pytest.mark.skipif(not FILM.exists(), reason="the film is not here")


def test_all_fifty_frames_are_imported_and_each_shows_the_stripe(tmp_path):
    plan = plan_import(ImportRequest(scan=Where(FILM)))
    assert (len(plan.pictures), plan.films["scan"].doubled, plan.films["scan"].size) == (50, 0, (320, 240))
    assert [str(one.values["channel"]) for one in plan.proposals] == ["red"]
    import_pictures(plan, tmp_path / "set")
    (tmp_path / "set" / "rig.toml").write_text(rig_to_toml(default_rig()))
    recording_set = open_set(tmp_path / "set")
    reader = PictureReader(recording_set)
    assert reader.laser_channel("scan").channel == "red"
    frames = [reader.read(path) for path in recording_set.frames]
    background = quantile_reference([frames[at] for at in sample_indices(len(frames))])
    differences = [picture_difference(frame, background).astype(np.float32) for frame in frames]
    stripes = [stripe for each in differences if (stripe := choose_settings(each, 255.0)) is not None]
    assert len(stripes) == 50
    stripe = replace(
        stripes[0],
        width_px=float(np.median([one.width_px for one in stripes])),
        contrast=float(np.median([one.contrast for one in stripes])),
    )
    noise = estimate_noise(background.astype(np.float32))
    noise = replace(noise, compression=compression_of(recording_set.frames[0], "red")).of_difference()
    points = [
        sum(map(len, extract_centrelines(each, stripe, noise=noise, saturated=frame == 255)))
        for each, frame in zip(differences, frames, strict=True)
    ]
    assert min(points) > 200
