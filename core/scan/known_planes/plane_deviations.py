"""Deviations of known planes: how they follow camera and print, and what errs in them alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from core.calibrate.deviations import NEGLIGIBLE, SCALES, Deviation, Source
from core.model import Camera
from core.model.arrays import Array
from core.scan.known_planes.known_plane import Control

PLANE_TARGET = "plane_target"
"""Print of the plane target, by which the fan was calibrated."""


def followed_by_planes(
    deviations: Sequence[Deviation], camera: Camera, control: Control, scale_sd: float
) -> tuple[Deviation, ...]:
    """Complete `deviations` from `camera` and fan by the known planes that their pictures would then give.

    Boards of the plane target's print are larger where it is, by `scale_sd`.
    """
    if not control.planes:
        return tuple(deviations)
    return tuple(_followed(one, camera, control, scale_sd) for one in deviations)


def _followed(one: Deviation, camera: Camera, control: Control, scale_sd: float) -> Deviation:
    pis = control.behind(camera, one.camera).plane_pis
    if one.source in SCALES:
        same = np.array([plane.print_of == PLANE_TARGET for plane in control.planes])
        pis = np.where(same[:, None], (1 - scale_sd) * pis, pis)
    return replace(one, planes=pis)


def own_deviations(camera: Camera, control: Control, *, fan_has_scale: bool) -> Iterator[Deviation]:
    """Yield what errs in the known planes alone: pose, flatness, and the sizes of prints.

    `fan_has_scale`: the size of the plane target's print is a deviation of the fan already.
    """
    for number, plane in enumerate(control.planes):
        flatness: Source = "assumed known flatness" if plane.flatness_assumed else "known flatness"
        causes: tuple[tuple[Source, Array], ...] = ("known pose", plane.of_pose), (flatness, plane.of_flatness)
        for source, covariance in causes:
            values, vectors = np.linalg.eigh(covariance)
            for value, vector in zip(values[::-1], vectors.T[::-1], strict=True):
                if value > NEGLIGIBLE * values[-1]:
                    yield _displaced(camera, control, source, {number: np.sqrt(value) * vector})
    for name in dict.fromkeys(plane.print_of for plane in control.planes):
        mine = [(number, plane) for number, plane in enumerate(control.planes) if plane.print_of == name]
        sd = max(plane.scale_sd for _, plane in mine)
        if sd > 0 and not (fan_has_scale and name == PLANE_TARGET):
            size: Source = "assumed known size" if any(plane.scale_assumed for _, plane in mine) else "known size"
            yield _displaced(camera, control, size, {number: -sd * plane.pi for number, plane in mine})


def _displaced(camera: Camera, control: Control, source: Source, steps: dict[int, Array]) -> Deviation:
    pis = control.plane_pis.copy()
    for number, step in steps.items():
        pis[number] += step
    return Deviation(source, camera, control.fan, pis)
