"""Settings that come back by themselves."""

import json

from core.acquire.kept_settings import KeptSettings
from core.acquire.source import Region, SourceChoice, SourceSettings

LEFT, RIGHT = SourceChoice("basler", "1"), SourceChoice("basler", "2")
TARGET = SourceSettings(exposure_ms=12.0, pixel_format="Mono8", region=Region(0, 0, 640, 480))
LASER = SourceSettings(exposure_ms=1.5, gain_db=3.0, trigger="Off")


def test_each_source_and_step_has_its_own():
    kept = KeptSettings().with_settings(LEFT, "camera", TARGET).with_settings(LEFT, "scan", LASER)
    assert kept.settings(LEFT, "camera") == TARGET
    assert kept.settings(LEFT, "scan") == LASER
    assert kept.settings(LEFT, "planes") == kept.settings(RIGHT, "scan") == SourceSettings()


def test_they_survive_as_text():
    kept = KeptSettings().with_settings(LEFT, "camera", TARGET).with_settings(RIGHT, "scan", LASER)
    assert KeptSettings.from_text(kept.to_text()) == kept


def test_what_another_version_wrote_does_not_cost_the_rest():
    kept = KeptSettings().with_settings(LEFT, "scan", LASER)
    rows = [
        *json.loads(kept.to_text()),
        {"kind": "basler"},
        {"kind": "x", "id": "", "step": "scan", "settings": {"hue": 1}},
    ]
    assert KeptSettings.from_text(json.dumps(rows)) == kept
    for text in ("", "{", "7", "[3]"):
        assert KeptSettings.from_text(text) == KeptSettings()
