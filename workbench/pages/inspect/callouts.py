"""Results at their places on the surface: a plate for each feature, which may be dragged; a button hides them all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject

from core.report.wording import shown_name, with_uncertainty
from workbench.language import number, tr
from workbench.pages.inspect.features import words
from workbench.pages.inspect.features.plan import THICKNESS
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.words import wording
from workbench.views.lists.value_rows import VERDICT_ICONS
from workbench.views.scene.contents import Callout
from workbench.views.scene.view import SceneView

if TYPE_CHECKING:
    from core.inspect.results import GaugeResult
    from core.inspect.shown.shown_features import ShownFeature
    from core.inspect.shown.shown_scan import InspectionView
    from core.model.arrays import Array

MOST = 10
"""So many are shown, as in the report: more would hide the surface."""

OUTDATED = ("mdi6.clock-outline", "muted")
"""Sign of a value that is no longer true, as in the list."""

NEXT_PAIR = "#next pair"
"""Name of the callout of the next best pair of faces, which was not measured."""


class CalloutsTool(QObject):
    """Tool that puts the worst result of each feature over a 3D view."""

    def __init__(self, scene: SceneView, presenter: InspectPresenter) -> None:
        super().__init__(scene)
        self._scene, self._presenter = scene, presenter
        self._places: dict[str, tuple[tuple[ShownFeature, ...], Array]] = {}
        self._serial: object = None
        self.action = scene.add_tool(tr("Results at their places on the surface"), "V", "mdi6.tooltip-text-outline")
        self.action.setChecked(presenter.bench.settings.callouts)
        self.action.triggered.connect(self._choose)
        scene.callout_moved.connect(presenter.features.move_callout)
        scene.callout_chosen.connect(self._chosen)

    def refresh(self) -> None:
        """Show the callouts of the results over the surface, or none if they are switched off."""
        view = self._presenter.scan.view
        shown = self._presenter.bench.settings.callouts and view is not None
        self._scene.set_callouts(list(self._callouts(view)) if shown and view is not None else [])

    def _callouts(self, view: InspectionView) -> Iterator[Callout]:
        features, serial = self._presenter.features, self._presenter.scan.serial
        if serial != self._serial:
            self._serial, self._places = serial, {}
        worst = []
        for name in features.plan.names:
            outdated = features.outdated(name)
            result = outdated or features.result(name)
            if result is None or not result.rows:
                continue
            place = self._place(name, result)
            if place is not None:
                row = min(result.rows, key=lambda one: one.room)
                worst.append((row.room, name != features.chosen, name, row, place, outdated is not None))
        kept = {one[2] for one in sorted(worst, key=lambda one: (one[1], one[0]))[:MOST]}
        for _, _, name, row, place, old in worst:
            if name in kept:
                sign = OUTDATED if old else VERDICT_ICONS[row.verdict] if row.verdict else None
                yield self._callout(name, place, shown_name(row, wording()), words.value(row), sign)
        gauge = view.gauge
        if gauge is not None and len(gauge.upper.indices) and not any(one[3].kind == "thickness" for one in worst):
            value, uncertainty = with_uncertainty(gauge.thickness_mm, gauge.U_mm, wording())
            sign = VERDICT_ICONS[gauge.verdict] if gauge.verdict else None
            sign = OUTDATED if self._presenter.scan.is_thickness_old else sign
            yield self._callout(
                THICKNESS, _of_thickness(view, gauge), tr("Thickness"), f"{value} ± {uncertainty} mm", sign
            )
        pair = self._presenter.faces.next_pair
        if pair is not None:
            value = f"{number(pair.thickness_mm, '.1f')} mm"
            yield self._callout(NEXT_PAIR, _middle(pair.outlines[0]), tr("next best pair"), value, None)

    def _callout(self, name: str, place: Array, title: str, value: str, sign: tuple[str, str] | None) -> Callout:
        moved = self._presenter.features.callouts_moved.get(name)
        return Callout(name, place, title, value, sign, outdated=sign == OUTDATED, moved=moved)

    def _place(self, name: str, result: ShownFeature) -> Array | None:
        """The point of what it is measured on that is nearest to its middle; None if no points are known."""
        sources = (result,) if len(result.places) else tuple(self._presenter.features.rests_on(name)[0])
        sources = tuple(one for one in sources if len(one.places))
        known = self._places.get(name)
        if sources and (known is None or known[0] != sources):
            known = self._places[name] = (sources, _middle(np.concatenate([one.places for one in sources])))
        return None if known is None else known[1]  # where it was, while what it rests on is measured again

    def _choose(self, wanted: bool) -> None:
        self._presenter.bench.settings.callouts = wanted
        self.refresh()

    def _chosen(self, name: str) -> None:
        self._presenter.features.choose(name)

    def place_of(self, name: str) -> Array | None:
        """Return the place (3,) in mm of the callout of a feature, or of the thickness; None if not known."""
        view, features = self._presenter.scan.view, self._presenter.features
        if name == THICKNESS:
            return None if view is None or view.gauge is None else _of_thickness(view, view.gauge)
        result = features.outdated(name) or features.result(name)
        return None if result is None else self._place(name, result)


def _of_thickness(view: InspectionView, gauge: GaugeResult) -> Array:
    """The middle of the upper face."""
    return _middle(view.points[gauge.upper.indices])


def _middle(places: Array) -> Array:
    """Of points (N, 3), the one nearest to their mean."""
    nearest: Array = places[((places - places.mean(axis=0)) ** 2).sum(axis=1).argmin()].astype(float)
    return nearest
