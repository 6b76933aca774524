"""What GenICam cameras tell by the standard's names, with a camera that has only these features."""

import pytest

from core.acquire.drivers.genicam_features import capabilities_of


class Told:
    """The features of a camera by name: numbers, or the entry chosen."""

    def __init__(self, **values):
        self.values = values

    def has(self, name):
        return name in self.values

    def number(self, name):
        return self.values[name]

    def limits(self, name):
        return 1.0, self.values[name], 1.0

    def entry(self, name):
        return self.values[name]

    def entries(self, name):
        return (self.values[name],)


@pytest.mark.parametrize(
    ("features", "row_time_us"),
    [
        ({}, None),
        ({"SensorShutterMode": "Global", "SensorReadoutTime": 9000.0, "Height": 1000}, 0.0),
        ({"SensorShutterMode": "Rolling", "SensorReadoutTime": 71_000.0, "Height": 2748}, 71_000 / 2748),
        ({"SensorShutterMode": "Rolling", "Height": 2748}, None),
        ({"SensorShutterMode": "Rolling", "SensorReadoutTime": 0.0, "Height": 2748}, None),
        ({"SensorShutterMode": "GlobalReset", "SensorReadoutTime": 71_000.0, "Height": 2748}, None),
    ],
)
def test_a_camera_tells_how_its_rows_are_read_out(features, row_time_us):
    assert capabilities_of(Told(**features)).row_time_us == (
        None if row_time_us is None else pytest.approx(row_time_us)
    )
