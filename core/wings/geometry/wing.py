"""What this wing adds."""

from core.messages import label
from core.wing import ReportSection, Wing

WING = Wing(
    "geometry",
    commands="core.wings.geometry.commands:commands",
    after="inspect",
    sections=(
        ReportSection(
            label("Comparison"), "core.wings.geometry.comparison.reported:reported_facts", below_results="comparison"
        ),
    ),
    exports="core.wings.geometry.exports:ROWS",
    feature_kinds="core.wings.geometry.kinds:KINDS",
)
