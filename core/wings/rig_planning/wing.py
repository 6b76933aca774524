"""What this wing adds."""

from core.wing import Wing

WING = Wing("rig_planning", commands="core.wings.rig_planning.commands:commands", after="card")
