"""Studies of the measurement: their tables, study.json."""
