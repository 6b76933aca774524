"""One full frame of the digital twin, rendered once, and a table for ratios."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np
import pytest

from core.image.stripes.noise import NoiseModel
from core.image.stripes.settings import choose_settings
from core.image.stripes.stripe import StripeSettings
from core.scan.features.extraction import ReferenceFeatures, choose_sweep_stripe, read_reference
from core.simulate.recording import scan_of
from core.simulate.scenario import Scenario


@dataclass(frozen=True)
class FullFrame:
    """A frame of 3840 × 2748 px with four stripes, the reference without the fourth, and how to look at them."""

    frame: np.ndarray
    base: np.ndarray
    reference: ReferenceFeatures
    stripe: StripeSettings
    noise: NoiseModel

    @property
    def four(self) -> np.ndarray:
        """All four stripes at once."""
        return self.frame.astype(np.float32)


@cache
def full_frame(speckle: float) -> FullFrame:
    stage, sheets, _ = scan_of(Scenario(frames=12, seed=3, speckle=speckle))
    base, frame = stage.reference(), stage.frame(5, sheets[5])
    reference = read_reference(base)
    stripe = choose_sweep_stripe([("frame", frame)], reference) or choose_settings(frame.astype(np.float32), 255.0)
    assert stripe is not None
    return FullFrame(frame, base, reference, stripe, reference.noise)


@pytest.fixture(scope="session", autouse=True)
def one_thread():
    cv2.setNumThreads(1)


@pytest.fixture(scope="session")
def clean() -> FullFrame:
    return full_frame(0.0)


@pytest.fixture(scope="session")
def speckled() -> FullFrame:
    return full_frame(0.18)


def processor_ms(job: Callable[[], Any], rounds: int = 7) -> float:
    """The shortest processor time of `job` in ms: other programs on the machine disturb it least."""
    job()
    times = []
    for _ in range(rounds):
        began = time.thread_time()
        job()
        times.append(time.thread_time() - began)
    return 1e3 * min(times)


def table(capsys: pytest.CaptureFixture[str], title: str, rows: dict[str, str]) -> None:
    """Print a table in spite of pytest's capturing."""
    with capsys.disabled():
        print(f"\n\n{title}")
        for label, value in rows.items():
            print(f"  {label:<52}{value}")
