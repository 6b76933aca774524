"""The laser planes page."""
