"""Scene of the simulated camera: objects, targets, laser light, speckle, pictures."""
