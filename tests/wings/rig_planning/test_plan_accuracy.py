"""What a plan foretells, against what the twin then delivers: rendered, calibrated and measured like any recording."""

from dataclasses import replace

import numpy as np
import pytest

from core.files.recording.recording_set import open_set
from core.pipeline.steps.camera_step import camera_step
from core.pipeline.steps.gauge_step import gauge_step
from core.pipeline.steps.planes_step import planes_step
from core.pipeline.steps.scan_step import scan_step
from core.pipeline.steps.workspace import Workspace
from core.scan.method import ReconstructOptions
from core.settings.options import Options
from core.simulate.recording import simulate_set
from core.simulate.scenario import Scenario
from core.wings.rig_planning.prediction.design import Design
from core.wings.rig_planning.prediction.predict import Planner

HEIGHT, CUT_MM = 50.0, 0.2
PAPER = Design(pixels=(960, 687), pixel_um=6.68, sweeps=40)
"""The paper's rig at a quarter of its resolution: a set is rendered and measured in half a minute."""
RIGS = {
    "the paper's": PAPER,
    "a longer baseline, fewer poses and sweeps": replace(PAPER, baseline_mm=90.0, poses=5, sweeps=28),
}
WITHIN = 0.25


def measured(design: Design, seed: int, folder):
    """u and error in mm of the thickness, and the median σ of the points, that the twin delivers for a design."""
    scenario = Scenario(
        height_mm=HEIGHT,
        seed=seed,
        scale=0.25,
        frames=design.sweeps,
        camera_views=design.views,
        plane_poses=design.poses,
        speckle=design.speckle,
    )
    simulate_set(scenario, folder / "set", rig=design.rig())
    work = Workspace.open(open_set(folder / "set"), folder / "out")
    camera_step(work)
    planes_step(work)
    scan = scan_step(work, Options(sigma_cut_mm=CUT_MM)).scan
    gauge = gauge_step(work)
    return gauge.u_mm, gauge.thickness_mm - HEIGHT, float(np.median(scan.cloud.sigma))


@pytest.mark.accuracy
@pytest.mark.parametrize("name", RIGS)
def test_the_twin_delivers_the_uncertainty_that_was_planned(name, tmp_path):
    design = RIGS[name]
    planned = Planner(solving=ReconstructOptions(sigma_cut_mm=CUT_MM)).predict(design, HEIGHT, scans=2)
    u, error, sigma = measured(design, seed=1, folder=tmp_path)
    own = float(np.nanmedian(planned.sigma.own))
    print(f"{name}: planned u {planned.u_mm:.4f} mm, delivered {u:.4f} mm (error {error:+.4f} mm)")
    print(f"{name}: planned σ of a depth {own:.3f} mm, delivered {sigma:.3f} mm")

    assert planned.u_mm == pytest.approx(u, rel=WITHIN)
