"""Results and calibrations in the formats of other programs."""
