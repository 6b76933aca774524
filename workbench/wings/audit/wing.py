"""What this wing adds to the window."""

from core.messages import label
from workbench.wing import MenuEntry, WindowWing

WINDOW_WING = WindowWing(
    "audit",
    entries=(
        MenuEntry(
            "audit",
            label("Au&dit trail …"),
            "workbench.wings.audit.window:trail_of",
            after="export",
            needs_project=True,
        ),
        MenuEntry(
            "sign in",
            label("S&ign in or out …"),
            "workbench.wings.audit.people:signing_in",
            after="export",
            needs_project=True,
        ),
    ),
    guard="workbench.wings.audit.people:guard_of",
)
