"""Simulated recording sets as another program would record them, with the truth beside them."""

from __future__ import annotations

import math
import shutil
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, replace
from pathlib import Path
from typing import cast

import numpy as np

from core.calibrate.change import displaced_fan
from core.errors import InputError
from core.files.atomic import folder_beside, write_bytes, write_text
from core.files.pictures import write_picture
from core.files.recording.carrier_file import write_carrier
from core.files.recording.recording_set import CARRIER, KNOWN_PLANES, VIEWS
from core.held_files import remove_tree, rename
from core.messages import Message
from core.model import Camera, Fan, LightPlane, Pose
from core.progress import Progress, silent, steps
from core.simulate.calibration import CalibrationPictures, CheckPictures, rig_toml
from core.simulate.effects.sensor import SensorEffects
from core.simulate.hand_motion import HandMotion
from core.simulate.rays import ray_map
from core.simulate.rig import FULL_SIZE, Optics, Rig, paper_rig
from core.simulate.scan import ScanStage, StageEffects
from core.simulate.scenario import Scenario
from core.simulate.scene.carrier import SIDES, calibrated_carrier
from core.simulate.scene.image import Picture, Sensor, generator
from core.simulate.scene.known_planes import stated_planes
from core.simulate.scene.laser import Sheet
from core.simulate.scene.scene import Scene
from core.simulate.scene.stage import WORK_POINT, aim_of, build_scene
from core.simulate.sweep import hand_sweeps, headings_of, sweep_range
from core.simulate.truth import TRUTH_FILE, Truth, load_truth, save_truth, truth_folder
from core.simulate.turn import Turn
from core.threads import ordered_map

BOARDS_GREY = 150.0
"""8-bit grey level of a white surface in the room's light while the boards beside the object are taken."""
TURNED, TURNED_SEED = "turned", 104_729
"""Name of the second view of a block in its carrier, and what is added to the scenario's seed for it."""
RENDER_THREADS = 2
"""Pictures rendered and written at once: as many as a small machine has cores."""


def simulate_set(
    scenario: Scenario,
    folder: Path,
    progress: Progress = silent,
    *,
    calibration_from: Path | None = None,
    rig: Rig | None = None,
) -> None:
    """Render the recording set of `scenario` into `folder`, and its truth into FOLDER.truth beside it.

    Parameters
    ----------
    scenario
        What to simulate; the same scenario gives the same bytes.
    folder
        Must not hold anything yet.
    progress
        Called after each picture; what it raises (Cancelled) passes through and leaves nothing behind.
    calibration_from
        An earlier simulated set of the same rig and scale: its camera/ and planes/ are copied, not rendered.
    rig
        Another rig than the scenario's, such as a planned one.

    Raises
    ------
    InputError
        If the folder is not empty or cannot be written to, or the other set does not fit.
    """
    folder = folder.absolute()
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(
            Message("simulate.not_empty", "there is something already"),
            where=folder,
            todo=Message("simulate.advice_new_folder", "name a new folder, or empty this one"),
        )
    beside_it = truth_folder(folder)
    if beside_it.exists() and not (beside_it / TRUTH_FILE).exists():
        raise InputError(
            Message("simulate.no_place_for_truth", "this is where the truth would go, but it is something else"),
            where=beside_it,
        )
    with folder_beside(folder) as beside:
        made, hidden = beside / "set", beside / "truth"
        _render(scenario, rig or scenario_rig(scenario), made, hidden, progress, calibration_from)
        _put_in_place(made, hidden, folder)


