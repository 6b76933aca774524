"""Poses of the plane target: what a pair of pictures shows, where the target was, and which stripe is of which line."""
