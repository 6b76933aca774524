"""Features of a wing that is not there: they cannot be measured, and that is told."""

from __future__ import annotations

from core.errors import InputError
from core.inspect.features.measured import FeatureResult, Scene
from core.inspect.plan.feature_spec import FeatureSpec
from core.messages import Message
from core.wing import OUR_KINDS, why_away


def measure_missing(spec: FeatureSpec, _: Scene) -> FeatureResult:
    """Refuse to measure a feature whose kind is of one of our own wings that is not there, with an InputError."""
    wing = OUR_KINDS[spec.kind]
    why, todo = why_away(wing)
    what = Message("feature.of_missing_wing", "{kind} is of the wing {wing}, {why}", kind=spec.kind, wing=wing, why=why)
    raise InputError(what, todo=todo)