def _render(scenario: Scenario, rig: Rig, made: Path, hidden: Path, progress: Progress, earlier: Path | None) -> None:
    if not scenario.fan_lines:
        scenario = replace(scenario, plane_poses=0, check_poses=0)
    for part in (made / "camera", made / "planes", made / "scan", hidden):
        part.mkdir(parents=True)
    rays = ray_map(rig.camera)
    calibration = CalibrationPictures(scenario, rig, rays)
    camera_poses, plane_poses = calibration.camera_poses, calibration.plane_poses
    if earlier is not None:
        camera_poses, plane_poses = _copy_calibration(earlier, made, rig)
    else:
        names = [*camera_poses, *plane_poses]
        _write_all(
            made, lambda name: calibration.render(name), names, progress, "calibration pictures", scenario.sensor
        )
    rig = changed_rig(scenario, rig)
    if scenario.check_poses:
        (made / "check").mkdir()
        check = CheckPictures(scenario, rig, ray_map(rig.camera))
        _write_all(made, check.render, list(check.poses), progress, "calibration pictures", scenario.sensor)
    stage, sheets, figures = scan_of(scenario, rig)
    later = moved_stage(scenario, rig)
    shots = {f"frame{i:04d}": (i, sheet) for i, sheet in enumerate(sheets)}
    moving = moving_sheets(scenario, sheets)

    def shoot(name: str) -> Iterator[tuple[str, Picture]]:
        if name == "reference":
            yield "scan/reference.png", stage.reference()
            for number, picture in stage.further_references().items():
                yield f"scan/reference@{number}.png", picture
        elif scenario.hand_laser:
            index = shots[name][0]
            seen = stage if later is None or index < scenario.moved_frame else later
            yield f"scan/{name}.png", seen.frame(index, *moving[index])
            for number, picture in seen.further_frames(index, *moving[index]).items():
                yield f"scan/{name}@{number}.png", picture
        else:
            yield f"scan/{name}.png", profile_picture(scenario, shots[name][0], rig)

    first = ["reference"] if scenario.reference and scenario.hand_laser else []
    _write_all(made, shoot, [*first, *shots], progress, "frames", scenario.sensor)
    if scenario.carrier.marks:
        _render_turned(scenario, rig, made, progress)
    boards = {board.name: board for board in stage.scene.boards if board.name not in SIDES}

    def shoot_boards(name: str) -> Iterator[tuple[str, Picture]]:
        yield f"{KNOWN_PLANES}/{name}.png", stage.boards(list(boards).index(name), BOARDS_GREY)

    if boards:
        (made / KNOWN_PLANES).mkdir()
        _write_all(made, shoot_boards, list(boards), progress, "boards", scenario.sensor)
    known = stated_planes(scenario, stage.scene.boards, rig.camera)
    write_text(made / "rig.toml", rig_toml(scenario, known), sync=False)
    swept = shots if scenario.hand_laser else {}
    sweeps: dict[str, LightPlane] = {name: moving[index][0].plane for name, (index, _) in swept.items()}
    maps = stage.maps
    places = {name: board.pose for name, board in boards.items()}
    fan = rig.fan if scenario.fan_lines else None
    truth = Truth(rig.camera, fan, sweeps, camera_poses, plane_poses, figures, maps.depth, maps.table, places)
    save_truth(hidden, truth, asdict(scenario))


def turned_over(scenario: Scenario) -> Scenario:
    """Make the scenario of the second view: the block with its carrier turned over, put down and scanned anew."""
    turned = replace(scenario.carrier, turned=True)
    return replace(scenario, carrier=turned, seed=(scenario.seed + TURNED_SEED) % 2**63)


def _render_turned(scenario: Scenario, rig: Rig, made: Path, progress: Progress) -> None:
    """Render the second view of a block in its carrier, and write what the carrier's calibration states."""
    stage, sheets, _ = scan_of(turned := turned_over(scenario), rig)
    moving = moving_sheets(turned, sheets)
    (made / VIEWS / TURNED).mkdir(parents=True)

    def shoot(name: str) -> Iterator[tuple[str, Picture]]:
        index = int(name.removeprefix("frame") or 0) if name != "reference" else -1
        picture = stage.reference() if index < 0 else stage.frame(index, *moving[index])
        yield f"{VIEWS}/{TURNED}/{name}.png", picture

    names = [f"frame{index:04d}" for index in range(len(sheets))]
    _write_all(made, shoot, ["reference", *names], progress, "frames", scenario.sensor)
    write_carrier(made / CARRIER, calibrated_carrier(scenario))


