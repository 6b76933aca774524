"""study.json read back is the same study; what is damaged is told."""

import json
import math

import numpy as np
import pytest

from core.errors import InputError
from core.findings.proof import Doubt
from core.inspect.causes import cause_named
from core.inspect.results import Contribution
from core.wings.studies.files.study_file import read_study, study_values, write_study
from core.wings.studies.kinds.acceptance import Reading, acceptance_check
from core.wings.studies.kinds.budget import from_budgets
from core.wings.studies.kinds.doubted import DoubtedResult
from core.wings.studies.kinds.grr import grr_study
from core.wings.studies.kinds.repeats import Requirement, repeat_study
from core.wings.studies.kinds.series import StatedUncertainty, series_study
from core.wings.studies.kinds.type1 import type1_study

VALUES = [50.01, 50.03, 50.02, 50.04]


def repeats(limits):
    rows = (Contribution(cause_named("camera"), 0.01, 2.0, "rectangular", 9.0, 7.0, "°C"),)
    budget = from_budgets(VALUES, [rows] * 4)
    return repeat_study(
        VALUES, budget, complete=True, name="width", labels="abcd", U=[0.1, math.nan, 0.1, 0.1],
        asked=Requirement(50.0, limits, 0.83),
    )  # fmt: skip


STUDIES = {
    "repeats": repeats((-0.1, 0.1)),
    "repeats with one limit": repeats((-math.inf, 0.1)),
    "repeats without limits": repeats(None),
    "type 1": type1_study(VALUES, 50.0, 1.0, resolution=0.01),
    "gauge R&R": grr_study(np.random.default_rng(0).normal(size=(4, 3, 2)), tolerance=6.0, operators="ABC"),
    "acceptance": acceptance_check(
        [Reading("size", "left", 30.01, 30.0, 0.001), Reading("form", "left", 0.02)], {"size": 0.05}, k=3.0
    ),
    "series": series_study(
        np.random.default_rng(0).normal(50.0, 0.01, 100).tolist(),
        (49.9, math.inf),
        size=4,
        stated=StatedUncertainty(0.001, 0.003),
        doubted=(DoubtedResult("7", (Doubt.named("moved"),)),),
    ),
    "short series": series_study(VALUES, (49.9, 50.1), labels="abcd"),
}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_read_back_gives_the_same_file_to_the_last_digit(tmp_path, name):
    path = write_study(tmp_path / "new" / "folder", STUDIES[name])
    again = write_study(tmp_path, read_study(path))
    assert path.read_bytes() == again.read_bytes()
    assert study_values(read_study(path))["verdict"] == STUDIES[name].verdict


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.update(kind="other"), 'kind is "other"'),
        (lambda t: t["scans"][0].update(value="x"), 'is "x", not a finite number'),
        (lambda t: t.update(scans=[]), "repeats need one finite thickness or more"),
        (lambda t: t.pop("budget_of_mean"), "budget_of_mean is missing"),
    ],
)
def test_a_damaged_study_is_told_in_one_sentence(tmp_path, change, said):
    path = write_study(tmp_path, STUDIES["repeats"])
    tables = json.loads(path.read_text())
    change(tables)
    path.write_text(json.dumps(tables))
    with pytest.raises(InputError, match=said):
        read_study(path)


def test_a_missing_study_says_how_to_come_by_it(tmp_path):
    with pytest.raises(InputError, match="trisect study"):
        read_study(tmp_path / "study.json")
