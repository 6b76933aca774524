"""A picture with layers over it."""