def scenario_rig(scenario: Scenario) -> Rig:
    """Make the rig (camera, fan and optics) that a scenario describes, as it is when calibrated."""
    optics = replace(Optics(), speckle_contrast=scenario.speckle)
    rig = paper_rig(
        scenario.scale,
        published_planes=scenario.published_planes,
        optics=optics,
        fan_bow=scenario.fan_bow,
        laser=scenario.laser,
    )
    rig = replace(rig, camera=scenario.lens.through_lens(rig.camera))
    if scenario.transport.sheet_deg:
        angle, fade = math.radians(scenario.transport.sheet_deg), math.radians(scenario.transport.edge_deg)
        fan, sweep = (replace(one, end_angle=angle, end_fade=fade) for one in (rig.fan_beam, rig.sweep_beam))
        rig = replace(rig, fan_beam=fan, sweep_beam=sweep)
    if scenario.setup.fan_turned_deg:
        turn = Turn.about_the_view(WORK_POINT, scenario.setup.fan_turned_deg)
        planes = tuple(turn.plane(plane) for plane in rig.fan.planes)
        rig = replace(rig, fan=Fan(planes), fan_emitter=turn.point(rig.fan_emitter))
    if not scenario.fan_lines:
        return replace(rig, fan_beam=replace(rig.fan_beam, peak_grey=0.0))
    return rig if scenario.fan_lines == rig.fan.lines else replace(rig, fan=Fan((rig.fan.planes[1],)))


def profile_picture(scenario: Scenario, index: int, rig: Rig | None = None) -> Picture:
    """Render picture `index` of the fan alone on the scenario's object, moved on by `travel_mm` for each picture.

    A moved object shows other speckle; of one that stands still only the camera's noise is new.
    """
    rig = rig or scenario_rig(scenario)
    moved = scenario.travel_mm * (index - (scenario.frames - 1) / 2)
    seed = scenario.seed if scenario.travel_mm == 0 else (scenario.seed + 7919 * (index + 1)) % 2**63
    there = replace(scenario, away_mm=scenario.away_mm + moved, seed=seed)
    stage, _, _ = scan_of(replace(there, frames=0), rig)
    return stage.sensor.expose(stage.still, generator(scenario.seed, "profile", index))


def changed_rig(scenario: Scenario, rig: Rig) -> Rig:
    """Make the rig as it is during the scan: the calibrated one with the scenario's changes since then."""
    focal_ppm = scenario.warming.focal_ppm
    if not scenario.turned_urad and not scenario.drifted_px and not focal_ppm:
        return rig
    fan = displaced_fan(rig.fan, np.array([scenario.turned_urad * 1e-6, 0.0, 0.0]), rig.fan_emitter)
    rig = _drifted(rig, scenario.drifted_px)
    grown = rig.camera.matrix * np.array(
        [[1 + focal_ppm * 1e-6] * 2 + [1.0], [1.0, 1 + focal_ppm * 1e-6, 1.0], [1.0] * 3]
    )
    return replace(rig, camera=Camera(rig.camera.image_size, grown, rig.camera.distortion), fan=fan)


def _drifted(rig: Rig, drift_px: float) -> Rig:
    """The rig with its camera's picture moved to the right, and 0.6 times as far down."""
    matrix = rig.camera.matrix + drift_px * np.array([[0, 0, 1.0], [0, 0, 0.6], [0, 0, 0]])
    return replace(rig, camera=Camera(rig.camera.image_size, matrix, rig.camera.distortion))


def scan_of(scenario: Scenario, rig: Rig | None = None) -> tuple[ScanStage, list[Sheet], dict[str, object]]:
    """Make a scenario's stage, the laser sheets of each frame and the true figures, to render frames without a disk.

    >>> stage, sheets, _ = scan_of(Scenario(scale=0.1, frames=3))
    >>> stage.frame(0, sheets[0]).shape
    (275, 384)
    """
    rig = rig or scenario_rig(scenario)
    scene, figures = build_scene(scenario)
    reach = sweep_range(scene, aim_of(scene))
    sheets = hand_sweeps(rig, reach, scenario.frames, generator(scenario.seed, "sweeps"), scenario.setup)
    if scenario.setup.fan_turned_deg:
        turn = Turn.about_the_view(WORK_POINT, scenario.setup.fan_turned_deg)
        sheets = [turn.sheet(sheet) for sheet in sheets]
    return _stage(scenario, rig, scene), sheets, figures


