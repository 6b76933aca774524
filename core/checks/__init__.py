"""What shows whether a rig still measures: repeats of one part, known artefacts, the control chart of its checks."""
