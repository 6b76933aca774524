"""The simulated rig as a live source."""
