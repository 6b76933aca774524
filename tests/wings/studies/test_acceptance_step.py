"""Artefacts found in clouds: the two spheres of a bar, and what is said where there is none."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from core.errors import InputError
from core.files.arrays_file import pack_messages, pack_texts, write_arrays
from core.files.results.ply import write_cloud
from core.findings.proof import notes_of
from core.scan.surface.cloud import Cloud
from core.wings.studies.acceptance_step import read_positions
from core.wings.studies.kinds.acceptance import acceptance_check
from tests.scan_facts import NOTHING_WRONG
from tests.wings.studies.test_acceptance_points import cap

TABLE_Z, RADIUS = 600.0, 15.0


def bar(folder, centres, noise=0.01, seed=0):
    """Caps of spheres above a table, as a cloud.ply in a folder."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-90, 90, (2, 20000))
    points, normals = [np.column_stack([x, y, np.full(20000, TABLE_Z)])], [np.tile([0, 0, -1.0], (20000, 1))]
    for number, centre in enumerate(centres):
        outward = cap(4000, seed + number, opening=0.8)
        points.append(np.asarray(centre) + RADIUS * outward)
        normals.append(outward)
    where, outward = np.concatenate(points), np.concatenate(normals)
    where += noise * rng.normal(size=len(where))[:, None] * outward
    count = len(where)
    uv = 4000 * where[:, :2] / where[:, 2:] + 1000
    sweep = rng.integers(0, 30, count)
    cloud = Cloud(where, uv, np.full(count, max(noise, 0.005)), np.ones(count), sweep, sweep, outward)
    folder.mkdir()
    write_cloud(folder / "cloud.ply", cloud, "abc")
    return folder


def with_facts(folder, facts):
    """The folder with a scan.npz, as far as its facts are read."""
    known = {f"fact_{name}": np.array(holds) for name, holds in asdict(facts).items() if name != "of_the_day"}
    day = {"of_the_day": pack_messages(notes_of(facts.of_the_day)),
           "of_the_day_facts": pack_texts([doubt.fact for doubt in facts.of_the_day])}  # fmt: skip
    write_arrays(folder / "scan.npz", known | day)
    return folder


def test_the_spacing_of_a_bars_two_spheres_is_the_distance_of_their_centres(tmp_path):
    centres = [(-40.0, 10.0, 570.0), (40.0, 5.0, 575.0)]
    truth = float(np.linalg.norm(np.subtract(*centres)))
    folders = [bar(tmp_path / f"p{seed}", centres, seed=seed) for seed in (0, 3, 6)]
    readings = read_positions(folders, "bar", calibrated_mm=truth, u_mm=0.001, diameter_mm=30.0)
    assert [(one.quantity, one.position, one.u) for one in readings] == [("spacing", f"p{n}", 0.001) for n in (0, 3, 6)]
    assert max(abs(one.error) for one in readings) < 0.01


def test_a_bar_with_one_sphere_missing_is_told(tmp_path):
    folder = bar(tmp_path / "p", [(-40.0, 10.0, 570.0)])
    with pytest.raises(InputError, match=r"cloud.ply: no bar was found"):
        read_positions([folder], "bar", calibrated_mm=80.0, diameter_mm=30.0)


def test_a_sphere_of_another_size_is_not_taken_for_the_artefact(tmp_path):
    folder = bar(tmp_path / "p", [(-40.0, 10.0, 570.0)])
    with pytest.raises(InputError, match="no sphere was found"):
        read_positions([folder], "sphere", calibrated_mm=60.0)
    form, size = read_positions([folder], "sphere", calibrated_mm=2 * RADIUS)
    assert abs(size.error) < 0.01
    assert 0.03 < form.measured < 0.12


@pytest.mark.parametrize(
    ("facts", "verdict"),
    [
        (NOTHING_WRONG, "conforming"),
        (replace(NOTHING_WRONG, moved=True), "not proven"),
        (replace(NOTHING_WRONG, size_unconfirmed=True, points_off_alike=True), "conforming"),
        (None, "not proven"),
    ],
)
def test_readings_prove_nothing_by_the_facts_of_their_scan_but_those_that_an_artefact_clears_up(
    tmp_path, facts, verdict
):
    folder = bar(tmp_path / "p", [(-40.0, 10.0, 570.0)])
    if facts is not None:
        with_facts(folder, facts)
    readings = read_positions([folder], "sphere", calibrated_mm=2 * RADIUS, u_mm=0.001)
    check = acceptance_check(readings, {"size": 0.1})
    assert check.verdict == verdict
    told = [str(note) for note in check.notes if "prove nothing" in str(note)]
    assert len(told) == (verdict == "not proven"), "once, though the scan gives several readings"
