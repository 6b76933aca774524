"""A project's thickness by the fixed lines alone: in a folder of its own, the scan's results stay."""

import shutil

from core.files.project.folder import results_folder
from core.pipeline.project.profiles import PROFILES, measure_profiles
from tests.simulated import contents


def test_the_fan_alone_measures_the_block_beside_the_scan(done, tmp_path):
    folder = tmp_path / "block"
    shutil.copytree(done.folder, folder)
    before = contents(results_folder(folder))
    summary = measure_profiles(folder, done.project)
    assert contents(results_folder(folder)) == before
    assert abs(summary.gauge.thickness_mm - summary.gauge.nominal_mm) < summary.gauge.U_mm
    assert [one.name for one in summary.pictures] == ["scan/reference.png"]
    assert summary.report == folder / PROFILES / "report.pdf"
    assert summary.report.read_bytes().startswith(b"%PDF")
    assert (folder / PROFILES / "profiles.csv").exists()
