"""Features measured beside the thickness, and what they have in common."""
