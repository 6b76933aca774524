"""Stripes: a picture to the sub-pixel centrelines of all stripes of light in it."""
