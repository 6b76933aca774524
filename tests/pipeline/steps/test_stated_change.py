"""What rig.toml and the pictures' times say of how far a rig may have changed."""

from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY, STABLE, Stability
from core.calibrate.drift import Air, Drift
from core.files.project.data import new_project
from core.files.project.keys import inputs_of
from core.files.recording.picture_reader import PictureReader
from core.files.recording.set_listing import taken_at
from core.pipeline.project.workspace import rig_in_its_air
from core.pipeline.steps.check_step import assumed_stability, check_of_the_day, since_calibration
from core.pipeline.steps.gauge_step import gauge_step
from tests.pipeline.steps.test_check_step import check_of, check_seen_in, scan_of, unchanged, work_in

__all__ = ["unchanged"]  # a fixture of the checks, used here too

AT_REST = Stability(20e-6, 2e-3, 0.02, 1e-5)
WARMING = Drift(per_kelvin=Stability(40e-6, 3.4e-3, 0.04, 2e-5))


def stating(work, **stated):
    return replace(work, recording_set=replace(work.recording_set, rig=replace(work.recording_set.rig, **stated)))


def change_of(work, poses=None):
    if poses is None:
        poses = check_of_the_day(PictureReader(work.recording_set), work.calibration())
    return since_calibration(work.recording_set, work.calibration(), poses, None)


def codes(work, poses=None):
    change = change_of(work, poses)
    return [note.code for note in assumed_stability(work.recording_set, change, work.calibration().fan)]


def size(change):
    """Of all that change does to the laser planes."""
    planes = [one.fan.pis for one in change.deviations if "change" in one.source]
    return float(np.sqrt(sum(np.sum((pis - np.mean(planes, axis=0)) ** 2) for pis in planes)))


def test_the_change_is_small_at_the_temperature_of_the_calibration_and_large_10_k_above(unchanged, tmp_path):
    work = stating(work_in(unchanged, tmp_path, with_check=False), stability=AT_REST, drift=WARMING)
    cold, warm = (stating(work, air=Air(20.0, None, celsius)) for celsius in (20.0, 30.0))
    assert size(change_of(warm)) > 3 * size(change_of(cold))
    notes = assumed_stability(warm.recording_set, change_of(warm), warm.calibration().fan)
    assert [note.values["kelvins"] for note in notes if note.code == "scan.change_by_warmth_and_time"] == [10.0]
    assert not {"scan.kelvins_assumed", "scan.stability_assumed"} & {note.code for note in notes}


@pytest.mark.accuracy
def test_the_row_is_small_at_the_temperature_of_the_calibration_and_large_10_k_above(unchanged, tmp_path):
    rows = {}
    for celsius in (20.0, 30.0):
        work = work_in(unchanged, tmp_path / str(celsius), with_check=False)
        work = stating(work, stability=AT_REST, drift=WARMING, air=Air(20.0, None, celsius))
        scan = scan_of(unchanged, work).scan
        assert [note.values["kelvins"] for note in scan.notes if note.code == "scan.change_by_warmth_and_time"] == [
            celsius - 20.0
        ]
        assert not {"scan.kelvins_assumed", "scan.stability_assumed"} & {note.code for note in scan.notes}
        (row,) = [row for row in gauge_step(work).budget if row.words.code == "inspection.cause_change"]
        rows[celsius] = row.u_mm
    assert rows[30.0] > 3 * rows[20.0]


def test_a_temperature_that_is_not_stated_is_assumed_and_said(unchanged, tmp_path):
    work = stating(work_in(unchanged, tmp_path, with_check=False), stability=AT_REST, drift=WARMING, air=Air(20.0))
    assert "scan.kelvins_assumed" in codes(work)
    assert {one.source for one in change_of(work).deviations if "change" in one.source} == {"assumed change"}
    known = stating(work, air=Air(20.0, None, 25.0))
    assert "scan.kelvins_assumed" not in codes(known)
    assert {one.source for one in change_of(known).deviations if "change" in one.source} == {"change"}
    assert change_of(known).stability == change_of(work).stability


