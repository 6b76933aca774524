"""From pictures to results: one recording set, many of them, a live camera, a project of the window."""
