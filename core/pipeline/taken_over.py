"""What a whole measurement leaves to a second process: named, so that it imports while the first one does."""

TAKEN_OVER = ("core.pipeline.steps.scan.pictures", "core.pipeline.steps.planes_step")
