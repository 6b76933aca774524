"""A bent face, a dent and σ stated too small are told; ideal parts, and what known errors explain, are not."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.findings.proof import ScanFacts
from core.inspect.evaluate import Inspection, evaluate
from core.inspect.fit.judged_form import FACE, LOWER_FACE, UPPER_FACE, notes_on_form
from core.inspect.fit.shapes import ParallelPlanes
from core.inspect.gauge import measure_gauge
from core.inspect.plan.feature_spec import Cut, FeatureSpec, InSphere, Polygon, Section
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.scan.surface.cloud import Cloud
from tests.inspect.block_scan import CENTRE, FOCAL, HALF, NORMAL, TABLE_MM, BlockScan, axes, pixels
from tests.inspect.shape_scan import BALL, ShapeScan
from tests.scan_facts import KNOWN, NOTHING_WRONG

SEEDS = (0, *(pytest.param(seed, marks=pytest.mark.accuracy) for seed in (4, 7)))
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
TOP_MIDDLE = (TABLE_MM - BLOCK.height) * NORMAL
(U1, V1), (U2, V2) = pixels(TOP_MIDDLE + np.array([[-HALF], [HALF]]) * axes()[0]).tolist()
RISE = Section(((U1, V1), (U2, V2)), half_width_mm=4.0, cuts=(Cut("rise", "height", (5.0, 35.0), (46.0, 98.0)),))
CUT_PLAN = InspectionPlan((FeatureSpec("cut", "section", section=RISE),))
(U3, V3), (U4, V4) = (BALL_UV + np.array([[-90.0, 0.0], [90.0, 0.0]])).tolist()
ROUND = Section(((U3, V3), (U4, V4)), half_width_mm=1.0, cuts=(Cut("round", "radius", (5.0, 32.0)),))
ARC_PLAN = InspectionPlan((FeatureSpec("arc", "section", (AROUND_BALL,), section=ROUND),))
SPOTS = (
    FeatureSpec("spot", "point", (InSphere((*TOP_MIDDLE.tolist(),), 28.0),)),
    FeatureSpec("aside", "point", (InSphere((*(TABLE_MM * NORMAL + 60.0 * axes()[0]).tolist(),), 12.0),)),
)
SPOT_PLAN = InspectionPlan((*SPOTS, FeatureSpec("apart", "distance", of=("spot", "aside"))))


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


def askew(deg: float) -> np.ndarray:
    """Of the block's upper face: slanting along one of its sides, level in its middle."""
    along = (BLOCK.points - (TABLE_MM - BLOCK.height) * NORMAL) @ axes()[0]
    return np.where(BLOCK.upper, np.tan(np.radians(deg)) * along, 0.0)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("deg", [0.5, 1.5])
def test_plane_faces_that_are_not_parallel_are_told_as_that_and_not_as_uneven(deg: float, seed: int) -> None:
    result = measure_gauge(lifted(block(seed), askew(deg)), errors=BLOCK_ERRORS)
    (told,) = [note for note in result.notes if note.code.startswith("form.")]
    assert told.code == "form.askew" and told.values["percent"] > 80
    assert told.values["deg"] == pytest.approx(deg, abs=0.1) and "Lay the part flat" in str(told)
    assert result.parallelism == pytest.approx(np.radians(deg), abs=np.radians(0.1))


@pytest.mark.parametrize("seed", SEEDS)
def test_what_an_angle_leaves_is_told_beside_it(seed: int) -> None:
    result = measure_gauge(lifted(block(seed), askew(1.0) + bow(0.25)), errors=BLOCK_ERRORS)
    first, second = [note for note in result.notes if note.code.startswith("form.")]
    assert first.code == "form.askew"
    assert second.code == "form.bowed" and "the upper face" in str(second)


@pytest.mark.parametrize("seed", SEEDS)
def test_points_that_scatter_about_faces_with_an_angle_are_told_beside_it(seed: int) -> None:
    cloud = lifted(block(seed), askew(1.0))
    doubted = replace(cloud, sigma=cloud.sigma / 3)
    result = measure_gauge(doubted, errors=PointErrors(BLOCK.covariance / 9))
    assert [note.code for note in result.notes if note.code.startswith("form.")] == ["form.askew", "form.scatter"]


@pytest.mark.parametrize("fact", ["rig_changed", "rig_seems_changed", "fan_disagrees", "moved", "drifted"])
def test_no_angle_is_named_where_a_fact_of_the_scan_slants_faces(fact: str) -> None:
    cloud = lifted(block(0), askew(0.5))

    def told(facts: ScanFacts) -> list[str]:
        notes = measure_gauge(cloud, errors=replace(BLOCK_ERRORS, facts=facts)).notes
        return [note.code for note in notes if note.code.startswith("form.")]

    assert told(NOTHING_WRONG) == ["form.askew"]
    assert told(ScanFacts(**{**KNOWN, fact: True})) == []


def levels(seed: int, slanting: tuple[int, ...]) -> Cloud:
    """The block with one half of its upper face at 25 mm, level 2, and the other at 40 mm, some of them at 1°."""
    along = (BLOCK.points - TOP_MIDDLE) @ axes()[0]
    number = np.where(BLOCK.upper, np.where(along < 0, 2, 3), 1)
    cloud = block(seed)
    lowered = np.where(number == 2, (TABLE_MM - 25.0) / (TABLE_MM - BLOCK.height), 1.0)
    cloud = replace(cloud, points=cloud.points * lowered[:, None])
    return lifted(cloud, np.where(np.isin(number, slanting), np.tan(np.radians(1.0)) * (along % HALF - HALF / 2), 0.0))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("slanting", "said"),
    [((2,), "level 1: level 2,"), ((3,), "level 1: level 3,"), ((2, 3), "level 1: level 2 and level 3,")],
)
def test_of_levels_those_are_named_that_are_not_parallel_to_the_others(
    slanting: tuple[int, ...], said: str, seed: int
) -> None:
    """Nobody is told to lay them flat: levels of one part are made so. What sweeps err turns faces of 30 mm by 0.3°."""
    plan = InspectionPlan(BLOCK_PLAN.features[1:])
    (angle,) = notes(evaluate(plan, levels(seed, slanting), errors=BLOCK_ERRORS), "step")
    assert angle.code == "form.levels_askew" and f"Not parallel to {said}" in str(angle)
    assert angle.values["deg"] == pytest.approx(1.0, abs=0.35) and "flat" not in str(angle)


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


