"""What the pages ask `core` to do, by name: see `workbench.work.jobs`."""

from __future__ import annotations

from workbench.work.jobs import Job

SHOW_COMPARISON = Job("core.wings.geometry.comparison.in_project:show_comparison")
FORGET_COMPARISON = Job("core.wings.geometry.comparison.in_project:forget_comparison")
