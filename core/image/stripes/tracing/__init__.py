"""Stripes found: seeds, ridge points, runs of them."""
