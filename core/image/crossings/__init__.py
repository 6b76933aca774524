"""Crossings: where two centrelines meet, with covariance."""
