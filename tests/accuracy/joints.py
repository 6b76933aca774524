"""Two views of a block in its carrier, rendered with hidden truth, joined by its rings: the thickness and its error.

python -m tests.accuracy joints --scale 0.25 --seeds 5
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.files.recording.recording_set import open_set
from core.inspect.results import GaugeResult
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.join_step import JoinResult, joined_views, view_workspaces
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.settings.options import Options
from core.simulate.effects.carrier import CarrierBeside
from core.simulate.recording import scan_of, scenario_rig, simulate_set, turned_over
from core.simulate.scenario import Scenario
from core.simulate.scene.carrier import calibrated_carrier, pose_table_carrier
from core.simulate.scene.stage import table_pose
from core.simulate.truth import load_truth
from core.views.joint import Joint, join
from core.views.joint_check import check_joint
from core.views.marks_seen import see_marks

MARKS = 12
VIEWS = ("scan", "turned")
COARSE_CUT_MM = 0.3
"""Cut on σ of quarter-size pictures."""


def scenario(seed: int, scale: float, frames: int = 30, **effects: Any) -> Scenario:
    """A block of 50 mm in its carrier, seen from above and turned over."""
    return Scenario(seed=seed, scale=scale, frames=frames, carrier=CarrierBeside(marks=MARKS, **effects))


def measure_joint(case: Scenario, folder: Path, calibrated: Path | None = None) -> tuple[JoinResult, float]:
    """Render and measure both views in `folder`; the joint with the thickness, and the true thickness in mm.

    With `calibrated`, a folder measured earlier, its calibration is taken over.
    """
    recording, out = folder / "set", folder / "out"
    simulate_set(case, recording, calibration_from=calibrated / "set" if calibrated else None)
    work = Workspace.open(open_set(recording), out)
    settings = Options(sigma_cut_mm=COARSE_CUT_MM) if case.scale < 0.5 else Options()
    if calibrated:
        for name in ("camera.json", "planes.json", "planes.npz"):
            shutil.copy(calibrated / "out" / name, out / name)
    else:
        camera_step(work, settings)
        planes_step(work, settings)
    for view in view_workspaces(work).values():
        scan_step(view, settings)
    return joined_views(work), float(load_truth(recording).thing["thickness_mm"])


def figures(result: JoinResult, true_mm: float) -> dict[str, Any]:
    """What a joint has shown, in mm."""
    gauge = result.thickness
    assert isinstance(gauge, GaugeResult)
    return {
        "error": gauge.thickness_mm - true_mm,
        "u": gauge.u_mm,
        "U": gauge.U_mm,
        "budget": {str(row.source): row.u_mm for row in gauge.budget},
        "notes": [note.code for note in gauge.notes],
        "doubts": [doubt.fact for doubt in gauge.doubts],
        "marks": [len(seen) for seen in result.joined.joint.seen],
    }


def joint_by_marks(case: Scenario) -> Joint:
    """Join both views by the marks in two rendered references, the camera known."""
    rig, carrier = scenario_rig(case), calibrated_carrier(case)
    both = zip((case, turned_over(case)), VIEWS, strict=True)
    seen = [see_marks(scan_of(one, rig)[0].reference(), carrier, view) for one, view in both]
    return join(carrier, seen, rig.camera)


def marks_alone(seed: int, scale: float, **effects: Any) -> dict[str, Any]:
    """The joint by the marks in two rendered references, the camera known: its error along the thickness.

    Of what the marks and the carrier leave, without a scan: a hundredth of its time.
    """
    case = scenario(seed, scale, 0, **effects)
    rig, joint = scenario_rig(case), joint_by_marks(case)
    both = (case, turned_over(case))
    first, second = (table_pose(one.setup) @ pose_table_carrier(one) for one in both)
    at, up = first.translation, first.rotation[:, 2]
    off = ((joint.pose(1) @ (first @ second.inverse()).inverse()).apply(at[None])[0] - at) @ up
    check = check_joint(joint, rig.camera, at, up)
    told = ({doubt.fact for doubt in check.doubts} | {note.code for note in check.notes}) - {"slip_unseen"}
    return {
        "seed": seed,
        "error": float(off),
        "u": check.u_mm,
        "U": 2 * check.u_mm,
        "told": sorted(told),
        "marks": [len(one) for one in joint.seen],
        "chi2": joint.chi2 / joint.redundancy,
    }


def joints(scale: float, seeds: int, folder: Path, **effects: Any) -> list[dict[str, Any]]:
    """Measure a joint for each of the first `seeds` seeds, each with a calibration of its own."""
    found = []
    for seed in range(1, seeds + 1):
        place = folder / str(seed)
        found.append({"seed": seed, **figures(*measure_joint(scenario(seed, scale, **effects), place))})
        print(_row(found[-1]), flush=True)
        shutil.rmtree(place)
    return found


def _row(one: Mapping[str, Any]) -> str:
    parts = ", ".join(f"{name} {u:.4f}" for name, u in sorted(one["budget"].items(), key=lambda item: -item[1])[:5])
    return (
        f"seed {one['seed']}: error {one['error']:+.4f} mm, u {one['u']:.4f}, U {one['U']:.4f}, "
        f"error/u {one['error'] / one['u']:+.2f}; {parts}; {one['doubts']} {one['notes']}"
    )


def summary(found: list[dict[str, Any]]) -> str:
    """Largest error, RMS of error over u, and the share within U."""
    errors, u, U = (np.array([one[name] for one in found]) for name in ("error", "u", "U"))
    return (
        f"{len(found)} joints: largest {np.abs(errors).max():.4f} mm, RMS error/u "
        f"{np.sqrt(np.mean((errors / u) ** 2)):.2f}, |error| <= U in {np.mean(np.abs(errors) <= U):.0%}, median U "
        f"{np.median(U):.4f} mm"
    )
