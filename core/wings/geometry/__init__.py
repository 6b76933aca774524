"""Geometry: the measured part against another surface, and against datums."""
