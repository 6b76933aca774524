"""Reasons why a button is grey: the first that holds is told, and "" where none does."""

from __future__ import annotations


def why(when: object, sentence: str) -> str:
    """Return a sentence where something is so, else ""."""
    return sentence if when else ""


def first(*reasons: str) -> str:
    """Return the first reason that there is, or ""."""
    return next(filter(None, reasons), "")
