"""Plots and meters."""
