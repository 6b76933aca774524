"""Verdicts about a way of measuring: repeats, gauge studies, budgets, acceptance checks; and about series of parts."""
