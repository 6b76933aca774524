"""One cloud of all views in the first view's camera frame, its points with their errors and those of the joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.deviations import Source
from core.findings.proof import Doubts
from core.inspect.causes import Cause
from core.inspect.uncertainty.joined_errors import JoinedErrors, ViewErrors
from core.inspect.uncertainty.part import Part
from core.inspect.uncertainty.point_errors import PointErrors
from core.scan.surface.cloud import Cloud
from core.scan.surface.triangulate import join as joined_points
from core.views.joint import Joint


@dataclass(frozen=True, eq=False, slots=True)
class View:
    """Scan of one view: its name, its points in its own camera frame, and their errors."""

    name: str
    cloud: Cloud
    errors: PointErrors


@dataclass(frozen=True, eq=False, slots=True)
class JoinedCloud:
    """Points of all views in the first view's camera frame, how their errors hang together, and the joint."""

    cloud: Cloud
    errors: JoinedErrors
    joint: Joint


def join_clouds(joint: Joint, views: Sequence[View], *, scale_sd: float = 0.0, doubts: Doubts = ()) -> JoinedCloud:
    """Put the points of V views into the first view's camera frame.

    Parameters
    ----------
    joint
        Of these views, in this order.
    views
        Their scans, by the same calibration.
    scale_sd
        Standard uncertainty of the plane target's size, as a share of it.
    doubts
        Why the joint proves nothing.
    """
    sources, columns = _aligned([view.errors.sources for view in views])
    own = np.zeros((len(sources), 6 * len(views)))
    for view, places in zip(reversed(views), reversed(columns), strict=True):
        if view.errors.common is not None:
            own[places] = joint.of_calibration(view.errors.common, scale_sd)
    of_carrier = np.vstack([own, joint.by_marks.T, joint.by_carrier.T, joint.by_temperature.T])
    causes = [Cause.JOINT_MARKS] * joint.by_marks.shape[1] + [Cause.JOINT_CARRIER] * joint.by_carrier.shape[1]
    assumed = joint.carrier.temperature.warmth.assumed
    causes.append(Cause.JOINT_TEMPERATURE_ASSUMED if assumed else Cause.JOINT_TEMPERATURE)
    of_views, clouds, first_sweep, first_line = [], [], 0, 0
    for number, (view, places) in enumerate(zip(views, columns, strict=True)):
        motions = joint.motions(number, of_carrier)
        one = ViewErrors(joint.pose(number), view.errors, first_sweep, first_line, places, motions)
        placed = one.joined(view.cloud, number)
        clouds.append(replace(placed, sigma_common=one.sigma_common(placed)))
        of_views.append(one)
        first_sweep += max(view.errors.sweeps, int(view.cloud.sweep.max(initial=-1)) + 1)
        first_line += max(0, -int(view.cloud.sweep.min(initial=0)))
    first = views[0].errors
    errors = JoinedErrors(
        common=first.common,
        stripe_px=first.stripe_px,
        part=None if first.part is None else twice(first.part),
        views=tuple(of_views),
        joined_sources=sources,
        joint_causes=tuple(causes),
        joint_doubts=doubts,
    )
    return JoinedCloud(joined_points(clouds), errors, joint)


def twice(part: Part) -> Part:
    """Copy what is stated of a part for a thickness between two own faces of it: offsets and layers count twice."""
    offset, sd = part.offset_mm, part.offset_sd_mm
    return replace(
        part,
        offset_mm=None if offset is None else 2 * offset,
        offset_sd_mm=None if sd is None else 2 * sd,
        layers=2 * part.layers,
    )


def _aligned(by_view: Sequence[Sequence[Source]]) -> tuple[tuple[Source, ...], list[NDArray[np.intp]]]:
    """The displacements of all views, and the place of each view's among them: the n-th of a source is the same."""
    every: dict[tuple[Source, int], int] = {}
    columns = []
    for sources in by_view:
        seen: dict[Source, int] = {}
        places = []
        for source in sources:
            seen[source] = seen.get(source, -1) + 1
            places.append(every.setdefault((source, seen[source]), len(every)))
        columns.append(np.array(places, dtype=np.intp))
    return tuple(source for source, _ in every), columns
