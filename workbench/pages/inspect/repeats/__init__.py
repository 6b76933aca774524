"""Repeats: the thickness of several scans of one part."""