def dented(seed: int, depth_mm: float) -> Cloud:
    """The ball with a dent at its upper left, as the camera sees it."""
    apart = np.linalg.norm(SHAPES.points - (BALL + 20.0 * np.array([-0.5, -0.5, -np.sqrt(0.5)])), axis=1)
    cloud = SHAPES.measure(np.random.default_rng(seed))
    return lifted(cloud, np.where(SHAPES.on == 0, -depth_mm * np.exp(-0.5 * (apart / 4.0) ** 2), 0.0))


@pytest.mark.parametrize(("middle_mm", "where"), [(0.15, "above"), (-0.15, "below")])
def test_a_bowed_stretch_of_a_section_is_told(middle_mm: float, where: str) -> None:
    (note,) = notes(evaluate(CUT_PLAN, lifted(block(1), bow(middle_mm)), errors=BLOCK_ERRORS), "cut")
    assert note.code == "form.bowed"
    assert "the second stretch" in str(note)
    assert f"{where} its rim" in str(note)
    assert 0.05 < note.values["mm"] < 0.2


def test_a_ridge_in_a_section_is_told_with_its_place_along_it() -> None:
    along = (BLOCK.points - TOP_MIDDLE) @ axes()[0]
    ridge = np.where(BLOCK.upper, 0.3 * np.exp(-0.5 * ((along - 15.0) / 3.0) ** 2), 0.0)
    (note,) = notes(evaluate(CUT_PLAN, lifted(block(2), ridge), errors=BLOCK_ERRORS), "cut")
    assert note.code == "form.uneven_along"
    middle = 72.0
    assert abs(abs(note.values["at_mm"] - middle) - 15.0) < 5.0
    assert "too high" in str(note)


def test_what_is_wrong_about_a_point_is_told_with_what_is_derived_from_it() -> None:
    (note,) = notes(evaluate(SPOT_PLAN, lifted(block(1), bow(0.2)), errors=BLOCK_ERRORS), "apart")
    assert note.code in ("form.bowed", "form.uneven")
    assert "the surface about the point" in str(note)


@pytest.mark.parametrize("seed", SEEDS)
def test_ideal_sections_and_points_are_not_accused(seed: int) -> None:
    cloud, shapes = block(seed, outliers=0.02), SHAPES.measure(np.random.default_rng(seed))
    found = [
        (evaluate(CUT_PLAN, cloud, errors=BLOCK_ERRORS), "cut"),
        (evaluate(SPOT_PLAN, cloud, errors=BLOCK_ERRORS), "apart"),
        (evaluate(ARC_PLAN, shapes, errors=SHAPES.errors), "arc"),
    ]
    assert [notes(inspection, name) for inspection, name in found] == [[], [], []]


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.accuracy) for seed in (1, 2, 3))])
def test_points_whose_uncertainty_is_stated_half_of_the_truth_are_told(seed: int) -> None:
    cloud = block(seed)
    doubted = replace(cloud, sigma=cloud.sigma / 2)
    errors = PointErrors(BLOCK.covariance / 4)
    (note,) = notes(evaluate(BLOCK_PLAN, doubted, errors=errors), "top")
    assert note.code == "form.scatter"
    assert 1.2 < note.values["times"] < 2.6


@pytest.mark.parametrize("seed", SEEDS)
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


@pytest.mark.parametrize("aside_mm", [0.0, 3.0])
def test_faces_of_which_all_points_lie_aside_by_what_they_share_are_judged_by_the_rest(aside_mm: float) -> None:
    """On a rig that has changed, the points' common error is larger than any error of form."""
    cloud = lifted(block(5), bow(0.12))
    faces = [np.flatnonzero(BLOCK.upper), np.flatnonzero(~BLOCK.upper)]
    part = np.repeat([0, 1], [len(face) for face in faces])
    where = (
        np.array([TABLE_MM - BLOCK.height, TABLE_MM])[:, None] * NORMAL + aside_mm * np.array([[1.0], [0.0]]) * NORMAL
    )
    shape = ParallelPlanes.through(-NORMAL, where)
    told = notes_on_form(cloud, np.concatenate(faces), shape, BLOCK_ERRORS, (UPPER_FACE, LOWER_FACE), part)
    assert [note.code for note in told] == ["form.bowed"]
    assert "the upper face" in str(told[0])


class Explained:
    """Common errors that lift points by so much, and places between them as the nearest one."""

    sources = ("camera",)

    def __init__(self, height: np.ndarray, points: np.ndarray, pis: np.ndarray) -> None:
        self.change, self.pis = -height[:, None] * points / points[:, 2:], pis
        self.place = cKDTree(pixels(points))

    def changes(self, uv: np.ndarray, sweep: np.ndarray) -> np.ndarray:
        return self.change[None, self.place.query(uv)[1]]

    def planes(self, uv: np.ndarray, sweep: np.ndarray) -> np.ndarray:
        return self.pis[np.where(sweep >= 0, sweep, 0)]
