"""From pictures to results: the steps of a recording set, a live camera, a project of the window."""
