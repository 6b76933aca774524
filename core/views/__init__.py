"""Views of one part in one frame, joined by a carrier of reference marks, with the joint's uncertainty kept."""
