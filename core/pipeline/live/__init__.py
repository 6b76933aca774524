"""A live camera: frames to a recording, to calibrations and to a preview."""
