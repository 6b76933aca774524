"""What the scan step does: look at the pictures, judge what is solved, make the surface, tell and write all of it."""
