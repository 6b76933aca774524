"""Stripes refined: the likeliest place of each, from every pixel of its cross-sections."""
