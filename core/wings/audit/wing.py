"""What this wing adds."""

from core.wing import Wing

WING = Wing(
    "audit",
    commands="core.wings.audit.commands:commands",
    after="unpack",
    witness="core.wings.audit.witness:WITNESS",
)
