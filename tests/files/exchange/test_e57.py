from datetime import UTC, datetime

import numpy as np
import pye57
import pytest

from core.errors import InputError
from core.files.exchange.e57 import write_e57

from .e57_reader import points_of, xml_of

AT = datetime(2026, 3, 14, 15, 9, 26, tzinfo=UTC)


@pytest.fixture
def written(tmp_path, content):
    write_e57(tmp_path / "c.e57", content.cloud, AT, name="Endmaß 50", calibration_id="abc-def")
    return tmp_path / "c.e57"


def test_another_program_reads_the_points_in_metres_and_sigma_as_intensity(written, content):
    read = pye57.E57(str(written)).read_scan(0, intensity=True, ignore_missing_fields=True)
    xyz = np.column_stack([read[f"cartesian{axis}"] for axis in "XYZ"])
    assert np.allclose(xyz, content.cloud.points / 1000, rtol=0, atol=1e-12)
    assert np.array_equal(read["intensity"], content.cloud.sigma.astype(np.float32))


def test_a_reader_made_from_the_standard_alone_finds_the_same_points_and_right_check_sums(written, content):
    read = points_of(written)
    assert list(read) == ["cartesianX", "cartesianY", "cartesianZ", "intensity"]
    for n, axis in enumerate("XYZ"):
        assert np.allclose(read[f"cartesian{axis}"], content.cloud.points[:, n] / 1000, rtol=0, atol=1e-12)
    assert np.array_equal(read["intensity"], content.cloud.sigma.astype(np.float32))


def test_the_file_says_what_the_intensity_is_and_when_it_was_measured(written, content):
    scan = xml_of(written).find(".//{*}data3D/{*}vectorChild")
    assert scan.findtext("{*}name") == "Endmaß 50 (intensity: sigma in mm)"
    assert "standard uncertainty of each point's depth in mm" in scan.findtext("{*}description")
    assert "Calibration abc-def" in scan.findtext("{*}description")
    assert float(scan.findtext("{*}intensityLimits/{*}intensityMaximum")) == pytest.approx(content.cloud.sigma.max())
    assert float(scan.findtext("{*}cartesianBounds/{*}zMaximum")) == pytest.approx(
        content.cloud.points[:, 2].max() / 1e3
    )
    gps = float(xml_of(written).findtext("{*}creationDateTime/{*}dateTimeValue"))
    assert gps == (AT - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds() + 18


def test_the_same_cloud_gives_the_same_bytes_and_another_another_id(tmp_path, written, content):
    write_e57(tmp_path / "d.e57", content.cloud, AT, name="Endmaß 50", calibration_id="abc-def")
    assert (tmp_path / "d.e57").read_bytes() == written.read_bytes()
    write_e57(tmp_path / "e.e57", content.cloud.select(np.arange(9)), AT)
    assert xml_of(tmp_path / "e.e57").findtext("{*}guid") != xml_of(written).findtext("{*}guid")


def test_one_point_is_a_cloud_and_none_is_refused(tmp_path, content):
    write_e57(tmp_path / "one.e57", content.cloud.select(np.array([5])), AT)
    assert pye57.E57(str(tmp_path / "one.e57")).get_header(0).point_count == 1
    with pytest.raises(InputError, match="has no point"):
        write_e57(tmp_path / "none.e57", content.cloud.select(np.arange(0)), AT)
    assert not (tmp_path / "none.e57").exists()


def test_where_nothing_can_be_written_is_told_and_nothing_stays(tmp_path, content):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="a file stands where a folder is needed"):
        write_e57(tmp_path / "file" / "c.e57", content.cloud, AT)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
