"""Result of a scan: the cloud, the sweeps, and a record of every frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.messages import Message
from core.model.arrays import Array
from core.scan.between_frames import Between
from core.scan.features.crossings import CrossingTable
from core.scan.features.frames import FrameRecord
from core.scan.known_planes.points_on_planes import PlaneAgreement
from core.scan.network.datum import Datum
from core.scan.network.fan_residuals import TIMES
from core.scan.network.fan_speckle import FanSpeckle
from core.scan.network.read_out import AT_ONCE, ReadOut
from core.scan.surface.cloud import Cloud
from core.scan.sweeps.fan_lines import FanLines
from core.scan.sweeps.ghosts import NO_BOUNCES, SecondBounces

__all__ = ["FrameRecord", "ScanResult"]


@dataclass(frozen=True, eq=False, slots=True)
class ScanResult:
    """Result of solving a scan: its surface points, the sweeps' light planes, and how well all crossings agree.

    Parameters
    ----------
    cloud
        All points whose σ is within the cut, the fan's own included.
    pis
        (S, 3) light planes of the sweeps in 1/mm; (S, 3·(1 + K)) where `read_out` says that they change with the rows.
    covariance
        (3S, 3S) or larger of them stacked, without what camera and fan have in common.
    sweep_frames
        (S,) the frame of each sweep.
    frames
        One record for every frame of the recording.
    crossings, crossing_weights
        All crossings, and the weight (0 left out … 1) each had.
    crossing_reasons
        (M,) whether a crossing counts, or why not: `core.scan.features.frames.CrossingUse`.
    fan_lines
        The number given to each of the fan's centrelines.
    scale
        Standard deviation of unit weight of the adjustment; 1 where the noise model is true.
    notes
        Notes for the technician.
    datum
        Strength with which the fan fixes scale and place; None when frames were solved each on its own.
    speckle
        The error common to the fan's own points and the sweeps; None when frames were solved each on its own.
    second_bounces
        The pieces of the sweeps' light that were left out as such.
    moved
        Whether object, table or camera moved within the scan; None where frames or crossings are too few to tell.
    drifted
        Whether camera or fan moved evenly from its first frame to its last; None where frames are too few to tell.
    read_out
        How planes change while the camera reads its rows out.
    collapsed
        Whether the sweeps' light planes have fallen together into one, so that no depth can be trusted.
    fan_disagrees
        Whether sweeps and fan disagree by more than U need contain, and no single change of the rig explains it.
    rig_changed
        Whether a single change of camera or fan since their calibration explains crossings that disagree.
    unsure_share
        Share of the sweeps' points that are less sure than the σ cut, and left out.
    movements
        Between which frames something moved, by light or crossings, each movement once.
    rig_explained
        Share of what crossings are off too much that a single change of camera or fan explains; None if none does.
    rows_seen_to_roll
        Whether the crossings, and nothing that is stated, say that planes change with the rows.
    crossing_lines
        (M,) the fan's line of each crossing, from 0; −1 between sweeps; known planes are numbered after the lines.
    planes
        What the sweeps' points on each known plane say of it.
    printed
        (C,) which of the fan's centrelines are print on known planes, and no light.
    """

    cloud: Cloud
    pis: Array
    covariance: Array
    sweep_frames: NDArray[np.int64]
    frames: tuple[FrameRecord, ...]
    crossings: CrossingTable
    crossing_weights: Array
    fan_lines: FanLines
    scale: float
    notes: tuple[Message, ...] = ()
    datum: Datum | None = None
    speckle: FanSpeckle | None = None
    crossing_reasons: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    read_out: ReadOut = AT_ONCE
    moved: bool | None = None
    drifted: bool | None = None
    collapsed: bool = False
    fan_disagrees: bool = False
    rig_changed: bool = False
    unsure_share: float = 0.0
    second_bounces: SecondBounces = NO_BOUNCES
    movements: tuple[Between, ...] = ()
    rig_explained: float | None = None
    rows_seen_to_roll: bool = False
    crossing_lines: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    planes: tuple[PlaneAgreement, ...] = ()
    printed: NDArray[np.bool_] | None = None

    @property
    def needs_cause(self) -> bool:
        """Whether the scan shows a fault whose cause is to be sought, such as a movement or too large a misfit."""
        seen = self.movements or self.drifted or self.fan_disagrees or self.rig_changed or self.second_bounces.pieces
        return bool(seen) or self.rows_seen_to_roll or self.scale > TIMES

    @property
    def of_solved(self) -> NDArray[np.bool_]:
        """Mask (M,) of the crossings of solved sweeps that are no second bounces (light mirrored by the part).

        Frames after a movement are not solved.
        """
        table = self.crossings
        solved = np.isin(table.a, self.sweep_frames) & (table.with_fan | np.isin(table.b, self.sweep_frames))
        return np.asarray(solved & ~self.second_bounces.among(table))
