"""Names that the examples of `trisect` use, as a plugin of pytest: `small`, `place`, `flat`, `step`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import trisect
from tests import conftest
from tests.simulated import copy_of

tiny_set, tiny_measured = conftest.tiny_set, conftest.tiny_measured


@pytest.fixture(scope="session")
def example_names(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A folder with a rendered set and its results without a report, and points of a plane and of a step."""
    place = tmp_path_factory.mktemp("examples")
    copy_of(request.getfixturevalue("tiny_measured"), place / "measured")
    small = trisect.open_set(copy_of(request.getfixturevalue("tiny_set"), place / "set"))
    return {"place": place, "small": small, "flat": points_of(0.0), "step": points_of(30.0)}


@pytest.fixture(autouse=True)
def names_of_examples(request: pytest.FixtureRequest, doctest_namespace: dict[str, Any]) -> None:
    """All of them, and what the package exports, in the examples of its modules."""
    if Path(str(request.node.fspath)).parent.name == "trisect":
        doctest_namespace |= {name: getattr(trisect, name) for name in trisect.__all__}
        doctest_namespace |= request.getfixturevalue("example_names")


def points_of(height_mm: float) -> trisect.Cloud:
    """Noisy points of a plane 600 mm from the camera, the left half of it nearer by a height."""
    u, v = (axis.ravel() for axis in np.meshgrid(np.arange(200.0, 560.0, 3.0), np.arange(100.0, 450.0, 3.0)))
    z = 600.0 - height_mm * (u < 380) + np.random.default_rng(5).normal(0, 0.01, u.size)
    points = np.column_stack([(u - 384) * z / 800, (v - 275) * z / 800, z])
    count = len(points)
    line = (u // 3).astype(np.int64)
    normals = np.tile([0.0, 0.0, -1.0], (count, 1))
    ones = np.ones(count)
    return trisect.Cloud(points, np.column_stack([u, v]), 0.01 * ones, 100 * ones, line, line, normals)
