"""Surfaces fitted to points: planes, spheres, cylinders."""
