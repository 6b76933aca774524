"""What this wing adds to the window."""

from core.messages import label
from workbench.wing import InspectTab, WindowWing

WINDOW_WING = WindowWing(
    "studies",
    tabs=(
        InspectTab(
            label("Studies"),
            label("How good the way of measuring is: gauge R&R, acceptance"),
            "workbench.wings.studies.tab:studies_tab",
        ),
    ),
    below_repeats="workbench.wings.studies.type1:type1_part",
)
