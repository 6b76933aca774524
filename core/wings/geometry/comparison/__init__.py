"""The scan compared with another surface, place by place."""
