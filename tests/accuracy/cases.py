"""Which scans the accuracy table rests on: rendered with hidden truth, calibrated from pictures of their own seed."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import numpy as np

from core.simulate.scenario import Scenario

HEIGHTS = (40.0, 50.0, 60.0, 70.0)
FULL, HALF = 1.0, 0.5
SEEDS, SHORT_SEEDS = (1, 2, 3, 4, 5), (1,)
REPLACED_SEEDS = tuple(range(11, 21))
SPHERE_SEEDS, MASK_SEEDS = (31, 32, 33), (41,)


@dataclass(frozen=True, slots=True)
class Case:
    """One scan of the campaign.

    `group` says which rows of the table it serves; with `paper` the paper's own procedure, three crossings a frame, is
    tried on the same pictures.
    """

    group: str
    scenario: Scenario
    paper: bool = False

    @property
    def name(self) -> str:
        """Readable, and its own for each scenario: results are kept under it."""
        s = self.scenario
        key = hashlib.sha256(s.key.encode()).hexdigest()[:6]
        return f"{self.group}-{s.object}{s.height_mm:g}-x{s.scale:g}-seed{s.seed}-{key}"


def cases(*, short: bool) -> list[Case]:
    """All scans, those of one seed's calibration after one another; `short`: one of each kind, at half resolution."""
    scales = (HALF,) if short else (FULL, HALF)
    seeds = SHORT_SEEDS if short else SEEDS
    chosen: list[Case] = []
    for scale in scales:
        for seed in seeds:
            wide = [Scenario(height_mm=height, seed=seed, scale=scale) for height in HEIGHTS]
            chosen += [Case("wide", each, paper=seed == seeds[0]) for each in wide]
            narrow = [Scenario("narrow-block", height, seed, scale) for height in HEIGHTS]
            chosen += [Case("narrow", each) for each in narrow if seed in seeds[:2]]
        chosen += [Case("mask", Scenario("mask", 60.0, seed, scale), paper=True) for seed in MASK_SEEDS]
        chosen += [Case("sphere", Scenario("sphere", 50.0, seed, scale)) for seed in SPHERE_SEEDS[: 1 if short else 3]]
    chosen += [Case("replaced", replaced(seed, scales[0])) for seed in REPLACED_SEEDS[: 2 if short else None]]
    return chosen


def replaced(seed: int, scale: float) -> Scenario:
    """The 50 mm block put down anew, and everything calibrated anew."""
    rng = np.random.default_rng(seed)
    right, away = rng.uniform(-12, 12, 2)
    return Scenario(
        height_mm=50.0,
        seed=seed,
        scale=scale,
        yaw_deg=float(np.round(rng.uniform(-20, 20), 2)),
        right_mm=float(np.round(right, 2)),
        away_mm=float(np.round(away, 2)),
    )


def calibration_key(scenario: Scenario) -> tuple[int, float]:
    """Scans with the same key share their calibration pictures."""
    return scenario.seed, scenario.scale
