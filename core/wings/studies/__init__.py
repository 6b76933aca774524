"""Studies of the way of measuring, and of series of parts."""
