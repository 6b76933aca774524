"""The uncertainty a planned rig will state of a thickness, and the σ of every place it will see.

The real calibrations, the real network and the real gauge solve simulated features: exact geometry, and noise such as
the extraction leaves. So the prediction is their own covariance, and follows them when they become better. As one scan
is lucky and another is not, a few are drawn and the root mean square of their u is what to expect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from core.calibrate.change import STABLE, Stability, changes, judge
from core.calibrate.deviations import Deviation
from core.calibrate.fan.interim_check import check_poses
from core.calibrate.results import NO_FAN
from core.errors import InputError
from core.inspect.gauge import adjusted, measure_gauge
from core.inspect.plan.temperature import temperature_contributions, temperature_of
from core.inspect.results import Contribution, GaugeResult
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.inspect.uncertainty.skewed_light import NOTHING_SEEN, unseen_mean_mm
from core.messages import Message
from core.model.arrays import Array
from core.pipeline.steps.workspace import Calibration
from core.progress import Progress, StepProgress, silent
from core.scan.common_errors import solve_common
from core.scan.features.extraction import ScanFeatures
from core.scan.known_planes.plane_deviations import followed_by_planes, own_deviations
from core.scan.method import ReconstructOptions
from core.scan.reconstruct import reconstruct
from core.scan.results import ScanResult
from core.scan.scan_evidence import scan_evidence
from core.scan.surface.cloud import Cloud
from core.wings.rig_planning.prediction.boards import plan_planes
from core.wings.rig_planning.prediction.calibrating import plan_camera, plan_check, plan_fan
from core.wings.rig_planning.prediction.design import Design, PlanError
from core.wings.rig_planning.prediction.scanning import plan_scan

MAP_COLUMNS = 48
"""Cells of the σ map across the picture."""
FIRST_SEED = 1
"""Scans are drawn with this seed and the following ones, so that a prediction can be repeated."""

T = TypeVar("T")


@dataclass(frozen=True, eq=False, slots=True)
class SigmaMap:
    """σ of the depth over the picture, in mm: (rows, columns) cells of `cell_px`, NaN where nothing is measured.

    `own` differs from point to point (median of a cell), `common` is what camera and fan do to the whole scan.
    """

    own: Array
    common: Array
    cell_px: float

    @property
    def total(self) -> Array:
        """Combined own and common σ of the depth in mm, (rows, columns); NaN where nothing is measured."""
        return np.asarray(np.hypot(self.own, self.common))


@dataclass(frozen=True, eq=False, slots=True)
class Prediction:
    """Prediction of a plan for one block.

    Parameters
    ----------
    height_mm
        Its thickness.
    u_mm
        Expected standard uncertainty of the thickness: root mean square over the scans drawn.
    each_u_mm, errors_mm
        (D,) what each of them states, and how far off each is.
    budget
        What u consists of, in the same mean.
    sigma
        Of the first scan.
    sweeps_used
        Sweeps of the first scan that give points.
    points
        Points of the first scan within the σ cut.
    """

    height_mm: float
    u_mm: float
    k: float
    each_u_mm: tuple[float, ...]
    errors_mm: tuple[float, ...]
    budget: tuple[Contribution, ...]
    sigma: SigmaMap
    sweeps_used: int
    points: int

    @property
    def U_mm(self) -> float:
        """Expanded uncertainty U = k u of the thickness, in mm."""
        return self.k * self.u_mm


@dataclass(slots=True)
class Planner:
    """Predictor that stores what plans that differ in little have in common.

    A scan is solved as `solving` says. Of the `part` what its temperature, expansion and surface make uncertain is
    known before any picture; None leaves it out. `stability` is how far the rig may change between calibration and
    scan: None assumes the default, as a measurement does.
    """

    progress: Progress = silent
    solving: ReconstructOptions = field(default_factory=ReconstructOptions)
    part: Part | None = None
    stability: Stability | None = STABLE
    _known: dict[tuple[object, ...], object] = field(default_factory=dict)

    def predict(self, design: Design, height_mm: float, scans: int = 1) -> Prediction:
        """Predict the uncertainty of the thickness of a block of `height_mm`, by simulating `scans` scans of it.

        Raises
        ------
        InputError
            If the plan cannot measure: something is not seen, not found or not determined.
        """
        drawn = []
        for number in range(scans):
            self.progress("scans drawn", number, scans)
            with _as_errors_of_a_plan():
                drawn.append(self._draw(design, height_mm, FIRST_SEED + number))
        self.progress("scans drawn", scans, scans)
        gauges = [gauge for gauge, _ in drawn]
        cloud = drawn[0][1]
        each = tuple(gauge.u_mm for gauge in gauges)
        return Prediction(
            height_mm,
            _rms(each),
            gauges[0].k,
            each,
            tuple(gauge.thickness_mm - height_mm for gauge in gauges),
            _mean_budget(gauges),
            _sigma_map(cloud, design.pixels),
            len(np.unique(cloud.sweep[cloud.sweep >= 0])),
            len(cloud),
        )

    def _draw(self, design: Design, height_mm: float, seed: int) -> tuple[GaugeResult, Cloud]:
        told = StepProgress(self.progress)
        calibration = self._calibration(design, seed)
        camera, control = calibration.camera.camera, calibration.control
        features = self._features(design, height_mm, seed)
        scan = reconstruct(features, camera, control.fan, self.solving, told.within_step, planes=control.planes)
        deviations = self._deviations(design, seed, calibration, scan)
        common = solve_common(scan, camera, control, deviations, progress=told.within_step)
        cloud = replace(scan.cloud, sigma_common=common.sigma(scan.cloud))
        errors = PointErrors.of_scan(features, scan.covariance, common, scan.speckle, scan.pis.shape[1])
        gauge = measure_gauge(cloud, errors=errors, progress=told.within_step)
        if self.part is not None:
            gauge = adjusted(gauge, 0.0, _known_rows(self.part, height_mm))
        if abs(gauge.thickness_mm / height_mm - 1) > 0.1:
            raise PlanError(
                Message(
                    "plan.face_not_found",
                    "the block's upper face ({height_mm:g} mm) would not be found among the points seen",
                    height_mm=height_mm,
                ),
                where="[plan]",
                todo=Message("plan.advice_more_sweeps", "plan more sweeps, a larger block, or a fan that falls on it"),
            )
        return gauge, cloud

    def _calibration(self, design: Design, seed: int) -> Calibration:
        told = StepProgress(self.progress)
        known = replace(design, poses=Design().poses, **_SCAN_ONLY)
        camera = self._remembered(("camera", known, seed), lambda: plan_camera(known, seed, told.within_step))
        if not design.has_fan:
            return Calibration(camera, NO_FAN).with_planes(plan_planes(design, camera.camera, seed))
        whole = replace(design, **_SCAN_ONLY)
        fan = self._remembered(("fan", whole, seed), lambda: plan_fan(design, camera.camera, seed, told.within_step))
        return Calibration(camera, fan)

    def _deviations(
        self,
        design: Design,
        seed: int,
        calibration: Calibration,
        scan: ScanResult,
    ) -> tuple[Deviation, ...]:
        """Those of the calibrations, and what may have changed since, as far as scan and check do not exclude it."""
        camera, fan, control = calibration.camera.camera, calibration.fan, calibration.control
        own = tuple(own_deviations(camera, control, fan_has_scale=False))
        deviations = calibration.deviations
        if self.stability == STABLE:
            return (*deviations, *own)
        deviations = (*deviations, *followed_by_planes(changes(camera, fan.fan), camera, control, fan.scale_sd))
        evidence = scan_evidence(scan, camera, control, deviations)
        seen = plan_check(design, seed) if design.has_fan else []
        if seen:
            evidence += check_poses(seen, camera, fan, deviations)[1]
        judged = judge(camera, fan.fan, deviations, evidence, self.stability, planes=control.plane_pis)
        return (*judged.deviations, *own)

    def _features(self, design: Design, height_mm: float, seed: int) -> ScanFeatures:
        known = replace(
            design,
            views=Design().views,
            poses=Design().poses,
            check_poses=Design().check_poses,
            camera_target=Design().camera_target,
            plane_target=Design().plane_target,
        )
        return self._remembered(
            ("scan", known, height_mm, seed),
            lambda: plan_scan(design, height_mm, seed, StepProgress(self.progress).within_step),
        )

    def _remembered(self, key: tuple[object, ...], make: Callable[[], T]) -> T:
        if key not in self._known:
            self._known[key] = make()
        made: T = self._known[key]  # type: ignore[assignment]
        return made


def _known_rows(part: Part, height_mm: float) -> tuple[Contribution, ...]:
    """Rows of the budget of a block that are known before it is measured: those of its surface and temperature."""
    temperature = temperature_of(part)
    return (
        *part.surface_rows,
        *(() if temperature is None else temperature_contributions(height_mm, temperature)),
    )


def light_not_foretold(part: Part) -> Message | None:
    """Make the message that light from below the part's surface may add to U of a scan; None if it cannot."""
    if not part.lets_light_in:
        return None
    return Message(
        "plan.light_not_foretold",
        "Light may come from below the part's surface: U of a scan has a row for it besides, up to {most_mm:.2f} mm as "
        "U of a thickness if the stripes' sections tell nothing; only a scan knows. Of a part stated to be metal or "
        "sprayed it has none.",
        most_mm=2 * np.sqrt(2) * unseen_mean_mm(NOTHING_SEEN, 1.0, part.lets_light_in),
    )


