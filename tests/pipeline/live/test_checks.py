"""The check of camera and laser in the list before a scan."""

from datetime import timedelta

import pytest

from core.pipeline.live.rig_check import rig_check
from tests.check_cases import TAKEN, check

NOON = TAKEN.replace(hour=12)


@pytest.mark.parametrize(("p", "state"), [(0.4, "ok"), (0.004, "failed"), (1e-9, "failed")])
def test_a_check_of_today_says_what_came_of_it(p, state):
    told = rig_check(check(p), NOON)
    assert (told.name, told.state) == ("check", state)
    assert told.message == check(p).sentence


def test_without_a_check_of_today_it_is_not_known():
    for told in (rig_check(None, NOON), rig_check(check(), NOON + timedelta(days=1))):
        assert told.state == "unknown"
        assert told.message.code == "live.not_checked_today"


def test_planes_of_this_sitting_need_no_check_but_one_that_failed_is_told():
    told = rig_check(None, NOON, sitting_hours=0.4)
    assert told.state == "ok"
    assert "0.4 h ago" in str(told.message)
    assert rig_check(check(1e-9), NOON, sitting_hours=0.4).state == "failed"
