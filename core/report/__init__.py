"""Verdict to paper: tables, plots, the PDF."""
