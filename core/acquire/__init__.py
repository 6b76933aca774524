"""Frame sources: where pictures come from, in order, as many as there are, never all at once."""
