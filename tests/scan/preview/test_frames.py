import pickle
from dataclasses import replace

import numpy as np
import pytest

from core.image.exclusion import Exclusion
from core.model import LightPlane
from core.scan.features.extraction import (
    FrameFeatures,
    FrameReader,
    choose_sweep_stripe,
    extract_features,
    read_reference,
)
from core.scan.method import ReconstructOptions
from core.scan.preview import frames as preview_module
from core.scan.preview.frames import Preview, PreviewOptions
from core.scan.preview.hints import HandState, HintLimits, hints_for
from core.scan.preview.shown import CrossingStatus
from core.scan.reconstruct import reconstruct
from core.scan.surface.coverage_map import CoverageMap
from core.scan.sweeps import tracking
from core.scan.sweeps.tracking import movement_px
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario


def shown(preview: Preview, features: FrameFeatures, index: int | None = None):
    """What a frame shows, with all that can wait done after it."""
    frame = preview(features if index is None else replace(features, index=index))
    while preview.has_more:
        preview.go_on()
    return frame


class Scan:
    """A simulated scan at a quarter of the pixels, read frame by frame."""

    def __init__(self, thing: str, frames: int = 36):
        stage, sheets, _ = scan_of(Scenario(object=thing, scale=0.25, frames=frames))
        self.camera, self.fan = stage.rig.camera, stage.rig.fan
        self.planes: list[LightPlane] = [sheet.plane for sheet in sheets]
        self.pictures = [(f"frame{i:04d}.png", stage.frame(i, sheet)) for i, sheet in enumerate(sheets)]
        self.picture = stage.reference()
        self.reference = read_reference(self.picture)
        reader = FrameReader(self.reference, choose_sweep_stripe(self.pictures[:4], self.reference))
        self.features = [reader((i, frame)) for i, frame in enumerate(self.pictures)]
        self.preview = Preview(self.reference, self.camera, self.fan)
        self.frames = [shown(self.preview, features) for features in self.features]

    def depth_errors(self, index: int) -> np.ndarray:
        frame = self.frames[index]
        return frame.points[:, 2] - self.planes[index].depths(self.camera.rays(frame.point_uv))


@pytest.fixture(scope="module")
def block():
    return Scan("block")


@pytest.fixture(scope="module")
def flat():
    return Scan("plane", 24)


def test_points_are_true_within_their_sigma(block):
    errors = np.concatenate([block.depth_errors(i) for i in range(18, 36)])
    sigma = np.concatenate([frame.point_sigma for frame in block.frames[18:]])
    assert len(errors) > 1000
    assert np.median(np.abs(errors)) < 0.3
    assert np.median(np.abs(errors) / sigma) < 1.5


def test_later_sweeps_are_better_located_than_by_the_fan_alone(flat):
    first = [np.median(sigma) for frame in flat.frames[:6] for sigma in frame.sigma_mm]
    last = [np.median(sigma) for frame in flat.frames[18:] for sigma in frame.sigma_mm]
    assert np.median(last) < 0.25 * np.median(first)


def test_on_a_flat_face_the_first_pass_is_told_to_tilt(flat):
    assert all("scan.hint_tilt" in [hint.code for hint in frame.hints] for frame in flat.frames[1:4])
    assert all(frame.condition > 1e3 for frame in flat.frames[1:4])


def test_each_point_shown_is_better_than_the_cut(block):
    shown = np.concatenate([frame.point_sigma for frame in block.frames])
    assert shown.max() <= 1.0


def test_sigma_is_given_for_every_point_of_the_stripe(block):
    for frame in block.frames:
        assert [len(sigma) for sigma in frame.sigma_mm] == [len(piece) for piece in frame.centrelines]


def test_every_crossing_has_a_status_and_a_sentence(block):
    for frame in block.frames:
        count = len(frame.crossing_uv)
        assert len(frame.crossing_status) == len(frame.crossing_reason) == count
        assert set(frame.crossing_status) <= set(CrossingStatus)
        assert all(reason.endswith(".") and reason[0].isupper() for reason in map(str, frame.crossing_reason))
    good = [
        r
        for f in block.frames
        for s, r in zip(f.crossing_status, f.crossing_reason, strict=True)
        if s == CrossingStatus.GOOD
    ]
    assert any("line 2 of the fan at" in str(reason) for reason in good)


def test_frames_without_points_say_why(block):
    assert all(bool(frame.reason) != bool(len(frame.points)) for frame in block.frames)
    assert any(frame.reason and frame.reason.code == "scan.frame_few_crossings" for frame in block.frames)


