"""Files of strangers: every reader against seeded mutations of every kind of file, in child processes under limits."""
