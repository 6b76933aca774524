"""Studies of the way of measuring."""
