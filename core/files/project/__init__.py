"""A project's folder: project.json, its pictures, its calibrations and its results."""
