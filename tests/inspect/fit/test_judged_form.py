"""A bent face, a dent and σ stated too small are told; ideal parts, and what known errors explain, are not."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from core.inspect.evaluate import Inspection, evaluate
from core.inspect.fit.judged_form import FACE, notes_on_form
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.gauge import measure_gauge
from core.inspect.plan.feature_spec import FeatureSpec, Polygon
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import CENTRE, FOCAL, HALF, NORMAL, TABLE_MM, BlockScan, axes, pixels
from tests.inspect.shape_scan import BALL, ShapeScan

BLOCK = BlockScan(height=40.0, sweeps=30)
BLOCK_ERRORS = PointErrors(BLOCK.covariance)
SHAPES = ShapeScan()
TOP = Polygon(tuple((float(u), float(v)) for u, v in BLOCK.polygons[0]))
BALL_UV = BALL[:2] / BALL[2] * FOCAL + CENTRE
AROUND_BALL = Polygon(
    tuple((float(u), float(v)) for u, v in BALL_UV + 98.0 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]))
)
BLOCK_PLAN = InspectionPlan((FeatureSpec("top", "plane", (TOP,)), FeatureSpec("step", "steps")))
BALL_PLAN = InspectionPlan((FeatureSpec("ball", "sphere", (AROUND_BALL,)),))


def lifted(cloud: Cloud, height: np.ndarray) -> Cloud:
    """A cloud with points (N,) moved towards the camera along their rays by so many mm."""
    return replace(cloud, points=cloud.points * (1 - height / cloud.points[:, 2])[:, None])


def bow(middle_mm: float) -> np.ndarray:
    """Of the block's upper face: along one of its sides, by so much from its ends to its middle."""
    along = (BLOCK.points - (TABLE_MM - BLOCK.height) * NORMAL) @ axes()[0]
    return np.where(BLOCK.upper, middle_mm * (1 - (along / HALF) ** 2), 0.0)


def notes(inspection: Inspection, name: str) -> list[Message]:
    assert inspection.problems == ()
    return [note for row in inspection.result(name).characteristics for note in row.notes]


def block(seed: int, **errors: float) -> Cloud:
    return BLOCK.measure(np.random.default_rng(seed), **errors)


@pytest.mark.parametrize(("middle_mm", "where"), [(0.12, "above"), (-0.12, "below")])
def test_a_bowed_face_is_told_with_its_direction_and_size(middle_mm: float, where: str) -> None:
    inspection = evaluate(BLOCK_PLAN, lifted(block(1), bow(middle_mm)), errors=BLOCK_ERRORS)
    (of_top,), (of_step,) = notes(inspection, "top"), notes(inspection, "step")
    assert of_top.code == of_step.code == "form.bowed"
    assert f"{where} its rim" in str(of_top)
    assert 0.06 < of_top.values["mm"] < 0.14
    assert "level 2" in str(of_step)


def test_the_gauge_tells_which_of_its_faces_is_bowed() -> None:
    result = measure_gauge(lifted(block(2), bow(0.12)), errors=BLOCK_ERRORS)
    told = [str(note) for note in result.notes if note.code.startswith("form.")]
    assert len(told) == 1
    assert "the upper face" in told[0]


@pytest.mark.parametrize(("depth_mm", "word"), [(0.3, "too low"), (-0.3, "too high")])
def test_a_dent_in_a_ball_is_told_with_its_place_and_depth(depth_mm: float, word: str) -> None:
    cloud = SHAPES.measure(np.random.default_rng(3))
    apart = np.linalg.norm(SHAPES.points - (BALL + 20.0 * np.array([-0.5, -0.5, -np.sqrt(0.5)])), axis=1)
    dented = lifted(cloud, np.where(SHAPES.on == 0, -depth_mm * np.exp(-0.5 * (apart / 4.0) ** 2), 0.0))
    (note,) = notes(evaluate(BALL_PLAN, dented, errors=SHAPES.errors), "ball")
    assert note.code == "form.uneven"
    assert "upper left" in str(note)
    assert word in str(note)
    assert 0.03 < note.values["mm"] < 0.2


@pytest.mark.parametrize("seed", range(4))
def test_points_whose_uncertainty_is_stated_half_of_the_truth_are_told(seed: int) -> None:
    cloud = block(seed)
    doubted = replace(cloud, sigma=cloud.sigma / 2)
    errors = PointErrors(BLOCK.covariance / 4)
    (note,) = notes(evaluate(BLOCK_PLAN, doubted, errors=errors), "top")
    assert note.code == "form.scatter"
    assert 1.2 < note.values["times"] < 2.6


@pytest.mark.parametrize("seed", range(10))
def test_ideal_parts_are_not_accused_nor_what_their_points_share(seed: int) -> None:
    of_block = evaluate(BLOCK_PLAN, block(seed, outliers=0.02), errors=BLOCK_ERRORS)
    of_ball = evaluate(BALL_PLAN, SHAPES.measure(np.random.default_rng(seed)), errors=SHAPES.errors)
    assert notes(of_block, "top") == notes(of_block, "step") == notes(of_ball, "ball") == []


def test_a_form_that_known_errors_explain_is_not_told() -> None:
    """The same bow with and without a common error of its size and shape among what is stated."""
    cloud = lifted(block(5), bow(0.12))
    top = np.flatnonzero(BLOCK.upper)
    shape = ParallelPlanes.through(-NORMAL, (TABLE_MM - BLOCK.height) * NORMAL[None])
    told = notes_on_form(cloud, top, shape, BLOCK_ERRORS, (FACE,))
    assert [note.code for note in told] == ["form.bowed"]
    common: Any = Explained(bow(0.1), BLOCK.points, np.vstack([BLOCK.pis, BLOCK.fan_pis]))
    assert notes_on_form(cloud, top, shape, replace(BLOCK_ERRORS, common=common), (FACE,)) == ()


class Explained:
    """Common errors that lift points by so much."""

    sources = ("camera",)

    def __init__(self, height: np.ndarray, points: np.ndarray, pis: np.ndarray) -> None:
        self.change, self.pis = -height[:, None] * points / points[:, 2:], pis
        self.place = {tuple(uv): k for k, uv in enumerate(pixels(points))}

    def changes(self, uv: np.ndarray, sweep: np.ndarray) -> np.ndarray:
        return self.change[None, [self.place[tuple(one)] for one in uv]]

    def planes(self, uv: np.ndarray, sweep: np.ndarray) -> np.ndarray:
        return self.pis[np.where(sweep >= 0, sweep, 0)]