def test_the_fan_s_lines_get_the_numbers_of_the_finished_scan(block):
    features = extract_features(block.picture, block.pictures, len(block.pictures))
    finished = reconstruct(features, block.camera, block.fan, ReconstructOptions(sigma_cut_mm=1.0))
    by_line = [
        sum(len(piece) for piece, k in zip(features.fan, finished.fan_lines.line, strict=True) if k == line)
        for line in range(3)
    ]
    previewed = [3 * sum(len(piece) for piece in line) for line in block.preview.fan_lines]
    assert np.allclose(previewed, by_line, rtol=0.02)


def test_the_first_frame_brings_the_fan_and_later_ones_renew_the_cloud(block):
    first, *others = block.frames
    assert first.fan_lines is not None
    assert np.all(first.renewed.frame <= first.index)
    assert np.any(first.renewed.frame == -1)
    renewed = [frame for frame in others if frame.renewed is not None]
    assert 3 <= len(renewed) <= 12
    for frame in renewed:
        assert frame.renewed.frame.max() <= frame.index
    assert len(renewed[-1].renewed) > 5 * len(renewed[0].renewed)


def test_a_renewed_cloud_has_more_points_and_knows_them_better(flat):
    cloud = flat.preview.cloud()
    early = (cloud.frame >= 0) & (cloud.frame < 6)
    then = np.concatenate([frame.point_sigma for frame in flat.frames[:6]])
    assert np.count_nonzero(early) > len(then)
    assert np.count_nonzero(cloud.sigma[early] < 0.2) > 1.3 * np.count_nonzero(then < 0.2)
    rays = flat.camera.rays(cloud.uv[early])
    true = np.array([flat.planes[k].depths(ray[None])[0] for k, ray in zip(cloud.frame[early], rays, strict=True)])
    assert np.median(np.abs(cloud.points[early, 2] - true) / cloud.sigma[early]) < 1.5


def test_what_is_shown_can_be_sent_to_another_process(block):
    again = pickle.loads(pickle.dumps(block.frames[-1]))
    assert np.array_equal(again.points, block.frames[-1].points)
    assert np.array_equal(again.centrelines[0].uv, block.frames[-1].centrelines[0].uv)


def test_a_frame_without_a_stripe_passes_its_reason_on(block):
    preview = Preview(block.reference, block.camera, block.fan)
    frame = preview(FrameFeatures(0, "frame0000.png", (), Exclusion.WITHOUT_STRIPE))
    assert frame.exclusion is Exclusion.WITHOUT_STRIPE
    assert len(frame.points) == 0
    assert np.isnan(frame.speed_px)


def test_a_laser_at_rest_does_not_wear_the_preview_out(block):
    preview = Preview(block.reference, block.camera, block.fan)
    still = block.features[3]
    for index in range(60):
        shown(preview, still, index)
    assert len(preview._tracker._anchors) == 1


@pytest.mark.accuracy
def test_a_long_scan_keeps_few_anchors(block):
    preview = Preview(block.reference, block.camera, block.fan)
    index = 0
    for _ in range(4):
        for features in block.features:
            shown(preview, features, index)
            index += 1
    assert len(preview._tracker._anchors) <= 40
    assert {0, 1, 2} >= {status for frame in block.frames for status in frame.crossing_status}


def test_movement_is_measured_across_the_stripe(block):
    lines = block.features[20].centrelines
    assert movement_px(lines, lines) == pytest.approx(0, abs=0.6)
    piece = max(lines, key=len)
    moved = type(piece)(
        piece.uv + 12 * piece.normal.mean(axis=0),
        piece.normal,
        piece.width,
        piece.strength,
        piece.sigma,
        piece.saturated,
    )
    assert movement_px([moved], [piece]) == pytest.approx(12, rel=0.1)
    assert np.isnan(movement_px([], lines))


WELL = HandState(3, 3, 0.05, 20.0, 1920, 90.0, 255.0, 0.0)


def changed(**values) -> HandState:
    return HandState(**{name: values.get(name, getattr(WELL, name)) for name in WELL.__slots__})


@pytest.mark.parametrize(
    ("state", "word"),
    [
        (changed(strength=8.0), "Brighter"),
        (changed(saturated=0.6), "Darker"),
        (changed(speed_px=200.0), "Slower"),
        (changed(lines_met=1, sigma_mm=float("nan")), "Cross more of the fan"),
        (changed(sigma_mm=0.8), "Tilt the laser more"),
    ],
)
def test_each_fault_of_the_hand_has_its_hint(state, word):
    assert any(word in str(hint) for hint in hints_for(state, HintLimits()))


def test_there_are_two_hints_at_most_and_none_when_all_is_well():
    assert hints_for(WELL, HintLimits()) == ()
    assert len(hints_for(changed(strength=5.0, speed_px=300.0, sigma_mm=2.0), HintLimits())) == 2


