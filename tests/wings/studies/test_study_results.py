"""Results of folders as a study takes them: any characteristic by its name, angles in degrees."""

import math

import pytest

from core.errors import InputError
from core.files.atomic import write_text
from core.files.json_text import to_json
from core.inspect.causes import Cause
from core.inspect.characteristic import Characteristic
from core.inspect.plan.conditions import Temperature
from core.inspect.plan.temperature import at_reference
from core.wings.studies.files.results import measured_in
from core.wings.studies.kinds.budget import add_up


def inspection(folder, *rows):
    write_text(folder / "inspection.json", to_json({"schema_version": 1, "characteristics": list(rows)}))
    return folder


def row(name, value, **more):
    return {"name": name, "feature": name, "kind": "distance", "value": value, "u": 0.002, "k": 2.0, **more}


def test_a_length_is_found_by_its_name_with_its_whole_budget(tmp_path):
    budget = [
        {"source": "a", "u": 0.002, "point_mm": 0.1, "distribution": "rectangular", "dof": 8, "value": 5, "unit": "K"}
    ]
    limits = {"nominal": 10.0, "lower": None, "upper": 0.1}
    folder = inspection(tmp_path, row("gap", 1.0), row("width", 10.01, budget=budget, limits=limits))
    found = measured_in(folder, "width")
    assert (found.value, found.u, found.unit) == (10.01, 0.002, "mm")
    assert (found.limits.lower, found.limits.upper) == (-math.inf, 0.1)
    (only,) = found.budget
    assert (only.distribution, only.dof, only.value, only.unit) == ("rectangular", 8, 5, "K")
    assert add_up(found.budget).dof == pytest.approx(8)


def test_an_angle_comes_in_degrees_with_all_that_belongs_to_it(tmp_path):
    limits = {"nominal": math.radians(30), "lower": -0.01, "upper": 0.01}
    angle = row("tilt", math.radians(30), quantity="angle", limits=limits, budget=[{"source": "a", "u": 0.002}])
    found = measured_in(inspection(tmp_path, angle), "tilt")
    assert (found.value, found.unit) == (pytest.approx(30), "deg")
    assert found.u == found.budget[0].u_mm == pytest.approx(math.degrees(0.002))
    assert (found.limits.nominal, found.limits.upper) == pytest.approx((30, math.degrees(0.01)))


def test_a_name_that_is_not_there_is_told_with_those_that_are(tmp_path):
    with pytest.raises(InputError, match=r'no result is called "width"; there are gap, tilt'):
        measured_in(inspection(tmp_path, row("gap", 1.0), row("tilt", 1.0)), "width")


def test_temperature_enters_the_budget_with_its_value_and_its_sensitivity():
    hot = Temperature(part_celsius=30.0, u_part_celsius=0.5, alpha=11.5e-6, u_alpha=1e-6)
    rows = {
        one.source: one
        for one in at_reference(Characteristic("bar", "thickness", 100.0, 0.001, doubts=()), hot, 2.0).budget
    }
    expansion = rows[Cause.PART_EXPANSION]
    assert (expansion.value, expansion.point_mm, expansion.unit) == (11.5e-6, 1e-6, "1/K")
    assert expansion.sensitivity == pytest.approx(100.0 * 10)  # mm per 1/K: L θ
