"""What this wing adds to the window."""

from core.messages import label
from workbench.wing import InspectLayer, WindowWing

WINDOW_WING = WindowWing(
    "geometry",
    layers=(
        InspectLayer(
            "comparison",
            label("deviation from other surface"),
            label("Comparison with another surface"),
            "workbench.wings.geometry.comparison:comparison_of",
            "workbench.wings.geometry.comparison_panel:ComparisonPanel",
        ),
    ),
)
