"""The camera page."""
