"""The preview of a live scan: pictures in, what is shown of them out. Called from one thread beside the recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from core.acquire.source import Frame, Picture
from core.image.exclusion import Exclusion
from core.image.stripes.centreline import Centreline
from core.image.stripes.stripe import StripeSettings
from core.messages import Message
from core.model import Camera, Fan
from core.scan.features.extraction import (
    FeatureOptions,
    FrameFeatures,
    FrameReader,
    ReferenceFeatures,
    choose_sweep_stripe,
    read_reference,
)
from core.scan.known_planes.known_plane import Control, KnownPlane
from core.scan.preview.frames import Preview
from core.scan.preview.shown import FramePreview, PreviewCloud, empty_preview

SETTINGS_FROM = 3
"""The stripe's width and contrast are looked for anew in so many frames that show it, and then kept."""


@dataclass(frozen=True, eq=False, slots=True)
class PreviewedFrame:
    """Frame of a live scan with its preview."""

    frame: Frame
    preview: FramePreview


@dataclass(frozen=True, slots=True)
class PreviewFailed:
    """Failure of the preview of a live scan, with its reason; the recording goes on."""

    sentence: Message


@dataclass(frozen=True, slots=True)
class ReferenceMismatch:
    """Reason why a picture without the hand-held laser disagrees with the reference; None if it agrees."""

    reason: Message | None


class ScanPreviewer:
    """Previewer of a scan: it reads the reference and then frames, one at a time.

    Without a calibrated camera and fan it shows stripes only; `has_fan` says whether the rig has one. If not, `know`
    the planes by which sweeps are located. An error nobody thought of ends the preview, never the recording.
    """

    def __init__(
        self, camera: Camera | None, fan: Fan | None, stripe: StripeSettings | None = None, *, has_fan: bool = True
    ) -> None:
        self._camera, self._stripe, self._has_fan = camera, stripe, has_fan
        self._known: Control | None = None if fan is None else Control(fan)
        self._reference: ReferenceFeatures | None = None
        self._preview: Preview | None = None
        self._seen: list[StripeSettings] = []
        self._to_learn_from: Picture | None = None
        self._failed = False

    @property
    def fan_lines(self) -> tuple[tuple[Centreline, ...], ...]:
        """The reference's centrelines for each line of the fan, as far as settled; uncalibrated, all in one.

        () before there is a reference.
        """
        if self._preview is not None:
            return self._preview.fan_lines
        return () if self._reference is None else (self._reference.fan,)

    @property
    def full_scale(self) -> float:
        """Largest grey level of the pictures."""
        return 255.0 if self._reference is None else self._reference.full_scale

    def know(self, planes: Sequence[KnownPlane]) -> None:
        """Set the known planes of the scene, before the reference is read."""
        self._known = replace(self._known or Control(Fan(())), planes=tuple(planes))

    def departed(self, picture: Picture) -> ReferenceMismatch:
        """Check whether a picture still agrees with the reference; `reason` is None if so, or before a reference."""
        if self._reference is None:
            return ReferenceMismatch(None)
        seen = FrameReader(self._reference, None)((0, ("", picture)))
        return ReferenceMismatch(None if seen.exclusion is Exclusion.WITHOUT_STRIPE else seen.reason)

    def fan_cloud(self) -> PreviewCloud:
        """Collect all points previewed so far, only the fan's after `read_reference`; none if uncalibrated."""
        return PreviewCloud.joined([]) if self._preview is None else self._preview.cloud()

    def read_reference(self, picture: Picture) -> Picture:
        """Extract the fan's lines from the reference (H, W), start the preview with them, and return the picture.

        Raises
        ------
        InputError
            If it shows no line of a fan that is there.
        """
        self._reference = read_reference(picture, FeatureOptions(fan_stripe=self._stripe, has_fan=self._has_fan))
        known = self._known
        if self._camera is not None and known is not None and (known.fan.lines or known.planes):
            self._preview = Preview(self._reference, self._camera, known)
        return picture

    def look(self, index: int, name: str, frame: Frame) -> PreviewedFrame | PreviewFailed | None:
        """Preview the frame of number `index` in the recording; None before a reference or after a failure."""
        if self._reference is None or self._failed:
            return None
        try:
            return PreviewedFrame(frame, self._shown(self._reference, index, name, frame.picture))
        except Exception as error:  # noqa: BLE001  a preview is never worth a recording
            return self._fail(error)

    @property
    def has_more(self) -> bool:
        """Whether the previewer has work for `go_on`, which is put off until a frame has been shown."""
        waits = self._to_learn_from is not None or (self._preview is not None and self._preview.has_more)
        return waits and not self._failed

    def go_on(self) -> PreviewFailed | None:
        """Learn the stripe's look from a frame, or locate some earlier sweeps again; return a failure, else None."""
        picture, self._to_learn_from = self._to_learn_from, None
        try:
            if self._reference is not None and picture is not None:
                self._learn(self._reference, picture)
            elif self._preview is not None:
                self._preview.go_on()
            return None
        except Exception as error:  # noqa: BLE001  as above
            return self._fail(error)

    def _fail(self, error: Exception) -> PreviewFailed:
        self._failed = True
        return PreviewFailed(
            Message(
                "live.preview_failed",
                "The preview has stopped because of an error in it ({kind}: {reason}). "
                "The frames are recorded all the same.",
                kind=type(error).__name__,
                reason=str(error),
            )
        )

    def _shown(self, reference: ReferenceFeatures, index: int, name: str, picture: Picture) -> FramePreview:
        features = self._features(reference, index, name, picture)
        if self._preview is not None:
            return self._preview(features)
        return replace(empty_preview(index, name, features.exclusion), centrelines=features.centrelines)

    def _features(self, reference: ReferenceFeatures, index: int, name: str, picture: Picture) -> FrameFeatures:
        """With the stripe as it is known; before it has been seen once, as if it were like the fan's."""
        stripe = self._stripe
        if stripe is None and self._seen:
            stripe = sorted(self._seen, key=lambda seen: seen.contrast)[len(self._seen) // 2]
        features = FrameReader(reference, stripe or reference.stripe)((index, (name, picture)))
        learning = self._stripe is None and len(self._seen) < SETTINGS_FROM
        if learning and features.exclusion in (None, Exclusion.WITHOUT_STRIPE):  # of others nothing is learned
            self._to_learn_from = picture
        return features

    def _learn(self, reference: ReferenceFeatures, picture: Picture) -> None:
        """Look for the stripe's width and contrast, which takes several times as long as to look at a frame."""
        found = choose_sweep_stripe([("", picture)], reference)
        self._seen += [] if found is None else [found]
