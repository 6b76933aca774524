"""Frame sources: where pictures come from."""
