"""Verdicts about a way of measuring: repeats, gauge studies, uncertainty budgets, acceptance checks."""