def test_coverage_counts_cells_of_what_was_lit():
    area = CoverageMap((1920, 1374))
    assert area.share == 0
    u, v = np.meshgrid(np.arange(400, 800, 5.0), np.arange(400, 800, 5.0))
    grid = np.column_stack([u.ravel(), v.ravel()])
    area.add_lit(grid)
    assert area.share == 0
    area.add(grid[grid[:, 0] < 600])
    assert area.share == pytest.approx(0.5, abs=0.05)
    assert area.cells.shape == (69, 96)
    area.add(np.array([[-3.0, 5000.0]]))  # out of the picture: the nearest cell
    assert area.cells[-1, 0]


def test_speed_is_per_frame_even_when_frames_were_not_looked_at(block):
    preview = Preview(block.reference, block.camera, block.fan)
    speeds = [
        preview(FrameFeatures(index, block.features[k].name, block.features[k].centrelines)).speed_px
        for index, k in ((0, 1), (1, 2), (5, 3))
    ]
    assert np.isnan(speeds[0])
    assert speeds[2] < 0.5 * speeds[1]


def test_a_cloud_that_grows_too_large_is_thinned(block):
    preview = Preview(block.reference, block.camera, block.fan, PreviewOptions(most_points=1500))
    for features in block.features:
        shown(preview, features)
    assert len(preview.cloud()) < 3500
    assert len(block.preview.cloud()) > 4000


def test_a_window_that_adds_and_replaces_as_it_is_told_never_holds_many_more_than_the_most_points(block):
    preview = Preview(block.reference, block.camera, block.fan, PreviewOptions(most_points=1500))
    fan = sum(len(piece) for line in block.preview.fan_lines for piece in line)
    held, counts = [], []
    for index in range(4 * len(block.features)):
        features = block.features[index % len(block.features)]
        frame = shown(preview, features, index)
        held = [*held, frame.points] if frame.renewed is None else [frame.renewed.points]
        counts.append(sum(map(len, held)) - fan)
    per_frame = max(len(frame.points) for frame in block.frames)
    assert max(counts) <= 1500 + 2 * per_frame
    assert counts[-1] > 300


@pytest.mark.accuracy
def test_a_long_scan_is_thinned_alike_from_its_first_frame_to_its_last(block):
    preview = Preview(block.reference, block.camera, block.fan, PreviewOptions(most_points=1500))
    count = len(block.features)
    for index in range(4 * count):
        shown(preview, block.features[index % count], index)
    kept = [sum(len(preview._stripes[index]) for index in range(k * count, (k + 1) * count)) for k in (0, 3)]
    assert kept[0] == pytest.approx(kept[1], rel=0.1)


def test_no_frame_waits_for_the_cloud_to_be_renewed_and_no_renewal_takes_long_at_a_time(block, monkeypatch):
    monkeypatch.setattr(preview_module, "RENEWED_AT_ONCE", 3 * preview_module.RELOCATION)
    preview = Preview(block.reference, block.camera, block.fan)
    located, together = [], []
    one, all_of_them = tracking.SweepTracker._located, tracking.locate_together
    monkeypatch.setattr(tracking.SweepTracker, "_located", lambda *a: (located.append(a), one(*a))[1])
    monkeypatch.setattr(tracking, "locate_together", lambda *a: (together.append(a), all_of_them(*a))[1])
    renewed, most = 0, 0
    for features in block.features:
        located.clear()
        together.clear()
        renewed += preview(features).renewed is not None
        assert len(located) <= 1
        assert not together
        located.clear()
        if preview.has_more:
            preview.go_on()
            most = max(most, len(located))
    assert renewed >= 3
    assert most == 3


def test_points_that_come_while_the_cloud_is_being_renewed_are_in_it(block, monkeypatch):
    monkeypatch.setattr(preview_module, "RENEWED_AT_ONCE", preview_module.RELOCATION)
    preview = Preview(block.reference, block.camera, block.fan)
    for features in block.features[:24]:
        frame = preview(features)
        if frame.renewed is not None and features.index > 12:
            break
        for _ in range(2):
            if preview.has_more:
                preview.go_on()
    assert 12 < features.index < 24
    assert set(np.unique(frame.renewed.frame)) >= {k for k in range(8, features.index) if len(block.frames[k].points)}


def test_a_scan_that_goes_on_for_long_keeps_no_more_and_more(block, monkeypatch):
    monkeypatch.setattr(tracking, "MOST_RENEWED", 12)
    preview = Preview(block.reference, block.camera, block.fan, PreviewOptions(most_points=1500))
    tracker, points, crossed = preview._tracker, [], []
    for index in range(60):
        shown(preview, block.features[3 * index % len(block.features)], index)
        points.append(sum(map(len, preview._stripes.values())))
        crossed.append(sum(len(sweep.crossings) > 0 for sweep in tracker.sweeps()))
    assert max(points) <= 1500
    assert all(stripe.rays.base is None for stripe in list(preview._stripes.values())[:5])
    assert max(crossed) <= 12 + 40
    assert crossed[-1] <= 12 + len(tracker._anchors)
    assert len(preview.cloud()) > 200
