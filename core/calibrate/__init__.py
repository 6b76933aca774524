"""Features to model: the camera, the fan."""
