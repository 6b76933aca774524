"""The digital twin: scenes, lasers and a camera with hidden truth."""
