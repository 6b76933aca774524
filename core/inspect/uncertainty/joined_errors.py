"""Errors of the points of several views joined in one frame: each view's own, what all have in common, the joint's.

The calibrations of camera and fan are the same in all views: one displacement moves the points of each view along its
own rays, and the joint with them. So what two views of opposite faces see too near adds up in the thickness, and is
never taken twice as if by chance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.calibrate.deviations import Source
from core.findings.proof import Doubts
from core.inspect.causes import CALIBRATIONS, Cause
from core.inspect.uncertainty.point_errors import PointErrors
from core.messages import Message
from core.model import Pose
from core.model.arrays import Array
from core.scan.surface.cloud import Cloud


@dataclass(frozen=True, eq=False)
class ViewErrors:
    """Errors of the points of one view of several joined ones.

    Parameters
    ----------
    pose
        The view's camera frame to that of the first view.
    errors
        Of its points, in its own camera frame.
    first_sweep, first_line
        How many sweeps, and how many fan lines, the views before it have: its own are counted on from there.
    columns
        (K,) place of each of its displaced calibrations among those of all views, then of the joint.
    motions
        (C, 6) motion of the view by each of these C causes, (ω in rad, τ in mm) in the first view's camera frame.
    """

    pose: Pose
    errors: PointErrors
    first_sweep: int
    first_line: int
    columns: NDArray[np.intp]
    motions: Array

    def own(self, cloud: Cloud) -> Cloud:
        """Move points of this view back into its own camera frame, and count its sweeps as its scan does."""
        back = self.pose.inverse()
        return replace(
            cloud,
            points=back.apply(cloud.points),
            normals=cloud.normals @ self.pose.rotation,
            sweep=np.where(cloud.sweep >= 0, cloud.sweep - self.first_sweep, cloud.sweep + self.first_line),
            view=np.zeros(len(cloud), dtype=np.int64),
        )

    def joined(self, cloud: Cloud, number: int) -> Cloud:
        """Move points of this view into the first view's camera frame, as those of view `number`."""
        return replace(
            cloud,
            points=self.pose.apply(cloud.points),
            normals=cloud.normals @ self.pose.rotation.T,
            sweep=np.where(cloud.sweep >= 0, cloud.sweep + self.first_sweep, cloud.sweep - self.first_line),
            view=np.full(len(cloud), number, dtype=np.int64),
        )

    def sigma_common(self, cloud: Cloud) -> Array:
        """Compute the standard uncertainty (N,) in mm, along their rays, of points of this view in the first's frame.

        By all that its points have in common: calibrations and the joint.
        """
        own = self.own(cloud).points
        rays = own / np.linalg.norm(own, axis=1, keepdims=True) @ self.pose.rotation.T
        return np.asarray(np.linalg.norm(self.common_along(cloud, rays), axis=1), dtype=np.float64)

    def common_along(self, cloud: Cloud, directions: Array) -> Array:
        """Compute by how much in mm each common cause (C,) moves points (N,) of this view along `directions` (N, 3).

        Both in the first view's frame; a displaced calibration moves the points in their view, and the view with them.
        """
        along = np.hstack([np.cross(cloud.points, directions), directions]) @ self.motions.T
        own = self.own(cloud)
        if self.errors.common is not None:
            for column, change in zip(self.columns, self.errors.common.changes(own.uv, own.sweep), strict=True):
                along[:, column] += np.einsum("ni,ni->n", change @ self.pose.rotation.T, directions)
        return np.asarray(along, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class JoinedErrors(PointErrors):
    """Errors of the points of several views and how they are correlated; see the module.

    Parameters
    ----------
    views
        Each view's.
    joined_sources
        Calibrations that the displacements of all views together come from.
    joint_causes
        What acts on the joint beside them: of each cause whether it is a mark's noise, the carrier's, or its warmth.
    joint_doubts
        Why the joint proves nothing.
    """

    views: tuple[ViewErrors, ...] = ()
    joined_sources: tuple[Source, ...] = ()
    joint_causes: tuple[Cause, ...] = ()
    joint_doubts: Doubts = ()

    @property
    def doubts(self) -> Doubts:
        """Reasons why nothing measured in the views proves anything: those of the joint first, then of each view."""
        return tuple(
            dict.fromkeys((*self.joint_doubts, *(doubt for view in self.views for doubt in view.errors.doubts)))
        )

    @property
    def sources(self) -> tuple[Source, ...]:
        """Calibrations (K,) that the common errors of all views come from, by name."""
        return self.joined_sources

    @property
    def calibrations(self) -> tuple[Cause, ...]:
        """Causes of what points have in common: those of the calibrations, then of the joint."""
        return (*(CALIBRATIONS[source] for source in self.joined_sources), *self.joint_causes)

    def missing(self) -> tuple[Message, ...]:
        """List what an uncertainty computed from these errors lacks in any view."""
        return tuple(dict.fromkeys(lack for view in self.views for lack in view.errors.missing()))
