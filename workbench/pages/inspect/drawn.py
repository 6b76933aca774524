"""What was drawn round in 3D, marked until something is measured there or it is dropped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from core.inspect.plan.feature_spec import Polygon
from core.model.arrays import Array
from workbench.pages.inspect.faces import FACES, InspectFaces
from workbench.pages.inspect.features.edit import InspectFeatureEdit
from workbench.pages.inspect.features.plan import InspectFeatures


@dataclass(frozen=True, eq=False, slots=True)
class _Drawn:
    """Points (N, 3) in mm that were drawn round, and the corners (n, 2) in pixels of the region they became."""

    places: Array
    corners: Array | None = None


class InspectDrawn:
    """Points drawn round, by the feature ("" of the thickness) and the region's name.

    They stay while their outline is worked out, and after that until there is a result of the region, or the feature
    has another one. `thickness_measured` says whether the thickness shown is of the regions in force.
    """

    def __init__(
        self,
        faces: InspectFaces,
        features: InspectFeatures,
        edit: InspectFeatureEdit,
        thickness_measured: Callable[[], bool],
    ) -> None:
        self._faces, self._features, self._edit = faces, features, edit
        self._thickness_measured = thickness_measured
        self._all: dict[tuple[str, str], _Drawn] = {}

    def begin(self, feature: str, name: str, places: Array) -> None:
        """Store `places`, the points that were drawn round in 3D for a region, to be marked."""
        self._all[feature, name] = _Drawn(places)

    def outlined(self, feature: str, name: str, corners: Array) -> None:
        """Store the polygon `corners` that the points drawn round were turned into."""
        if (feature, name) in self._all:
            self._all[feature, name] = _Drawn(self._all[feature, name].places, corners)

    def end_outlining(self) -> None:
        """Drop the points drawn round that were not turned into a polygon."""
        self._all = {key: one for key, one in self._all.items() if one.corners is not None}

    def forget(self) -> None:
        """Drop all points drawn round, as another scan is shown."""
        self._all = {}

    @property
    def places(self) -> tuple[Array, ...]:
        """Points (N, 3) of each region drawn round that is to be marked."""
        self._all = {key: one for key, one in self._all.items() if self._counts(*key, one)}
        return tuple(one.places for (feature, _), one in self._all.items() if feature in ("", self._features.chosen))

    def _counts(self, feature: str, name: str, one: _Drawn) -> bool:
        if one.corners is None:
            return True
        if name in FACES:
            region = self._faces.region(name)
            return region is not None and _same(region, one.corners) and not self._thickness_measured()
        if feature not in self._features.plan.names or self._features.result(feature) is not None:
            return False
        regions, place = self._features.plan.feature(feature).regions, self._edit.place_of(name)
        region_of = regions[place] if place < len(regions) else None
        return isinstance(region_of, Polygon) and _same(np.asarray(region_of.corners_px), one.corners)


def _same(region: Array, corners: Array) -> bool:
    """Regions of faces are kept to a tenth of a pixel."""
    return region.shape == corners.shape and bool(np.allclose(region, corners, atol=0.06))
