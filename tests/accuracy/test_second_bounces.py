"""Shiny sides that mirror the lasers onto the table: a thickness is right within U, or second bounces are named."""

from dataclasses import replace

import pytest

from tests.accuracy.hostile import figures_of
from tests.accuracy.hostile_cases import BOUNCES, HostileCase, base

OTHER_CAUSES = {"scan.moved", "scan.collapsed", "scan.fan_disagrees", "inspection.moved_during_scan"}


@pytest.fixture(scope="module")
def calibrations(tmp_path_factory):
    return tmp_path_factory.mktemp("calibrations")


@pytest.mark.accuracy
@pytest.mark.parametrize(("share", "seed"), [*((0.2, seed) for seed in range(1, 6)), (0.3, 3), (0.6, 2)])
def test_second_bounces_leave_a_thickness_within_its_uncertainty(share, seed, calibrations):
    scenario = replace(base(0.25), seed=seed, mirror_share=share)
    figures = figures_of(HostileCase(BOUNCES, f"{share:.0%}", scenario), calibrations)
    print(share, seed, figures)
    assert abs(figures["error"]) <= figures["U"]
    assert not OTHER_CAUSES & set(figures["told"])
    assert ("scan.second_bounces" in figures["told"]) == (share >= 0.3)
