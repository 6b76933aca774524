"""Cameras of each maker and standard behind one interface."""
