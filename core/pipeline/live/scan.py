"""A live scan: boards and reference first, then every frame to the disk, and as many as there is time for previewed."""

from __future__ import annotations

import time
from dataclasses import replace
from threading import Thread
from typing import Protocol

import numpy as np

from core.acquire.settings import FREE_RUNNING, SourceSettings
from core.acquire.source import Frame, Lasers, Picture, Unplugged
from core.errors import InputError
from core.files.recording.marks import mark_frame
from core.image.exclusion import MOVEMENTS
from core.messages import Message, label, plain
from core.pipeline.live.boards import FoundBoards, LiveBoards
from core.pipeline.live.checks import ScanChecks
from core.pipeline.live.commands import Command, Configure, Mark, Pause, Resume, TakeBoards, TakeReference
from core.pipeline.live.context import LiveContext
from core.pipeline.live.events import LiveSaving, ScanDetail, ScanStage
from core.pipeline.live.preview import PreviewedFrame, PreviewFailed, ReferenceMismatch, ScanPreviewer
from core.pipeline.live.recorded_features import RecordedFeatures
from core.pipeline.live.warm_up import get_ready_for_live
from core.scan.preview.shown import FramePreview, PreviewCloud, cloud_of
from core.scan.surface.coverage_map import CoverageMap

REFERENCE = "reference"

STILL_SHARE = 2e-4
"""Two pictures of a scene at rest differ in no larger share of their pixels."""
STILL_LEVELS = 0.12
"""A pixel differs if it does by more than this share of the largest grey level."""

MOVED_FRAMES = 5
"""After so many frames in a row that do not suit the reference it is said."""

SAY_EVERY_S = 0.2
"""How often in s it is told how many frames still wait for the disk."""
STUCK_S = 2.0
"""A disk that has not taken a frame for so long when all is to be saved is given one last try."""

LOOKING_S = 10.0
"""So long the end of a recording waits for frames to be looked at; then the measurement does it, which shows how far
it is and can be cancelled."""

SLOWER = 0.8
"""A camera that is too fast for the disk is told so much of the rate it has."""
SLOWED_FOR_S = 2.0
"""And told again only after so long: what waits is written first."""

_SLOWER_ADVICE = {
    ".png": Message("live.record_pgm", "Record PGM, which takes less time, or choose a lower frame rate."),
    ".pgm": Message("live.lower_rate", "Choose a lower frame rate."),
}

_DARK = Lasers(fan=False, hand=False)


class FrameStore(Protocol):
    """Writer of frames that does not block the caller (core.files.recording.recorder.Recorder)."""

    @property
    def written(self) -> int:
        """Number of frames on the disk."""

    @property
    def dropped(self) -> int:
        """Number of frames that were refused because the disk was too slow, or given up."""

    @property
    def waiting(self) -> int:
        """Number of frames accepted but not yet written to the disk."""

    def write(self, name: str, picture: Picture, frame: Frame | None = None, camera: str = "") -> bool:
        """Queue a picture, that of a `frame` of the `camera`, to be written; False if the disk is too slow."""

    def close(self) -> None:
        """Wait until all accepted frames are on the disk."""


