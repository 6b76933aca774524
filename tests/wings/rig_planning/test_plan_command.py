import json
from dataclasses import replace

import numpy as np
import pytest

from core.calibrate.change import DEFAULT_STABILITY
from core.errors import InputError
from core.files.pictures import read_picture
from core.settings.options import Options
from core.wings.rig_planning import planning, rig_plan
from core.wings.rig_planning.plan_map import plan_map_png
from core.wings.rig_planning.plan_step import plan, write_plan
from core.wings.rig_planning.prediction.bounds import bounds_of
from tests.simulated import trisect
from tests.test_cli_arguments import nothing_begun
from tests.test_cli_language import left_in_english, no_language_of_this_computer
from tests.wings.rig_planning.small import CUT_MM, SMALL, TOML

__all__ = ["no_language_of_this_computer", "nothing_begun"]


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("plan") / "rig.toml"
    path.write_text(TOML, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def told(rig):
    out = rig.parent / "out"
    said = trisect("plan", rig, "--out", out, "--scans", 1, "--no-changes", "--json", "--sigma-cut", CUT_MM)
    return said, out


@pytest.fixture(scope="module")
def result(rig):
    return plan(rig, scans=1, changes=False, options=Options(sigma_cut_mm=CUT_MM))


def test_every_height_gets_its_u_and_a_budget(told):
    said, _ = told
    values = json.loads(said.out)

    assert said.code == 0
    assert [row["height_mm"] for row in values["thickness"]] == [40.0, 50.0]
    for row in values["thickness"]:
        assert row["U_mm"] == pytest.approx(row["k"] * row["u_mm"])
        assert row["u_mm"] == pytest.approx(np.sqrt(sum(part["u_mm"] ** 2 for part in row["budget"])))
    assert values["design"]["sweeps"] == SMALL.sweeps
    assert values["changes"] == []


def test_the_window_is_given_the_same_rows_in_its_language_and_the_whole_sigma(rig, result, monkeypatch):
    monkeypatch.setattr(rig_plan, "plan", lambda *_, **__: result)
    shown = rig_plan.foretell_rig(rig, "de")
    assert shown.rows[0][0] == "Block 40\u00a0mm" and "," in shown.rows[0][1]
    assert shown.image_size == result.design.pixels
    own = result.largest.sigma.own
    assert shown.sigma_mm.shape == own.shape and np.nanmin(shown.sigma_mm - own) >= 0


def test_what_is_known_of_the_part_beforehand_is_in_the_budget(rig, told, tmp_path):
    stated = tmp_path / "rig.toml"
    stated.write_text(
        TOML.replace("[40, 50]", "[50]") + '[part]\nmaterial = "aluminium"\ncelsius = 22.0\nu_celsius = 0.5\n'
        "spray_mm = 0.01\nspray_sd_mm = 0.003\n"
    )
    after = plan(stated, scans=1, changes=False, options=Options(sigma_cut_mm=CUT_MM))
    rows = {row.words.code: row.u_mm for row in after.largest.budget}
    assert rows["inspection.cause_part_temperature"] == pytest.approx(50 * 23e-6 * 0.5)
    assert rows["inspection.cause_part_expansion"] == pytest.approx(50 * 0.9e-6 * 2.0)
    assert rows["inspection.cause_spray"] == pytest.approx(0.003)
    assert after.not_foretold is None, "no light from below"
    unstated = json.loads(told[0].out)
    of_50 = {row["source"]["code"]: row["u_mm"] for row in unstated["thickness"][1]["budget"]}
    assert of_50["inspection.cause_part_temperature_assumed"] == pytest.approx(50 * 11.5e-6 * 3.0)
    assert unstated["not_foretold"]["code"] == "plan.light_not_foretold"
    assert 0.3 < unstated["not_foretold"]["values"]["most_mm"] < 0.6


def test_plan_json_and_the_map_are_written(told):
    said, out = told
    written = json.loads((out / "plan.json").read_text(encoding="utf-8"))
    picture = read_picture(out / "sigma.png")

    assert written["thickness"] == json.loads(said.out)["thickness"]
    own = np.array(written["sigma_map"]["own_mm"], dtype=float)
    assert own.shape == (35, 48)
    assert np.isfinite(own).any() and np.isnan(own).any()
    assert np.ptp(picture) > 100


def test_the_same_plan_writes_the_same_bytes(rig, told, result):
    _, out = told
    write_plan(result, rig.parent / "again")

    for name in ("plan.json", "sigma.png"):
        assert (rig.parent / "again" / name).read_bytes() == (out / name).read_bytes()


def test_people_are_told_in_lines(rig, result, monkeypatch):
    asked = []
    told = replace(result, bounds=bounds_of(result.design, stability=DEFAULT_STABILITY))
    monkeypatch.setattr(planning, "plan", lambda _, **how: asked.append(how) or told)
    said = trisect("plan", rig, "--scans", 1, "--no-changes", "--sigma-cut", CUT_MM, "--bounds")

    assert said.code == 0
    assert {key: asked[0][key] for key in ("scans", "changes", "bounds", "options")} == {
        "scans": 1, "changes": False, "bounds": True, "options": Options(sigma_cut_mm=CUT_MM),
    }  # fmt: skip
    assert "block 40 mm" in said.out and "U = 0." in said.out
    assert "common to the scan" in said.out
    assert "no program below" in said.out and "thickness of 40 mm: u 0.0" in said.out
    assert "changed since the calibration and not checked: u 0.0" in said.out
    assert "changed and checked by 3 pictures: u 0.0" in said.out


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--scans", 0], "--scans"),
        (["--sigma-cut", 0], "sigma-cut: 0 is not above 0 and at most 10 mm"),
    ],
)
def test_an_absurd_option_is_refused_in_one_sentence(rig, words, part):
    said = trisect("plan", rig, *words)

    assert said.code == 2
    assert part in said.sentence


def test_a_wrong_plan_is_refused_in_one_sentence(tmp_path):
    (tmp_path / "rig.toml").write_text("[plan]\nposses = 3\n", encoding="utf-8")
    said = trisect("plan", tmp_path)

    assert said.code == 2
    assert "did you mean poses" in said.sentence


def test_a_folder_that_is_not_there_is_refused_before_anything_is_begun(nothing_begun, tmp_path):
    said = trisect("plan", tmp_path / "none", cores=2)

    assert (said.code, bool(said.sentence)) == (2, True)


@pytest.mark.accuracy
def test_it_prints_no_untranslated_word(rig):
    words = ("--no-changes", "--scans", 1, "--bounds", "--sigma-cut", CUT_MM)
    assert left_in_english("plan", rig, *words) == set()


def test_an_out_that_is_a_file_is_told(rig, result):
    (rig.parent / "taken").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="taken"):
        write_plan(result, rig.parent / "taken")


def test_a_map_without_any_value_still_is_a_picture():
    nothing = np.full((4, 6), np.nan)

    assert plan_map_png(nothing, nothing, (96, 64), "nothing").startswith(b"\x89PNG")
