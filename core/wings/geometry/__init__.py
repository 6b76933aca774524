"""Geometry: the measured part against another surface."""
