"""Orientation and position to datums, and deviation from a nominal surface."""
