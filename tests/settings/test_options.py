import pytest

from core.calibrate.camera.options import CameraOptions
from core.errors import InputError
from core.files.recording.rig import default_rig
from core.pipeline.steps.planes_step import plane_run_settings
from core.settings.options import Options


def test_usual_options_say_in_run_json_what_they_always_said():
    assert Options().for_camera.run_settings("camera") == {"skew": None, "k3": None, "fixed": [], "outliers": "gross"}
    assert Options().for_scan.run_settings("scan") == {"method": "network", "sigma_cut_mm": 0.05, "stripe": "automatic"}


def test_what_is_left_out_is_recorded_with_its_own_step():
    names = {"scan/b.png", "scan/a.png", "camera/v.png", "planes/p"}
    options = Options(camera=CameraOptions(k3=True), excluded=frozenset(names))
    assert options.for_camera.run_settings("camera")["excluded"] == ("camera/v.png",)
    assert options.for_scan.run_settings("scan")["excluded"] == ("scan/a.png", "scan/b.png")
    assert plane_run_settings(default_rig(), options.for_planes)["excluded"] == ("planes/p",)
    assert "excluded" not in plane_run_settings(default_rig(), Options().for_planes)


def test_options_can_be_compared():
    assert Options() == Options(excluded=frozenset())
    assert hash(Options()) == hash(Options())
    assert len({Options(), Options(constrain_fan=False), Options(excluded=frozenset({"camera/a"}))}) == 3


def test_absurd_options_are_refused():
    with pytest.raises(InputError, match="method: 'magic' is not network or three-crossings"):
        Options("magic")
    with pytest.raises(InputError, match="method: None is not network or three-crossings"):
        Options(None)
    with pytest.raises(InputError, match="sigma-cut: 11 is not above 0 and at most 10 mm"):
        Options(sigma_cut_mm=11)


def test_a_project_loads_without_compilers_and_windows():
    """A window opens at once only if what it needs at first is light."""
    import subprocess
    import sys

    program = "import sys, core.files.project.folder; print(*{'numba', 'PySide6', 'matplotlib'} & set(sys.modules))"
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert said.stdout.split() == []