def test_figures_for_warmth_alone_leave_the_rest_assumed(unchanged, tmp_path):
    work = stating(work_in(unchanged, tmp_path, with_check=False), stability=None, drift=WARMING, air=Air(20, None, 20))
    assert change_of(work).stability == DEFAULT_STABILITY
    assert "scan.stability_assumed" in codes(work)


def test_hours_are_those_from_the_pictures_of_the_calibration(unchanged, tmp_path):
    work = work_in(unchanged, tmp_path, with_check=False)
    work = stating(work, stability=STABLE, drift=Drift(per_hour=Stability(1e-6, 0.0, 0.0, 0.0)))
    made = min(taken_at(work.recording_set.camera), taken_at([pair.on for pair in work.recording_set.planes]))
    hours = (taken_at(work.recording_set.frames) - made).total_seconds() / 3600
    assert change_of(work).stability.turn == pytest.approx(1e-6 * hours)
    gone = replace(work, recording_set=replace(work.recording_set, camera=(), planes=()))
    assert change_of(gone).stability.turn == pytest.approx(24e-6)
    assert "scan.hours_assumed" in codes(gone)


def test_a_rig_calibrated_far_from_its_temperature_is_assumed_to_change_more(unchanged, tmp_path):
    work = work_in(unchanged, tmp_path, with_check=False)
    plain, warm = change_of(work), change_of(stating(work, air=Air(20.0, None, 35.0)))
    assert plain.stability == DEFAULT_STABILITY
    assert warm.stability.turn == pytest.approx(3 * plain.stability.turn)
    assert {one.source for one in warm.deviations if "change" in one.source} == {"assumed change"}
    assert codes(stating(work, air=Air(20.0, None, 35.0))) == ["scan.warmer_than_usual", "scan.stability_assumed"]


@pytest.mark.parametrize("air", [Air(), Air(20.0, 21.0, 24.0)], ids=["nothing", "usual"])
def test_what_is_not_stated_changes_no_number(unchanged, tmp_path, air):
    work = work_in(unchanged, tmp_path)
    poses, _ = check_seen_in(unchanged)
    before, after = change_of(work, poses), change_of(stating(work, air=air), poses)
    assert after.p == before.p
    for one, other in zip(before.deviations, after.deviations, strict=True):
        assert np.array_equal(one.fan.pis, other.fan.pis) and one.source == other.source


def test_a_check_says_less_of_a_scan_the_warmer_it_has_become_since(unchanged, tmp_path):
    work = stating(work_in(unchanged, tmp_path), stability=AT_REST, drift=WARMING)
    poses, _ = check_seen_in(unchanged)
    cold, warm = (change_of(stating(work, air=Air(20.0, 20.0, celsius)), poses) for celsius in (20.0, 26.0))
    without = change_of(
        replace(work, recording_set=replace(stating(work, air=Air(20.0, None, 26.0)).recording_set, check=()))
    )
    assert cold.checked and warm.checked
    assert "scan.kelvins_since_check_assumed" not in codes(stating(work, air=Air(20.0, 20.0, 26.0)), poses)
    assert "scan.kelvins_since_check_assumed" in codes(stating(work, air=Air(20.0, None, 26.0)), poses)
    assert 2 * size(cold) < size(warm) < size(without)


def test_a_check_is_judged_at_its_own_temperature(unchanged, tmp_path):
    stated = {}
    for celsius in (20.0, 30.0):
        work = stating(work_in(unchanged, tmp_path / str(celsius)), stability=AT_REST, drift=WARMING)
        stated[celsius] = check_of(unchanged, stating(work, air=Air(20.0, celsius, 20.0))).stated_mm
    assert stated[30.0] > 3 * stated[20.0]


def test_the_air_of_a_project_is_that_of_its_scan_where_it_matters():
    plain = replace(new_project("block"), info=replace(new_project("block").info, air_celsius=23.5))
    assert rig_in_its_air(plain) is plain.rig, "the set's hash stays"
    stated = replace(plain, rig=replace(plain.rig, drift=WARMING, air=Air(20.0, 21.0)))
    assert rig_in_its_air(stated).air == Air(20.0, 21.0, 23.5)
    assert inputs_of("scan", plain, {}).keys() < inputs_of("scan", stated, {}).keys(), "and is measured anew with it"
