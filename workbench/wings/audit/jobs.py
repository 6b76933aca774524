"""What the window asks `core` to do, by name: see `workbench.work.jobs`."""

from __future__ import annotations

from workbench.work.jobs import Job

VERIFY = Job("core.wings.audit.verify:verify")