def moved_stage(scenario: Scenario, rig: Rig) -> ScanStage | None:
    """Make the stage after the object, table or camera was moved in the scan; None if nothing is moved."""
    aside_mm = scenario.boards.moved_mm
    if not (scenario.lifted_mm or scenario.pushed_mm or scenario.table_mm or scenario.bumped_px or aside_mm):
        return None
    scene, _ = build_scene(scenario)
    assert scene.pose_cam_table is not None
    up, aside = scene.pose_cam_table.rotation[:, 2], scene.pose_cam_table.rotation[:, 0]
    scene = scene.moved(Pose(np.eye(3), scenario.lifted_mm * up + scenario.pushed_mm * aside))
    scene = scene.moved(Pose(np.eye(3), -scenario.table_mm * up), with_table=True)
    if aside_mm and scene.boards:
        first = scene.boards[0].moved(Pose(np.eye(3), aside_mm * aside))
        scene = replace(scene, boards=(first, *scene.boards[1:]))
    return _stage(scenario, _drifted(rig, scenario.bumped_px), scene)


def moving_sheets(scenario: Scenario, sheets: Sequence[Sheet]) -> list[tuple[Sheet, ...]]:
    """List for each frame the sheets of light it shows: one, or several if the hand moves while it is exposed."""
    motion = HandMotion(scenario.hand_mm_s, scenario.tremor_mm, scenario.readout_ms / 1000, scenario.exposure_ms / 1000)
    if not motion.is_visible:
        return [(sheet,) for sheet in sheets]
    rows, headings = round(FULL_SIZE[1] * scenario.scale), headings_of(len(sheets))
    return [
        motion.sheets(sheet, rows, headings[i], generator(scenario.seed, "hand motion", i))
        for i, sheet in enumerate(sheets)
    ]


def _stage(scenario: Scenario, rig: Rig, scene: Scene) -> ScanStage:
    return ScanStage(
        rig,
        scene,
        Sensor(rig.optics, scenario.bits, scenario.noise, effects=scenario.sensor, seed=scenario.seed),
        seed=scenario.seed,
        ambient_grey=scenario.ambient_grey,
        texture=scenario.texture,
        aim=WORK_POINT,
        effects=StageEffects(
            scenario.lens,
            scenario.room,
            scenario.warming,
            scenario.mirror_share,
            scenario.frames,
            scenario.readout_ms / 1000,
            scenario.transport,
            scenario.boards.shaded,
        ),
    )


def _write_all(
    made: Path,
    render: Callable[[str], Iterable[tuple[str, Picture]]],
    names: list[str],
    progress: Progress,
    step: str,
    effects: SensorEffects,
) -> None:
    """Render and write the pictures of all `names`, two at once."""

    def write(name: str) -> None:
        for path, picture in render(name):
            if effects.colour or effects.jpeg_quality:
                file = (made / path).with_suffix(effects.suffix)
                write_bytes(file, effects.file_of(picture), sync=False)
            else:
                write_picture(made / path, picture)

    rendered = cast("Generator[None, None, None]", ordered_map(write, names, RENDER_THREADS))
    with closing(rendered) as written:  # so that no thread outlives a cancelled job
        for _ in steps(written, progress, step, len(names)):
            pass


def _copy_calibration(earlier: Path, made: Path, rig: Rig) -> tuple[dict[str, Pose], dict[str, Pose]]:
    """Copy camera/ and planes/ of an earlier set; returns the poses in them."""
    truth = load_truth(earlier)
    lit = rig.fan_beam.peak_grey > 0
    same_fan = not lit or (truth.fan is not None and abs(truth.fan.pis - rig.fan.pis).max() < 1e-12)
    same = truth.camera.image_size == rig.camera.image_size and same_fan
    if not same:
        raise InputError(
            Message("simulate.other_rig", "its rig or picture size is another one"),
            where=earlier,
            todo=Message("simulate.advice_render_anew", "render the calibration anew"),
        )
    for part in ("camera", "planes"):
        shutil.copytree(earlier / part, made / part, dirs_exist_ok=True)
    return dict(truth.camera_poses), dict(truth.plane_poses)


def _put_in_place(made: Path, hidden: Path, folder: Path) -> None:
    """Move set and truth to their places; the set last, so that a set that is there always has its truth."""
    beside = truth_folder(folder)
    remove_tree(beside)
    if folder.exists():
        folder.rmdir()
    rename(hidden, beside)
    rename(made, folder)
