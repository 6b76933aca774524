"""The map of deviations of a project, as the window draws it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.files.project.folder import read_project, results_folder
from core.files.results.mesh_export import write_stl
from core.files.results.ply import read_mesh
from core.inspect.plan.feature_spec import Deviation, FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.pipeline.project import inspection as project_inspection
from core.pipeline.project.inspection import look_at_features, measure_features
from tests.pipeline.project.test_inspection import drawn
from tests.simulated import copy_of


def test_what_is_drawn_is_of_the_scan_and_kept_so_that_it_need_not_be_measured_again(
    finished_project_folder, tmp_path, monkeypatch
):
    folder = copy_of(finished_project_folder, tmp_path / "copy")
    write_stl(folder / "nominal.stl", read_mesh(results_folder(folder) / "mesh.ply"))
    plan = InspectionPlan((FeatureSpec("itself", "deviation", deviation=Deviation("nominal.stl", "as measured", 0.4)),))
    project = replace(read_project(folder).project, inspection=plan)
    shown = measure_features(folder, project)
    (itself,) = shown.features
    assert not itself.problem
    shares = [one.share for one in itself.deviations.classes]
    assert sum(shares) == pytest.approx(1) and shares[4] > 0.9
    assert [one.mark for one in itself.deviations.classes][:2] == ["−!", "−−−"]
    assert int(itself.deviations.counts.sum()) > 0
    nominal = itself.deviations.nominal.reshape(-1, 3)
    nearest, _ = cKDTree(itself.places[::50]).query(nominal)
    assert len(nominal) and np.median(nearest) < 10, "as it was aligned: where the part is"
    monkeypatch.setattr(project_inspection, "inspect", lambda *_: pytest.fail("measured again"))
    assert drawn(look_at_features(folder, project)) == drawn(shown)
