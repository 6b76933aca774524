"""The plan of a project: the numbers of `trisect inspect`, written among the results."""

import json
import shutil
from dataclasses import replace

import pytest

from core.errors import InputError
from core.files.inspection_plan_file import write_plan
from core.inspect.inspection_plan import Auto, FeatureSpec, InspectionPlan
from core.pipeline.inspect_step import inspect_step
from core.pipeline.project_inspection import look_at_features, measure_features
from core.pipeline.project_steps import results_folder

pytestmark = pytest.mark.xdist_group("small simulated set")

PLAN = InspectionPlan(
    (
        FeatureSpec("table", "plane", (Auto(1),)),
        FeatureSpec("top", "plane", (Auto(2),)),
        FeatureSpec("height", "distance", of=("top", "table")),
        FeatureSpec("ball", "sphere", (Auto(1),)),
    )
)


@pytest.fixture
def folder(done, tmp_path):
    shutil.copytree(done.folder, tmp_path / "copy")
    return tmp_path / "copy"


def test_it_gives_the_numbers_of_the_command_line_and_writes_the_same_file(done, folder, tmp_path):
    shown = measure_features(folder, replace(done.project, inspection=PLAN))
    results = results_folder(folder)
    mine = json.loads((results / "inspection.json").read_text())
    write_plan(tmp_path / "plan.toml", PLAN)
    inspect_step(results, PLAN, tmp_path, tmp_path)
    assert mine == json.loads((tmp_path / "inspection.json").read_text())
    height = next(one for one in shown.features if one.name == "height")
    assert height.rows[0].value == pytest.approx(50.0, abs=3 * height.rows[0].u + 0.2)


def test_looking_writes_nothing(done, folder):
    look_at_features(folder, replace(done.project, inspection=PLAN))
    assert not (results_folder(folder) / "inspection.json").exists()


def test_what_cannot_be_measured_says_why_and_the_rest_is_measured(done, folder):
    plan = InspectionPlan((*PLAN.features[:3], FeatureSpec("far plane", "plane", (Auto(9),))))
    shown = measure_features(folder, replace(done.project, inspection=plan))
    assert shown.features[3].problem and not shown.features[3].rows
    assert shown.features[2].rows


def test_without_a_scan_it_is_one_sentence(done, tmp_path):
    with pytest.raises(InputError, match="scan"):
        measure_features(tmp_path, replace(done.project, inspection=PLAN))
