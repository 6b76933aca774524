"""What a moving hand, a moved object and a bumped camera do to the pictures of the simulated rig."""

from dataclasses import replace

import numpy as np
import pytest

from core.simulate.recording import moved_stage, moving_sheets, scan_of, scenario_rig, simulate_set
from core.simulate.scenario import Scenario

STILL = Scenario(object="plane", scale=0.1, frames=4, noise=0.0, speckle=0.0, texture=0.0)
ROLLING = replace(STILL, readout_ms=71.0)


def stripe(scenario, frame=1):
    """Rows that show the stripe, its column and its width there, by the frame's light less the fan's."""
    stage, sheets, _ = scan_of(scenario)
    light = stage.lit_by(*moving_sheets(scenario, sheets)[frame], rng=np.random.default_rng(0), fan=False)
    light = light - stage.room_light
    rows = np.flatnonzero(light.sum(axis=1) > 20)
    total, columns = light[rows].sum(axis=1), np.arange(light.shape[1])
    middle = light[rows] @ columns / total
    return rows, middle, np.sqrt(light[rows] @ columns**2 / total - middle**2)


def test_without_a_moving_hand_a_slow_shutter_changes_nothing():
    sheets = scan_of(ROLLING)[1]
    assert [one for (one,) in moving_sheets(ROLLING, sheets)] == sheets


def test_a_hand_that_goes_on_while_rows_are_read_leans_the_stripe():
    rows, still, _ = stripe(STILL)
    _, rolling, _ = stripe(replace(ROLLING, hand_mm_s=28.0))
    shift = np.polyfit(rows, rolling - still, 1)[0] * 275
    px_per_mm = scenario_rig(STILL).camera.focal / 560
    assert abs(shift) == pytest.approx(28.0 * 0.071 * px_per_mm, rel=0.25)


def test_tremor_bends_the_stripe_by_its_amplitude():
    _, still, _ = stripe(STILL)
    _, rolling, _ = stripe(replace(ROLLING, tremor_mm=0.35))
    assert 0.05 < np.abs(rolling - still).max() < 2 * 0.35 * scenario_rig(STILL).camera.focal / 480


def test_an_exposure_widens_the_stripe_where_it_is():
    _, still, narrow = stripe(STILL)
    _, blurred, wide = stripe(replace(STILL, hand_mm_s=200.0, exposure_ms=20.0))
    assert abs(np.median(blurred - still)) < 0.03
    assert np.median(wide) > 1.2 * np.median(narrow)


def test_objects_table_and_camera_move_as_stated():
    scenario = replace(STILL, object="block")
    before, after = (
        scan_of(scenario)[0].maps,
        moved_stage(replace(scenario, lifted_mm=0.4), scenario_rig(scenario)).maps,
    )
    moved = (before.depth - after.depth)[(before.depth > 0) & (after.depth > 0) & ~before.table & ~after.table]
    assert np.median(moved) == pytest.approx(0.4, abs=0.02)
    assert np.array_equal(before.depth[before.table & after.table], after.depth[before.table & after.table])
    sunk = moved_stage(replace(scenario, table_mm=0.4), scenario_rig(scenario)).maps
    assert np.median((sunk.depth - before.depth)[sunk.table & before.table]) == pytest.approx(0.4, abs=0.02)
    bumped = moved_stage(replace(scenario, bumped_px=2.0), scenario_rig(scenario))
    assert bumped.rig.camera.matrix[0, 2] - scenario_rig(scenario).camera.matrix[0, 2] == pytest.approx(2.0)
    assert moved_stage(scenario, scenario_rig(scenario)) is None


def test_the_row_time_is_stated_where_rows_roll(tmp_path):
    few = {"camera_views": 0, "plane_poses": 0, "frames": 1}
    simulate_set(replace(STILL, **few), tmp_path / "global")
    simulate_set(replace(ROLLING, **few), tmp_path / "rolling")
    assert "row_time_us = 0.0" in (tmp_path / "global" / "rig.toml").read_text()
    assert "row_time_us = 258.18" in (tmp_path / "rolling" / "rig.toml").read_text()
