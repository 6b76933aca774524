"""Reasons why a button is grey: the first that holds is told, and "" where none does."""

from __future__ import annotations


def why(when: object, sentence: str) -> str:
    """Return `sentence` if `when` is true, else ""."""
    return sentence if when else ""


def first(*reasons: str) -> str:
    """Return the first reason that is not ""; "" if all are."""
    return next(filter(None, reasons), "")