_SCAN_ONLY = {
    name: getattr(Design(), name)
    for name in ("sweeps", "hand_baseline_mm", "heights_mm", "block_mm", "ambient_grey", "check_poses")
}
"""Quantities that calibrations do not feel, at their defaults."""


@contextmanager
def _as_errors_of_a_plan() -> Iterator[None]:
    """What the solvers say of pictures, said of a rig that has none yet; complaints about the plan pass as they are."""
    try:
        yield
    except PlanError:
        raise
    except InputError as error:
        raise PlanError(
            Message("plan.not_measurable", "a recording with this rig could not be measured ({why})", why=error.what),
            where="[plan]",
            todo=Message("plan.advice_go_back", "go back to the paper's values one by one to see which of yours it is"),
        ) from error


def _mean_budget(gauges: list[GaugeResult]) -> tuple[Contribution, ...]:
    sources = list(dict.fromkeys(row.source for gauge in gauges for row in gauge.budget))
    shares = {
        source: _rms(tuple(sum(row.u_mm for row in gauge.budget if row.source == source) for gauge in gauges))
        for source in sources
    }
    return tuple(Contribution(source, u) for source, u in shares.items())


def _rms(values: tuple[float, ...]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _sigma_map(cloud: Cloud, pixels: tuple[int, int]) -> SigmaMap:
    cell = pixels[0] / MAP_COLUMNS
    rows = int(np.ceil(pixels[1] / cell))
    column, row = (np.floor((cloud.uv + 0.5) / cell).astype(np.int64)).T
    flat = np.clip(row, 0, rows - 1) * MAP_COLUMNS + np.clip(column, 0, MAP_COLUMNS - 1)
    own, common = np.full(rows * MAP_COLUMNS, np.nan), np.full(rows * MAP_COLUMNS, np.nan)
    order = np.argsort(flat, kind="stable")
    for cell_points in np.split(order, np.flatnonzero(np.diff(flat[order])) + 1):
        own[flat[cell_points[0]]] = np.median(cloud.sigma[cell_points])
        common[flat[cell_points[0]]] = np.median(cloud.sigma_common[cell_points])
    return SigmaMap(own.reshape(rows, -1), common.reshape(rows, -1), cell)
