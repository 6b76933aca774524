"""The pages of the wing of geometry."""
