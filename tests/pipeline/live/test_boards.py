"""A live scan with boards beside the part: their pictures first, and without a fan a preview by known planes."""

from dataclasses import replace

import numpy as np
import pytest

from core.acquire.source import Frame, Lasers
from core.files.recording.recording_set import PlanePictures, gather_set
from core.files.recording.rig import KnownPlaneTarget, Rig
from core.image.targets import BlackSquare, Checkerboard
from core.model import Fan
from core.pipeline.live import recorded_features
from core.pipeline.live.commands import Resume, TakeBoards, TakeReference
from core.pipeline.live.events import LiveAsk, LiveChecks, LiveNotice, LiveTaken
from core.pipeline.live.preview import ScanPreviewer
from core.pipeline.steps.scan.known_planes import seek_board
from core.scan.preview.shown import PreviewCloud, cloud_of
from core.simulate.effects.boards import BoardsBeside
from core.simulate.recording import BOARDS_GREY, scan_of
from core.simulate.scenario import Scenario
from core.simulate.scene.known_planes import stated_planes
from tests.pipeline.live_bench import ScriptedSource, Window, record

SCENARIO = Scenario(scale=0.3, frames=24, fan_lines=0, boards=BoardsBeside(corner=True))


class Corner:
    """A simulated scan without a fan before a corner of two boards, rendered once."""

    def __init__(self):
        stage, sheets, _ = scan_of(SCENARIO)
        self.camera, self.depth = stage.rig.camera, stage.maps.depth
        self.rig = Rig(
            Checkerboard(17, 12, 10.0),
            BlackSquare(60.0),
            0,
            0.0,
            known_planes=stated_planes(SCENARIO, stage.scene.boards, stage.rig.camera),
        )
        self.boards, self.reference = stage.boards(0, BOARDS_GREY), stage.reference()
        self.frames = [stage.frame(index, sheet) for index, sheet in enumerate(sheets)]


@pytest.fixture(scope="module")
def corner():
    return Corner()


@pytest.fixture(autouse=True)
def no_features(monkeypatch):
    monkeypatch.setattr(recorded_features, "LOOK_AHEAD", 10**9)


class Source(ScriptedSource):
    """Shows the boards, the reference or the frames, by what it is to show and which lasers are on."""

    def __init__(self, corner, **how):
        super().__init__(self.shown, len(corner.frames), counts=lambda lasers: lasers.hand, **how)
        self.corner, self.step = corner, "scan"

    def prepare(self, step):
        super().prepare(step)
        self.step = step

    def shown(self, lasers: Lasers, number: int):
        if self.step == "boards":
            return self.corner.boards
        return self.corner.frames[self.counted % len(self.corner.frames)] if lasers.hand else self.corner.reference


def live(monkeypatch, folder, corner, source, window, **choices):
    rig = choices.pop("rig", corner.rig)
    boards = choices.pop("boards", tuple(rig.known_planes))
    return record(
        monkeypatch, source, window, "scan", rig, folder / "scan",
        **{"camera": corner.camera, "fan": Fan(()), "boards": boards, **choices},
    )  # fmt: skip


def test_boards_are_taken_first_then_a_dark_reference(monkeypatch, tmp_path, corner):
    window = Window()
    source = Source(corner)
    ended = live(monkeypatch, tmp_path, corner, source, window)
    assert ended.error is None
    assert [one.name for one in window.all(LiveTaken)] == ["planes/near", "planes/far", "reference"]
    assert not window.all(LiveAsk)
    told = source.calls
    assert told.index("boards") < told.index(Lasers(fan=False, hand=True))
    assert not any(isinstance(call, Lasers) and call.fan for call in told)
    found = gather_set(corner.rig, None, None, tmp_path / "scan")
    assert [len(board.pictures) for board in found.known_planes] == [1, 1]
    assert len(found.frames) == ended.recorded == len(corner.frames)
    assert {check.name: check.state for check in window.all(LiveChecks)[-1].checks} == {
        "boards": "ok",
        "reference": "ok",
        "calibration": "unknown",
    }


def test_a_person_is_asked_for_boards_and_reference_where_lasers_are_switched_by_hand(monkeypatch, tmp_path, corner):
    asked = []

    def answer(event):
        if isinstance(event, LiveAsk):
            asked.append(str(event.sentence))
            return event.answer
        return None

    source = Source(corner, switches=False)

    def lit(answered):
        source.lit = Lasers(fan=False, hand=isinstance(answered, Resume))

    window = Window(lambda event: (lit(event.answer) if isinstance(event, LiveAsk) else None) or answer(event))
    ended = live(monkeypatch, tmp_path, corner, source, window)
    assert ended.error is None and ended.recorded
    assert [type(ask.answer) for ask in window.all(LiveAsk)] == [TakeBoards, TakeReference, Resume]
    assert "near and far" in asked[0] and "three-line laser" not in asked[1]


def test_a_board_that_is_not_seen_is_told_and_waited_for_until_one_does_without(monkeypatch, tmp_path, corner):
    small = KnownPlaneTarget(BlackSquare(20.0))
    rig = replace(corner.rig, known_planes={**corner.rig.known_planes, "aside": small})
    window = Window(lambda event: TakeBoards() if isinstance(event, LiveNotice) else None)
    ended = live(monkeypatch, tmp_path, corner, Source(corner), window, rig=rig)
    assert ended.error is None and ended.recorded
    assert "aside" in str(window.all(LiveNotice)[0].sentence)
    assert [one.name for one in window.all(LiveTaken)] == ["planes/near", "planes/far", "reference"]
    boards = next(check for check in window.all(LiveChecks)[-1].checks if check.name == "boards")
    assert boards.state == "failed" and "aside" in str(boards.message)


def test_two_boards_locate_the_sweeps_of_the_preview_truly(corner):
    previews = previewed(corner, ("near", "far"))
    shown = []
    for preview in previews:
        shown = [preview.renewed] if preview.renewed is not None else [*shown, cloud_of(preview)]
    cloud = PreviewCloud.joined(shown)
    u, v = np.rint(cloud.uv.T).astype(int)
    error = np.abs(cloud.points[:, 2] - corner.depth[v, u])
    assert len(error) > 2000
    assert np.median(error) < 0.15
    assert np.quantile(error, 0.9) < 1.0
    reasons = [str(reason) for preview in previews for reason in preview.crossing_reason]
    assert "Good: it lies on the board near." in reasons
    assert not any("fan" in reason for reason in reasons)


def test_one_board_alone_locates_no_sweep_and_shows_no_point(corner):
    looked = previewed(corner, ("near",))
    assert not any(len(preview.points) for preview in looked)
    assert {str(preview.reason) for preview in looked} == {"its stripe lies on too few boards to be located"}


def previewed(corner, names):
    """The previews of all frames, by the boards with these names."""
    previewer = ScanPreviewer(corner.camera, Fan(()), has_fan=False)
    boards = [PlanePictures(name, corner.rig.known_planes[name]) for name in names]
    found = [seek_board(board, [(board.name, corner.boards)], corner.camera, corner.rig) for board in boards]
    previewer.know([one.plane for one in found])
    previewer.read_reference(corner.reference)
    previews = []
    for index, picture in enumerate(corner.frames):
        previews.append(previewer.look(index, f"{index}", Frame(picture, index, index / 10, 0)).preview)
        while previewer.has_more:
            assert previewer.go_on() is None
    return previews