class LiveScan:
    """Step of a live recording in which the reference and then the frames of a scan are recorded and previewed."""

    def __init__(self, context: LiveContext, store: FrameStore) -> None:
        self._context, self._store, request = context, store, context.request
        self._previewer = ScanPreviewer(
            request.camera, request.fan, request.options.stripe, has_fan=request.rig.has_fan
        )
        self._boards = LiveBoards(context)
        self._stage: ScanStage = "boards" if request.boards and request.camera is not None else "reference"
        has_fan = request.rig.has_fan
        self._fan_alone, self._all = Lasers(fan=has_fan, hand=False), Lasers(fan=has_fan, hand=True)
        self._self_switching = False
        self._looking = self._forced = False
        self._before: Picture | None = None
        self._number, self._newest = 0, ""
        self._preview: FramePreview | None = None
        self._coverage: CoverageMap | None = None
        self._moved = 0
        self._slowed_s = -np.inf
        self._looked = False
        self._new: list[PreviewCloud] = []
        self._renewed = False
        self._checks = ScanChecks(context, self._previewer, self._boards)
        self._features: RecordedFeatures | None = None

    @property
    def show_with_findings(self) -> bool:
        """Whether it is scanning; then the frame is shown with the stripe that was found in it."""
        return self._stage == "scanning"

    def begin(self) -> None:
        """Switch the lasers as the scan needs them now; take boards and reference, or ask for them, if they are not."""
        stage = self._stage
        self._context.source.prepare("boards" if stage == "boards" else "scan")
        self._self_switching = self._context.switch(
            _DARK if stage == "boards" else self._fan_alone if stage == "reference" else self._all
        )
        self._before = None
        if stage not in ("boards", "reference"):
            return
        if self._self_switching:
            self._looking = True
        elif not self._looking:
            self._ask()

    def frame(self, frame: Frame) -> None:
        """Record a frame, and have it previewed if there is time."""
        if self._coverage is None:
            height, width = frame.picture.shape
            self._coverage = CoverageMap((width, height))
            self._checks.begin((width, height))
            levels = np.uint8 if frame.picture.dtype == np.uint8 else np.uint16
            Thread(target=get_ready_for_live, args=(levels,), name="warm up", daemon=True).start()
        if self._stage in ("boards", "reference") and self._looking:
            self._try_at_rest(frame.picture)
        elif self._stage == "ready" and self._checks.are_due:
            self._context.worker.start(self._previewer.departed, frame.picture)
        elif self._stage == "scanning":
            self._record(frame)

    def poll(self) -> Frame | None:
        """Take the result of previewing a frame or reading the reference; return the frame previewed, else None."""
        try:
            result = self._context.worker.take()
        except InputError as error:  # the reference shows no fan, or a board's picture is none
            self._refused(error.message)
            return None
        match result:
            case PreviewFailed(sentence):
                self._context.notice(sentence)
            case PreviewedFrame(frame, preview):
                self._add(preview)
                self._looked = True
                self._checks.stripes(preview.centrelines)
                return frame
            case ReferenceMismatch(reason):
                self._checks.reference(reason)
            case FoundBoards() if self._stage == "boards":
                self._take_boards(result)
            case np.ndarray() if self._stage == "reference":
                self._accept(result)
        return None

    def rest(self) -> None:
        """Start one piece of the preview's postponed work (`ScanPreviewer.go_on`), at most once after each frame."""
        if self._looked and self._previewer.has_more and self._context.worker.start(self._previewer.go_on):
            self._looked = False

    def detail(self, shown: Frame) -> ScanDetail | None:
        """Return the state of the scan with the last preview and all points new since the last call; None at first."""
        if self._coverage is None:
            return None
        points, renewed = PreviewCloud.joined(self._new), self._renewed
        self._new, self._renewed = [], False
        return ScanDetail(
            index=-1 if self._preview is None else self._preview.index,
            stage=self._stage,
            preview=self._preview,
            fan_lines=self._previewer.fan_lines,
            cells=self._coverage.cells.copy(),
            lit=self._coverage.lit.copy(),
            share=self._coverage.share,
            points=points,
            renewed=renewed,
        )

    def handle(self, command: Command) -> None:
        """Follow the commands TakeBoards, TakeReference, Pause, Resume, Mark and Configure; ignore all others."""
        match command:
            case Configure():
                self._checks.configured()
            case TakeReference() if self._stage == "reference":
                self._look()
            case TakeBoards() if self._stage == "boards":
                self._look()
            case TakeReference() if self._stage == "boards":
                pass
            case TakeReference():
                self._context.notice(
                    Message(
                        "live.reference_there",
                        "The reference is taken already: stop, and start another recording for a new one.",
                    )
                )
            case Resume() if self._stage in ("ready", "paused"):
                self._context.answered()
                self._stage = "scanning"
            case Pause() if self._stage == "scanning":
                self._stage = "paused"
            case Mark() if self._newest:
                self._mark(self._newest)

    def finish(self) -> None:
        """Write all frames to the disk, report how many still wait, and count what is there."""
        waiting, since = self._store.waiting, time.monotonic()
        while waiting and time.monotonic() - since < STUCK_S:
            self._context.emit(LiveSaving(waiting))
            time.sleep(SAY_EVERY_S)
            if self._store.waiting < waiting:
                waiting, since = self._store.waiting, time.monotonic()
        try:
            self._store.close()
        finally:
            self._context.recorded, self._context.lost = self._store.written, self._store.dropped
            self._keep_features()

    def _keep_features(self) -> None:
        """Have the frames looked at that have not been, as long as that is a matter of seconds."""
        features = self._features
        if features is None:
            return
        features.finish()
        until = time.monotonic() + LOOKING_S
        while not features.wait(SAY_EVERY_S):
            if time.monotonic() > until:
                features.give_up()
                return
            self._context.emit(LiveSaving(0, features.unseen))

    def _record(self, frame: Frame) -> None:
        name = f"frame{self._number:05d}"
        try:
            taken = self._store.write(name, frame.picture, frame, self._context.camera)
        except InputError as error:  # the disk is full: what waits for it is kept and tried again
            self._context.lost += 1
            self._stage = "paused"
            paused = Message("live.paused", "Recording is paused. {reason} Then press Continue.", reason=error.message)
            self._context.ask(paused, label("Continue"), Resume())
            return
        if not taken:
            self._context.lost += 1
            if self._is_slowed(frame.time_s):
                return
            self._context.notice(
                Message(
                    "live.disk_too_slow", "The disk is too slow for all frames: some are lost. {todo}",
                    todo=_SLOWER_ADVICE[self._context.request.ending],
                )
            )  # fmt: skip
            return
        self._context.worker.start(self._previewer.look, self._number, name, frame)
        if self._features is not None:
            self._features.add(name)
        self._number, self._newest = self._number + 1, name
        self._context.recorded += 1

    def _is_slowed(self, now_s: float) -> bool:
        """Have fewer frames come, where the source lets itself be told; whether it does."""
        context, rate_hz = self._context, SLOWER * self._context.rate_hz
        limits, by_itself = context.capabilities.rate_hz, context.settings.trigger in (None, FREE_RUNNING)
        if limits is None or not by_itself or not limits[0] <= rate_hz <= limits[1]:
            return False
        if now_s - self._slowed_s < SLOWED_FOR_S:
            return True
        settings = SourceSettings(rate_hz=rate_hz)
        try:
            context.source.configure(settings)
        except Unplugged:
            raise
        except InputError:  # it may have no such rate: the loss itself is told
            return False
        context.settings, self._slowed_s = context.settings.updated(settings), now_s
        context.notice(
            Message(
                "live.rate_lowered",
                "The disk is too slow for {before_hz:.3g} frames a second, and some were lost: the camera takes "
                "{rate_hz:.3g} from now on.",
                before_hz=context.rate_hz, rate_hz=rate_hz,
            )
        )  # fmt: skip
        return True

    def _mark(self, name: str) -> None:
        try:
            mark_frame(self._context.request.folder, f"{name}{self._context.request.ending}")
        except InputError as error:  # no reason to end a recording
            self._context.notice(error.message)
            return
        self._context.notice(Message("live.marked", "{name} is marked.", name=name))

    def _look(self) -> None:
        """Look for what is at rest from the next picture on; told so a second time: take it as it is."""
        self._context.answered()
        self._forced, self._looking, self._before = self._looking, True, None

    def _ask(self) -> None:
        if self._stage == "boards":
            boards = Message(
                "live.take_boards",
                "Switch all lasers off and let light fall on the boards ({boards:and}), then take them. From now on "
                "nothing may move.",
                boards=tuple(plain(name) for name in self._boards.missing),
            )
            self._context.ask(boards, label("Take the boards"), TakeBoards())
            return
        if self._fan_alone.fan:
            alone = Message(
                "live.take_reference",
                "Switch the three-line laser on and the hand-held laser off, then take the reference.",
            )
        else:
            alone = Message(
                "live.take_dark_reference",
                "Dim the light as for the scan, with the hand-held laser off, then take the reference.",
            )
        self._context.ask(alone, label("Take the reference"), TakeReference())

    def _try_at_rest(self, picture: Picture) -> None:
        """Take a picture that is like the one before: nothing moves, no laser is swept over it."""
        before, self._before = self._before, picture
        if self._context.worker.busy:
            return
        if not self._forced and before is None:
            return
        if not self._forced and before is not None and not _alike(before, picture):
            self._context.notice(
                Message(
                    "live.something_moves",
                    "Something moves in the picture: keep object and camera at rest, the hand-held laser off.",
                )
            )
            return
        camera = self._context.request.camera
        if self._stage == "boards" and camera is not None:
            self._context.worker.start(self._boards.seek, picture, camera)
        else:
            self._context.worker.start(self._previewer.read_reference, picture)

    def _take_boards(self, found: FoundBoards) -> None:
        """Keep the boards that were found; with all of them, or told to do without the others, go on."""
        why = self._boards.take(found)
        has_some = bool(self._boards.planes) or self._fan_alone.fan
        if why is not None and not (self._forced and has_some):
            self._refused(why)
            return
        self._looking = self._forced = False
        self._previewer.know(self._boards.planes)
        self._stage = "reference"
        self._checks.reference()
        self.begin()

    def _accept(self, picture: Picture) -> None:
        """The reference is good: keep it and go on."""
        self._context.write(REFERENCE, picture)
        self._context.took(REFERENCE, picture)
        self._looking = self._forced = False
        self._checks.accepted()
        request = self._context.request
        if request.camera is not None:
            settings = replace(request.options.for_scan, excluded=frozenset())
            self._features = RecordedFeatures(
                request.folder, request.ending, request.rig, request.camera, settings, lambda: self._store.written
            )
        fan = self._previewer.fan_cloud()
        self._new, self._renewed = [fan], True
        if self._coverage is not None:
            self._coverage.add(fan.uv)
        if self._self_switching and self._context.switch(self._all):
            self._stage = "scanning"
            return
        self._stage = "ready"
        self._context.lasers = self._all
        sweep = Message(
            "live.start_sweeping", "Switch the hand-held laser on, press Start, and sweep it slowly over the object."
        )
        self._context.ask(sweep, label("Start"), Resume())

    def _refused(self, sentence: Message) -> None:
        self._context.notice(sentence)
        self._forced = False
        if not self._self_switching:
            self._looking = False
            self._ask()

    def _add(self, preview: FramePreview) -> None:
        """Keep what the frame adds until it is shown."""
        self._moved = self._moved + 1 if preview.exclusion in MOVEMENTS else 0
        if self._moved == MOVED_FRAMES:
            self._context.notice(
                Message(
                    "live.frames_moved", "{reason:capital}. These frames give no points: stop, and scan again.",
                    reason=preview.reason,
                )
            )  # fmt: skip
        self._preview = preview
        if self._coverage is not None:
            for piece in preview.centrelines:
                self._coverage.add_lit(piece.uv)
        renewed = preview.renewed
        if renewed is not None:
            self._new, self._renewed = [renewed], True
        elif len(preview.points):
            self._new.append(cloud_of(preview))
        if self._coverage is not None:
            self._coverage.add(preview.point_uv if renewed is None else renewed.uv)
        self._preview = replace(preview, renewed=None)


def _alike(before: Picture, after: Picture) -> bool:
    """Whether two pictures show the same light: a hand-held laser trembles and is seen as a change."""
    limit = STILL_LEVELS * np.iinfo(after.dtype).max
    difference = np.abs(after[::2, ::2].astype(np.int32) - before[::2, ::2])
    return bool(np.mean(difference > limit) <= STILL_SHARE)
