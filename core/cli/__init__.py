"""The command line: `trisect run SET --out DIR` and each step alone."""

from core.cli.app import main

__all__ = ["main"]
