"""Fan, table and hand in other places than the usual ones."""

import numpy as np
import pytest

from core.simulate.effects.setup import Setup
from core.simulate.recording import scan_of, scenario_rig
from core.simulate.scenario import Scenario
from core.simulate.scene.stage import WORK_POINT, table_pose

SMALL = {"scale": 0.1, "frames": 12}


def test_a_fan_turned_upright_meets_the_work_point_as_before_and_its_lines_run_down_the_picture():
    usual = scenario_rig(Scenario(**SMALL))
    turned = scenario_rig(Scenario(**SMALL, setup=Setup(fan_turned_deg=90.0)))
    for before, after in zip(usual.fan.planes, turned.fan.planes, strict=True):
        assert after.distances(WORK_POINT[None])[0] == pytest.approx(before.distances(WORK_POINT[None])[0], abs=1e-9)
        assert abs(before.pi[1]) > abs(before.pi[0]) and abs(after.pi[0]) > abs(after.pi[1])
    middle = turned.fan.planes[1]
    assert middle.distances(turned.fan_emitter[None])[0] == pytest.approx(0.0, abs=1e-9)


def test_sheets_of_a_turned_course_contain_their_emitters():
    _, sheets, _ = scan_of(Scenario(**SMALL, setup=Setup(fan_turned_deg=90.0)))
    for sheet in sheets:
        assert sheet.plane.distances(sheet.emitter[None])[0] == pytest.approx(0.0, abs=1e-9)
        assert sheet.axis @ sheet.plane.normal == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("setup", "degrees"), [(Setup(table_right_deg=8.0), 8.0), (Setup(table_away_deg=-5.0), 5.0)])
def test_a_table_is_tilted_by_what_is_asked(setup, degrees):
    usual, tilted = table_pose().rotation[:, 2], table_pose(setup).rotation[:, 2]
    assert np.degrees(np.arccos(usual @ tilted)) == pytest.approx(degrees, abs=1e-9)


def test_stripes_that_are_not_turned_run_alike():
    def spread(setup):
        _, sheets, _ = scan_of(Scenario(**SMALL, setup=setup))
        return np.std([np.arctan2(sheet.plane.pi[1], sheet.plane.pi[0]) % np.pi for sheet in sheets])

    assert spread(Setup(stripes_turned=0.0)) < 0.3 * spread(Setup())
