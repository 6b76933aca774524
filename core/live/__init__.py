"""What a window and a live recording say to each other; light enough for a window to import at its start."""
