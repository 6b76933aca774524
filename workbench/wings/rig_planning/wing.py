"""What this wing adds to the window."""

from core.messages import label
from workbench.wing import MenuEntry, WindowWing

WINDOW_WING = WindowWing(
    "rig_planning",
    entries=(
        MenuEntry(
            "plan rig", label("&Plan a rig …"), "workbench.wings.rig_planning.rig_plan:planning_of", after="console"
        ),
    ),
)
