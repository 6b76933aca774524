"""A study of each kind, and a report with all of them."""

import numpy as np

from core.wings.studies.kinds.acceptance import Reading, acceptance_check
from core.wings.studies.kinds.budget import from_stated
from core.wings.studies.kinds.grr import grr_study
from core.wings.studies.kinds.repeats import Requirement, repeat_study
from core.wings.studies.kinds.series import StatedUncertainty, series_study
from core.wings.studies.kinds.type1 import type1_study
from core.wings.studies.printed import printed
from tests.report.inspection_samples import whole_content


def studies():
    """One of each kind."""
    rng = np.random.default_rng(4)
    values = 50.0 + rng.normal(0.002, 0.004, 25)
    parts = 49.9 + 0.05 * rng.standard_normal((5, 1, 1)) + 0.002 * rng.standard_normal((5, 3, 2))
    repeated = (50.004 + 0.006 * rng.standard_normal(12)).tolist()
    budget = from_stated(repeated, [0.01] * 12)
    known = {"complete": True, "U": [0.02] * 12, "asked": Requirement(50.0, (-0.1, 0.1))}
    series = (50.0 + 0.01 * rng.standard_normal(40)).tolist()
    series[25] += 0.06
    readings = [Reading("form", f"p{place}", 0.02 + 0.001 * place, u=0.001) for place in range(10)]
    readings += [Reading("size", f"p{place}", 50.01 - 0.002 * place, 50.0, 0.001) for place in range(4)]
    return (
        type1_study(values, 50.0, 0.4),
        grr_study(parts, tolerance=0.4),
        series_study(series, (49.9, 50.1), stated=StatedUncertainty(0.003, 0.006), name="width"),
        repeat_study(repeated, budget, **known),
        acceptance_check(readings, {"form": 0.05, "size": 0.012}),
    )


def reported():
    """The same as a report prints them."""
    return tuple(map(printed, studies()))


def studied_content(**changes):
    """A report of an inspection with everything in it, these studies among it."""
    return whole_content(**{"studies": reported(), **changes})
