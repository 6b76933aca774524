"""What the window asks for: calibrations, measurements and reports of a project."""
