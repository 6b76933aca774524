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

import tomllib
from pathlib import Path

from pydantic import ValidationError

from core.errors import InputError
from core.files.atomic import write_text
from core.files.complaints import complaint
from core.files.inspection_plan_tables import PlanTables
from core.files.inspection_plan_translation import plan_of, plan_tables
from core.files.toml_text import toml_text
from core.inspect.inspection_plan import InspectionPlan


def read_plan(path: Path) -> InspectionPlan:
    """Read and check plan.toml.

    Raises
    ------
    InputError
        If it is missing, is no TOML, has an unknown key, a value is absurd, or features do not fit together. The
        sentence names the file and the field or feature.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(
            "the file is missing; it says what is to be inspected", where=path, todo="write one as the README shows"
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read as UTF-8 text ({error})", where=path) from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"this is no valid TOML: {error}", where=path) from error
    try:
        checked = PlanTables.model_validate(tables)
    except ValidationError as error:
        raise complaint(path, error, PlanTables) from error
    plan = plan_of(checked, path)
    try:
        plan.ordered()
    except InputError as error:
        raise InputError(error.what, where=f"{path}, {error.where}", todo=error.todo) from error
    return plan


def write_plan(path: Path, plan: InspectionPlan) -> None:
    """Write plan.toml so that `read_plan` reads the same plan; InputError if it cannot be written."""
    write_text(path, toml_text(plan_tables(plan)))
