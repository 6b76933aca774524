"""What is known of the pictures of the plate under the fan: target and stripes found, the light planes solved."""

from __future__ import annotations

from pathlib import Path

from core.calibrate.pose_features import PoseFeatures
from core.calibrate.results import FanCalibration
from core.files.project import Project
from core.files.project_keys import rests_on
from workbench import jobs
from workbench.pages.calibration_work import CalibrationWork

Poses = tuple[PoseFeatures, ...]


class PlanesWork(CalibrationWork[Poses, FanCalibration]):
    """Finds target and stripes, solves the light planes.

    `poses` and `calibration` are of the project as it is, or None.
    """

    STEP = "planes"
    FOUND_BY = ("camera calibration", "pictures of the plane target", "plane target", "colour channel")
    ACCEPTED = "accepted laser planes"
    FIND, SOLVE = jobs.FIND_POSES, jobs.SOLVE_POSES

    @property
    def poses(self) -> Poses | None:
        """What the pictures show; None as long as nobody has looked."""
        return self.found

    @staticmethod
    def name_of(path: Path) -> str:
        """What a pose is called; its picture with the laser off belongs to the one with the laser on."""
        return "" if path.stem.endswith("_off") else path.stem

    def _labels(self) -> tuple[str, str]:
        return self.tr("Laser planes"), self.tr("Solving the laser planes")

    def _can_search(self, project: Project) -> bool:
        return bool(project.sources.planes and project.accepted.camera)

    def _recall(self, folder: Path, project: Project) -> None:
        if self._accepted_is_of_these_pictures(project):
            self._bench.glance(
                jobs.RECALL_POSES,
                folder,
                project,
                label=self.tr("Reading the laser planes"),
                on_done=lambda recalled: self._take_up(folder, project, *recalled),
            )
        elif self._can_search(project):
            self._bench.quick.run(
                jobs.FOUND_POSES,
                folder,
                project,
                label=self.tr("Reading what was found"),
                on_done=lambda poses: self._take_up(folder, project, poses),
            )

    def _accepted_is_of_these_pictures(self, project: Project) -> bool:
        done, keys = self._model.results.get("planes"), rests_on("planes", project, {})
        known = {} if done is None else done.rests_on
        return bool(project.accepted.fan) and all(keys.get(name) == known.get(name) for name in self.FOUND_BY)
