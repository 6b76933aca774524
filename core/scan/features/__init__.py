"""Pictures to features: the reference, the centrelines of each frame, and where they cross."""
