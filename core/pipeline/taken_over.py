"""What a whole measurement leaves to a second process: named, so that it imports while the first one does."""

TAKEN_OVER = ("core.pipeline.steps.scan.pictures", "core.pipeline.steps.planes_step")

MAKES_SURFACES = ("core.pipeline.steps.scan.surface",)
"""The same of a scan whose pictures have been looked at, or are shown while they are."""
