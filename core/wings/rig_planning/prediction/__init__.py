"""What a rig will be able to measure, before it is built: the very measurement on simulated centrelines, no picture."""
