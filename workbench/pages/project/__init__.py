"""The project page, and the ways into and out of a project."""
