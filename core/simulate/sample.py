"""The embedded sample: rendered on first use, then kept in the user's cache folder."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import platformdirs

import core
from core.calibrate.board_shape import TRUE
from core.errors import InputError
from core.files.project.data import Project, new_project
from core.files.recording.rig import GaugeSpec
from core.inspect.uncertainty.part import TARGET_AT_20, Part
from core.progress import Progress, silent
from core.simulate.effects.boards import BoardsBeside
from core.simulate.scenario import GAUGE_TOLERANCE_MM, Scenario
from core.simulate.scene.corner import corner_planes
from core.sources import text_hash

SAMPLE = "sample.toml"
METAL_AT_20 = Part(material="metal", celsius=20.0, u_celsius=0.0, target=TARGET_AT_20)
"""What simulated objects are but for translucent ones, and the target they are measured by."""


def sample_scenario(has_fan: bool = True) -> Scenario:
    """Read the scenario of the sample project that comes with the program.

    Without a fan it is the same block before a corner of two printed boards.
    """
    scenario = Scenario.from_toml((files("resources") / "sample" / SAMPLE).read_text(encoding="utf-8"), SAMPLE)
    return scenario if has_fan else replace(scenario, fan_lines=0, boards=BoardsBeside(corner=True))


def simulated_project(name: str, has_fan: bool = True) -> Project:
    """Make a project with nothing measured for the simulated rig: its targets and its gauge block are stated.

    Without a fan it states the corner of two boards.
    """
    project, gauge = new_project(name), GaugeSpec(float(sample_scenario().height_mm), GAUGE_TOLERANCE_MM)
    rig = replace(project.rig, gauge=gauge, camera_board=TRUE, plane_board=TRUE, part=METAL_AT_20)
    if not has_fan:
        rig = replace(rig, lines=0, angle=0.0, known_planes=corner_planes("charuco", TRUE))
    return replace(project, rig=rig)


def sample_folder(has_fan: bool = True) -> Path:
    """Return the folder in the user's cache where the sample's recording set is, or will be rendered."""
    scenario = sample_scenario(has_fan)
    return Path(platformdirs.user_cache_dir("trisect", appauthor=False)) / f"sample-{_key(scenario)}"


def sample_set(progress: Progress = silent, has_fan: bool = True) -> Path:
    """Return the folder of the sample's recording set, rendered first (well under a minute) if it is not there.

    Raises
    ------
    InputError
        If the cache folder cannot be written to.
    """
    folder = sample_folder(has_fan)
    if not _whole(folder):
        from core.simulate.recording import simulate_set  # with all that renders: not for who only asks what it shows

        try:
            simulate_set(sample_scenario(has_fan), folder, progress)
        except InputError:
            if not _whole(folder):  # another process may have been quicker
                raise
    return folder


def _whole(folder: Path) -> bool:
    """Whether a set is there: it appears in one step."""
    return (folder / "rig.toml").exists()


def _key(scenario: Scenario) -> str:
    """Key of the sample: another scenario, another release or changed rendering make another one."""
    digest = hashlib.sha256(f"{core.__version__} {scenario.key}".encode())
    digest.update(text_hash(("simulate",)).encode())
    return digest.hexdigest()[:16]
