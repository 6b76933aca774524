"""The live source of a step."""
