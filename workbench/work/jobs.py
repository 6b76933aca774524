"""What the window asks `core` to do, by name.

Named instead of imported: a job runs in another process, and a window that imported the numerical libraries would
open seconds later. `tests/workbench/test_rooms.py` holds every name to a function that exists.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any, NewType

Job = NewType("Job", str)

_CALIBRATION = "core.pipeline.project.calibration"
_MEASURING = "core.pipeline.project.measuring"

FIND_VIEWS = Job(f"{_CALIBRATION}:find_views")
FOUND_VIEWS = Job(f"{_CALIBRATION}:found_views")
SOLVE_VIEWS = Job(f"{_CALIBRATION}:solve_views")
ACCEPT_CAMERA = Job(f"{_CALIBRATION}:accept_camera")
FIND_POSES = Job(f"{_CALIBRATION}:find_poses")
FOUND_POSES = Job(f"{_CALIBRATION}:found_poses")
SOLVE_POSES = Job(f"{_CALIBRATION}:solve_poses")
ACCEPT_PLANES = Job(f"{_CALIBRATION}:accept_planes")
SHOW_POSE = Job("core.pipeline.project.details:show_pose")
RECALL_POSES = Job("core.pipeline.project.details:recall_poses")
MEASURE_SCAN = Job(f"{_MEASURING}:measure_scan")
MEASURE_PROFILES = Job("core.pipeline.project.profiles:measure_profiles")
CHECK_RIG = Job("core.pipeline.project.interim_check:check_rig")
CHECK_HISTORY = Job("core.pipeline.project.interim_check:check_history")
PROPOSE_READJUSTMENT = Job("core.pipeline.project.interim_check:propose_project_readjustment")
ACCEPT_READJUSTMENT = Job("core.pipeline.project.interim_check:accept_readjustment")
COMPARE_WITH_ARTEFACT = Job("core.pipeline.project.interim_check:compare_with_artefact")
ARTEFACT_CHARTS = Job("core.pipeline.project.interim_check:artefact_charts")
ARTEFACT_CHECKS = Job("core.pipeline.project.interim_check:artefact_checks")
OWN_ARTEFACTS = Job("core.files.results.artefact_register:own_register")
KEEP_OWN_ARTEFACT = Job("core.files.results.artefact_register:store_own")
CHANGE_OWN_ARTEFACT = Job("core.files.results.artefact_register:change_own")
COMPARABLE_LENGTHS = Job("core.pipeline.project.interim_check:comparable_lengths")
SHOW_CHECK = Job("core.pipeline.project.interim_check:show_check")
WATCH_SCAN = Job("core.pipeline.project.watched_scan:measure_watched")
SHOW_SCAN = Job("core.pipeline.project.details:show_scan")
SHOW_FRAME = Job("core.pipeline.project.details:show_frame")
ACCEPTED_CALIBRATION = Job("core.pipeline.project.details:accepted_calibration")
MARKED_FRAMES = Job("core.files.recording.marks:marked_frames")
LIST_FRAMES = Job("core.files.recording.set_listing:scan_frames")
MEASURE_GAUGE = Job(f"{_MEASURING}:measure_gauge")
MEASURE_FEATURES = Job("core.pipeline.project.inspection:measure_features")
LOOK_AT_FEATURES = Job("core.pipeline.project.inspection:look_at_features")
MEASURED_MASTER = Job("core.pipeline.steps.master_step:measured_master")
READ_PLAN = Job("core.files.plan.plan_file:read_plan")
WRITE_PLAN = Job("core.files.plan.plan_file:write_plan")
MEASURE_ALL = Job("core.pipeline.project.whole:measure_all")
MAKE_REPORT = Job("core.pipeline.project.report:make_report")
PREVIEW_REPORT = Job("core.pipeline.project.export:preview_report")
CHOOSE_TEMPLATE = Job("core.pipeline.project.export:choose_template")
EXPORT = Job("core.pipeline.project.export:export")
READ_CAMERA = Job("core.files.project.calibration_store:read_stored_camera")
KEEP_IMPORTED_CAMERA = Job("core.pipeline.project.export:keep_imported_camera")
RECALL_CAMERA = Job("core.pipeline.project.camera_history:recall_camera")
HISTORY = Job("core.files.project.calibration_store:history")
COMPARE_CAMERAS = Job("core.pipeline.project.camera_history:compare_stored")
JUDGE_VIEWS = Job("core.calibrate.camera.views:judge_views")
TARGET_SHEET = Job("core.pipeline.steps.prints:write_target_sheet")
QUICK_CARD = Job("core.pipeline.steps.prints:write_quick_card")
LIST_PICTURES = Job("core.files.recording.set_listing:pictures_in")
NOT_READ = Job("core.files.recording.set_listing:notes_on_not_read")
READ_PICTURE = Job("core.files.pictures:read_picture")
DISPLAY_PICTURE = Job("core.pipeline.project.thumbnails:display_picture")
DISPLAY_FRAME = Job("core.pipeline.project.thumbnails:display_frame")
STRIPE_THUMBNAILS = Job("core.pipeline.project.thumbnails:stripe_thumbnails")
THUMBNAILS = Job("core.pipeline.project.thumbnails:thumbnails")
LIST_SOURCES = Job("core.pipeline.live.sources:list_sources")
MISSING_DRIVER = Job("core.pipeline.live.sources:missing_driver")
COPY_PROJECT = Job("core.files.project.copying:copy_project")
NEXT_PART = Job("core.files.project.next_part:next_part")
PACK_PROJECT = Job("core.files.project.packing:pack_project")
SETS_IN = Job("core.pipeline.batch:sets_in")
MEASURE_SETS = Job("core.pipeline.batch:measure_sets")
WRITE_SCRIPT = Job("core.pipeline.project.script:write_script")
UNPACK_PROJECT = Job("core.files.project.packing:unpack_project")
ADD_RECORDING = Job("core.files.recording.add_recording:add_recording")
PLAN_IMPORT = Job("core.files.recording.import_plan:plan_import")
IMPORT_PICTURES = Job("core.files.recording.import_pictures:import_pictures")
RUN_LIVE = Job("workbench.work.worker:run_live_job")
SAMPLE_PROJECT = Job("core.pipeline.project.sample_project:sample_project")
SAMPLE_TO_MEASURE = Job("core.pipeline.project.sample_project:sample_to_measure")
CORNER_SHEETS = Job("core.pipeline.project.corner:write_corner_sheets")
CLEAR_SAMPLE = Job("core.pipeline.project.sample_project:clear_unfinished")
PLACING = Job("core.pipeline.project.placing:placing")
INSPECTION_VIEW = Job("core.pipeline.project.inspect_view:inspection_view")
OUTLINE_SELECTED = Job("core.pipeline.project.inspect_view:outline_selected")
CLICKED_FACES = Job("core.pipeline.project.clicked_faces:clicked_faces")
LISTED_RESULTS = Job("core.pipeline.project.verdict:listed_results")
COMPILE_AHEAD = Job("core.pipeline.live.warm_up:ahead")

REFUSE = Job("core.errors:refuse")


def name_of(job: Job) -> str:
    """Return the name of a job's function, without its module."""
    return job.rpartition(":")[2]


def resolve(job: Job) -> Any:
    """Import the function of a job and return it."""
    module, _, name = job.partition(":")
    return getattr(import_module(module), name)
