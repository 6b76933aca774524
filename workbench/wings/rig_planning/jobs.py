"""What the page asks `core` to do, by name: see `workbench.work.jobs`."""

from __future__ import annotations

from workbench.work.jobs import Job

FORETELL_RIG = Job("core.wings.rig_planning.rig_plan:foretell_rig")
FORETELL_PROJECT = Job("core.wings.rig_planning.rig_plan:foretell_project")
WRITE_RIG_PLAN = Job("core.wings.rig_planning.rig_plan:write_foretold")
