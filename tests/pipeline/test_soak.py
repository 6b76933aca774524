"""The soak, short: a real driver's emulated camera through a live scan, every frame accounted for."""

import pytest

pytestmark = pytest.mark.slow


def test_every_frame_of_a_camera_is_recorded_or_counted_and_memory_stays(monkeypatch):
    pytest.importorskip("pypylon", reason="pypylon is not installed (pip install 'trisect[basler]')")
    from tests.soak import FLAT, soak

    monkeypatch.setenv("PYLON_CAMEMU", "1")
    soak(1, scale=0.25)  # compiles what it needs
    result = soak(20, scale=0.25)
    print("\n".join(result.lines()))
    assert result.recorded > 20
    assert result.adds_up
    assert result.log_is_whole
    assert result.overlays > 0
    assert result.drift < FLAT + 0.05  # twenty seconds are short: caches still fill
