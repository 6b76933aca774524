"""Location of the sweeps: light planes of the frames, from crossings alone."""
