"""plan.toml: what is to be inspected, read and written.

k = 2.0

[frame]                       # part coordinates by 3-2-1, if regions or a nominal surface need them
primary = "top"
secondary = "side"
tertiary = "ball"

[temperature]                 # then lengths are stated at 20 °C
part_celsius = 22.3
u_part_celsius = 0.3
alpha_per_K = 11.5e-6
u_alpha_per_K = 1.0e-6

[[feature]]
name = "ball"
kind = "sphere"
region = { polygon_px = [[800, 500], [1100, 500], [950, 800]] }
filters = { sigma_max_mm = 0.05 }
limits.diameter = { nominal_mm = 50.0, tolerance_mm = 0.05 }
"""

from __future__ import annotations

from pathlib import Path

from core.errors import InputError
from core.files.atomic import write_text
from core.files.complaints import checked
from core.files.plan.tables import PlanTables
from core.files.plan.translation import plan_of, plan_tables
from core.files.reading import read_toml
from core.files.toml_text import toml_text
from core.inspect.plan.inspection_plan import InspectionPlan
from core.messages import Message

_MISSING = Message("inspection.plan_missing", "the file is missing; it says what is to be inspected")
_WRITE_ONE = Message(
    "advice.write_plan", "write one as the manual shows, page Inspect, or make it on the workbench's Inspect page"
)


def read_plan(path: Path) -> InspectionPlan:
    """Read and check the inspection plan in a plan.toml; InputError if it is missing or wrong.

    Raises
    ------
    InputError
        If it is missing, is no TOML, has an unknown key, a value is absurd, or features do not fit together. The
        sentence names the file and the field or feature.
    """
    tables = read_toml(path, missing=_MISSING, todo=_WRITE_ONE)
    plan = plan_of(checked(PlanTables, tables, path), path)
    try:
        plan.ordered()
    except InputError as error:
        raise InputError(error.what, where=f"{path}, {error.where}", todo=error.todo) from error
    return plan


def write_plan(path: Path, plan: InspectionPlan) -> None:
    """Write an inspection plan as a file plan.toml for `read_plan`; InputError if it cannot be written."""
    write_text(path, toml_text(plan_tables(plan)))
