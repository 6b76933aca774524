"""What this wing adds."""

from core.wing import Wing

WING = Wing(
    "studies",
    commands="core.wings.studies.commands:commands",
    findings="core.wings.studies.findings:ROWS",
    reads_study="core.wings.studies.printed:read_printed",
)
