"""What the pages ask `core` to do, by name: see `workbench.work.jobs`."""

from __future__ import annotations

from workbench.work.jobs import Job

KEEP_STUDY = Job("core.wings.studies.study_step:keep_study")
KEEP_TYPE1 = Job("core.wings.studies.study_step:keep_type1")
LOOK_AT_STUDY = Job("core.wings.studies.study_step:look_at_study")
PROJECT_ROWS = Job("core.wings.studies.study_step:project_rows")
READ_STUDY_TABLE = Job("core.wings.studies.study_step:read_study_table")
EXPORT_STUDY = Job("core.wings.studies.study_step:export_study")
TYPE1_STUDY = Job("core.wings.studies.kinds.type1:type1_study")
