"""What residuals say of two faces that light profiles lie on: one form in all pictures, and whether points scatter.

Each picture has its own parallel planes; what is left beside them is compared over all pictures at the same places
along the faces. The part's form and light that is bent leave the same in every picture, and pictures cannot tell the
one from the other. What the calibrations allow is no pattern (`core.model.residuals.judge_with_shared`), except for
light of which they know that it lies in no planes: that is what is looked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from core.findings.table import note_of
from core.inspect.fit.judged_form import ABOVE, BELOW, Left, Places, Stretches, of_scatter, pattern_on
from core.inspect.fit.shapes import Parts, Shape
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.model.arrays import Array
from core.model.residuals import Judgement, Residuals, SharedErrors, judge_with_shared
from core.scan.surface.cloud import Cloud

MOST_PICTURES = 30
"""Of more pictures so many are judged, evenly among all: what they have in common is as plain in these."""


@dataclass(frozen=True, eq=False, slots=True)
class FacesInPicture:
    """Points of both faces in one picture.

    Parameters
    ----------
    cloud, part
        N points, and which face each is on (N,), from 0.
    shape
        The faces as fitted.
    position
        (N,) in mm along the profiles.
    errors
        Of the points.
    """

    cloud: Cloud
    part: Parts
    shape: Shape
    position: Array
    errors: PointErrors


def notes_on_profiles(pictures: Sequence[FacesInPicture], names: Sequence[Message]) -> tuple[Message, ...]:
    """Make the notes on form errors of the two faces called `names`, or else on too much scatter of their points."""
    few = np.unique(np.linspace(0, len(pictures) - 1, min(len(pictures), MOST_PICTURES)).astype(int))
    pictures = [pictures[index] for index in few]
    places = [Places.in_section(one.position, one.part) for one in pictures]
    found = _judged(pictures, places)
    if found is None:
        return ()
    notes = []
    for number, name in enumerate(names):
        face = pictures[0].cloud.select(np.flatnonzero(pictures[0].part == number))
        pattern = pattern_on(found, places[0], number, face)
        if pattern is not None:
            most = int(np.argmax(np.abs(pattern.height)))
            notes.append(
                note_of(
                    "profile.not_straight",
                    name=name,
                    share=float((pattern.at[most, 0] + 1) / 2),
                    mm=abs(float(pattern.height[most])),
                    where=ABOVE if pattern.height[most] > 0 else BELOW,
                )
            )
    return tuple(notes) or of_scatter(found, names)


def _judged(pictures: Sequence[FacesInPicture], places: Sequence[Places]) -> Judgement | None:
    """Judge the stretches of all pictures; groups are the pictures, cells the places. None if there are too few."""
    stretches = [
        Stretches.of(one.cloud, Left.of(one.shape, one.cloud.points, one.part), one.part, of, one.errors)
        for one, of in zip(pictures, places, strict=True)
    ]
    design = block_diag(*(one.design for one in stretches))
    if len(design) <= design.shape[1]:
        return None
    residuals = Residuals(
        np.concatenate([one.misfit for one in stretches]),
        np.concatenate([one.expected for one in stretches]),
        np.repeat(np.arange(len(stretches)), [len(one.cell) for one in stretches]),
        np.concatenate([one.cell for one in stretches]),
        places[0].number * (int(pictures[0].part.max(initial=0)) + 1),
    )
    own = np.concatenate([one.sources.own for one in stretches])
    shared = np.vstack([one.sources.explained for one in stretches])
    return judge_with_shared(residuals, SharedErrors(own, shared, design))
