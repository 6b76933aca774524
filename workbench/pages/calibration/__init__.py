"""What the pages of both calibrations share."""
