"""The printed carrier: its rings are where its file says, on both sides."""

import numpy as np
import pytest

from core.files.recording.carrier_file import read_carrier
from core.report.carrier_sheet import carrier_on, carrier_sheets
from core.views.carrier import FEWEST_MARKS
from core.views.layout import printed_carrier
from tests.simulated import trisect


def test_a_carrier_is_printed_with_its_file_beside_it(tmp_path):
    said = trisect("target", "carrier", "--out", tmp_path / "carrier.pdf")
    assert said.code == 0, said.err
    assert (tmp_path / "carrier.pdf").read_bytes().startswith(b"%PDF")
    found = read_carrier(tmp_path / "carrier.toml")
    assert len(found) == 24
    assert not found.scaled_by_target
    assert found.as_printed
    assert found.sigma[found.on(1), 2].min() > 0.4, "how the sheets are glued is not known"


def test_a_printed_carrier_is_uncertain_by_the_printers_scale_and_how_side_B_is_turned():
    carrier = carrier_on("A4")
    scaled = (carrier.positions * [1.0, 0.0, 0.0]).ravel()
    turned = (np.cross([0.0, 0.0, 1.0], carrier.positions) * carrier.on(1)[:, None]).ravel()
    for column, u in ((scaled, 0.003), (turned, 0.005)):
        explained = column @ np.linalg.solve(carrier.covariance, column)
        assert 1 / np.sqrt(explained) == pytest.approx(u, rel=0.2)


def test_the_same_carrier_gives_the_same_bytes():
    carrier = carrier_on("A4")
    assert carrier_sheets(carrier, "A4") == carrier_sheets(carrier, "A4")


def test_all_rings_lie_on_the_sheet_with_their_light_ground():
    half = np.array([297.0, 210.0]) / 2
    assert (np.abs(carrier_on("A4").positions[:, :2]) + 3.3 * 4 < half).all()
    assert len(carrier_on("A4")) >= 2 * FEWEST_MARKS


def test_no_more_rings_are_printed_than_there_are_codes():
    with pytest.raises(ValueError, match="61 codes, not 80"):
        printed_carrier(40, (100.0, 80.0), 4.0, 4.0)
