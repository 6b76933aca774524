"""The one way a detection fails."""

from __future__ import annotations

from core.errors import InputError


class TargetNotFound(InputError):
    """The picture does not show the whole target; the sentence tells what it shows instead."""
