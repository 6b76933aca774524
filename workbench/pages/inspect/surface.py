"""The surface in 3D: points and mesh, what colours them, how uncertain they may be; picking and choosing regions."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QAction, QColor, QHideEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from core.inspect.shown.shown_scan import DEPTH
from core.model.arrays import Array
from core.report.wording import grouped
from workbench.language import tr
from workbench.pages.frame_tool import FrameTool
from workbench.pages.inspect import words
from workbench.pages.inspect.callouts import CalloutsTool
from workbench.pages.inspect.choices import Shape, SurfaceChoices
from workbench.pages.inspect.clicked import Mode
from workbench.pages.inspect.cut_panel import CutPanel
from workbench.pages.inspect.picks import Pick, Span
from workbench.pages.inspect.presenter import InspectPresenter
from workbench.pages.inspect.stage import Stage
from workbench.pages.words import wording
from workbench.refresh import Refresh
from workbench.views.colours import (
    DATUM,
    DEVIATIONS,
    FACE_LOWER,
    FACE_UPPER,
    FEATURE,
    NEXT_PAIR,
    NOMINAL_SURFACE,
    OTHER_SURFACE,
    PROPOSED,
    to_rgba,
)
from workbench.views.empty_state import EmptyState
from workbench.views.layouts import enable, in_column
from workbench.views.scene.colours import UNKNOWN
from workbench.views.scene.view import Colouring, SceneView
from workbench.wing import LayerOfWing

if TYPE_CHECKING:
    from core.inspect.shown.clicked_faces import ClickedFaces
    from core.inspect.shown.shown_features import ShownFeature
    from core.inspect.shown.shown_scan import InspectionView, NextPair, ShownMesh

PLAIN = "#8A96A3"
"""The surface where colour means nothing, and points that were not used."""

MOST_MARKED = 100_000
"""So many of the points used are marked on a mesh; more would be no clearer."""

GREY = QColor(*UNKNOWN).name()
"""The surface where a colour bar has no value for it."""

CUT = "cut"
"""Name of the plane that is laid through the surface."""

DATUMS = "datums"
"""Name of the letters that are written at them."""

NOMINAL = "nominal surface"
"""Name of its triangles."""

NOMINAL_OPACITY = 0.3
"""The part below it stays to be seen."""

CUT_OPACITY = 0.15
"""The surface behind it stays to be seen."""

NEXT_FACES = "next pair"
"""Name of the outlines of the faces that could be meant as well."""

DRAWN = "drawn region"
"""Name of the highlight of what was drawn round."""

PROPOSALS = ("proposed 1", "proposed 2")
"""Names of the highlights of faces that were clicked."""

LOW_PX = 480
"""Pixels of height below which surface and profile have no room one below the other."""

DRAW_WITHIN_MS = 60
"""How long in ms a change may wait to be drawn together with those that follow it, as of a slider that is moved."""


class SurfaceTab(QWidget):
    """Tab with the 3D view, its choices above it and a line of words below."""

    notice = Signal(str)

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._refreshing = Refresh(self.refresh, self)
        self._face = ""
        self._drawn: tuple[object, ...] = ()
        self._marked: list[str] = []
        self._feature: list[ShownFeature] = []
        self._highlights: list[str] = []
        self._cloud: tuple[object, ...] = ()
        self._mesh: tuple[object, ...] = ()
        self._cut: tuple[object, ...] = ()
        self._proposal: ClickedFaces | None = None
        self._beside: dict[str, NDArray[np.float32] | None] = {}
        self._nominal: ShownFeature | None = None
        self._next: NextPair | None = None
        self._region: tuple[Array, ...] = ()
        self._picking = ""
        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.setInterval(DRAW_WITHIN_MS)
        self._later.timeout.connect(self._draw)
        titles = {name: tr(layer.one.title) for name, layer in presenter.layers.items()}
        self.choices, self.scene, self.line, self.hint = SurfaceChoices(titles), SceneView(), QLabel(), QLabel()
        self.empty = EmptyState()
        """Stands in place of the view where there is no scan."""
        self.empty.hide()
        for label in (self.line, self.hint):
            label.setObjectName("muted")
        self.hint.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        foot = QHBoxLayout()
        self.line.setWordWrap(True)  # else a long legend would widen the page and narrow what is beside it
        foot.addWidget(self.line, 1)
        foot.addWidget(self.hint)
        self.cut = CutPanel(presenter.cut, self.scene)
        self.cut.hide()
        column = in_column(self.choices, (self.cut.views, 1), on=self, margins=(6, 6, 6, 4), spacing=4)
        column.addWidget(self.empty, 1)
        column.addWidget(self.cut)
        column.addLayout(foot)
        self.scene.point_picked.connect(lambda point, _: presenter.click(point))
        self.scene.taken.connect(presenter.clicked.take)
        self.scene.region_selected.connect(self._selected)
        self.scene.drawing_cancelled.connect(self._cancelled)
        self.scene.notice.connect(self.notice)
        self.choices.changed.connect(self.refresh)
        self.choices.limited.connect(presenter.clip)
        self.clicks: dict[Mode, QAction] = {
            "face": self.scene.add_tool(tr("Click a face to measure it"), "C", "mdi6.cursor-default-click-outline"),
            "step": self.scene.add_tool(
                tr("Click two faces to measure from one to the other"), "Shift+C", "mdi6.stairs"
            ),
        }
        self._tips = {mode: action.toolTip() for mode, action in self.clicks.items()}
        for mode, action in self.clicks.items():
            action.triggered.connect(lambda on, mode=mode: presenter.start_clicking(mode if on else ""))
        self.cutting = self.scene.add_tool(tr("Lay a plane through the surface and see the profile"), "X", "mdi6.knife")
        self._cutting_tip = self.cutting.toolTip()
        self.cutting.triggered.connect(presenter.cut.show)
        self.scene.handle_pulled.connect(presenter.cut.pull)
        presenter.cut.changed.connect(Refresh(self._show_moved_cut, self).soon)
        self.frame = FrameTool(self.scene, presenter.bench.settings)
        self.callouts = CalloutsTool(self.scene, presenter)
        self.nominal = self.scene.add_tool(tr("The nominal surface over the part"), "N", "mdi6.layers-outline")
        self._nominal_tip = self.nominal.toolTip()
        self.nominal.setChecked(presenter.bench.settings.nominal_shown)
        self.nominal.triggered.connect(self._choose_nominal)
        presenter.seen_from, presenter.is_put_back = self.scene.seen_from, self.scene.is_put_back
        presenter.measured.connect(self._show_faces)
        for name, layer in presenter.layers.items():
            layer.connect_made(partial(self._show_layer, name))

    def show_place(self, name: str) -> None:
        """Move the points of the feature called `name`, or of the thickness, to the middle of the view."""
        place = self.callouts.place_of(name)
        if place is not None:
            self.scene.look_at(place)

    def _show_layer(self, name: str) -> None:
        self.choices.show_layer(name, "")
        self.choices.choose_colour(name)

    def _show_faces(self) -> None:
        self.choices.choose_colour("faces")

    def refresh(self) -> None:
        """Show the scan in 3D with its colours, marks and choices, or a sentence if there is none."""
        p, view = self._presenter, self._presenter.scan.view
        self.choices.show_view(view, p.scan.buttons, p.clip_mm)
        for name, layer in p.layers.items():
            self.choices.show_layer(name, layer.why_not)
        self.choices.show_nominal(self._deviating() is not None)
        for mode, action in self.clicks.items():
            enable(action, p.scan.buttons.use, self._tips[mode])
        enable(self.cutting, p.scan.buttons.use, self._cutting_tip)
        self.frame.show(p.part_frame)
        if view is None:
            self._clear()
            return
        self._show_empty(False)
        if self._wanted() != self._drawn:
            if self._drawn[:1] != (p.scan.serial,):
                self._draw()  # the first picture at once
            else:
                self._later.start()
        self._show_feature()
        self.callouts.refresh()
        self._show_next_pair()
        self._show_beside()
        self._show_nominal()
        self._show_proposal()
        self._show_drawn()
        self._show_picks()
        self._show_tool()
        self._show_cut()
        self._show_words(view)

    @property
    def shape(self) -> Shape:
        """What is drawn of the surface: "points", "mesh" or "both"."""
        return self.choices.shape

    @property
    def colour(self) -> str:
        """What the surface is coloured by: "faces", "sigma", "height", "deviation", …."""
        return self.choices.colour

    def start_region(self, face: str, kind: Literal["polygon", "lasso"]) -> None:
        """Start drawing round points in 3D for the region of a face, by corners or by one stroke."""
        self._presenter.end_picking()
        if kind == "polygon":
            self.scene.start_polygon()
        else:
            self.scene.start_lasso()
        self._face = face

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._refreshing.soon()  # not now: Qt is in the middle of showing what would change

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self.cut.put_beside(self.height() < LOW_PX)

    def hideEvent(self, event: QHideEvent) -> None:
        self._later.stop()
        super().hideEvent(event)

    # ---- showing it

    def _clear(self) -> None:
        p = self._presenter
        if p.stage is Stage.NO_SCAN:
            said = tr("There is no scan yet. Scan the part, then look at its surface here.")
            self.empty.set_text(said, tr("Go to Scan"), lambda: p.go_to.emit("scan"))
        self._show_empty(p.stage is Stage.NO_SCAN)
        self._later.stop()
        self._drawn = self._cloud = self._mesh = self._cut = ()
        self._presenter.cut.show(False)
        self.cut.show_all(False)
        self.scene.set_handle(None)
        self.scene.hide_side(None)
        self._marked, self._feature, self._highlights = [], [], []
        self._proposal = self._nominal = self._next = None
        self._beside = {}
        self._region = ()
        self.frame.show(None)
        self.scene.clear(p.scan.problem or tr("Reading the scan …"))
        self.line.setText("")
        self.hint.setText("")

    def _show_empty(self, empty: bool) -> None:
        self.empty.setVisible(empty)
        self.scene.setHidden(empty)

    def _draw(self) -> None:
        """Send cloud and mesh to the 3D view as far as they changed; parts of arrays, so nothing large is copied."""
        p, view = self._presenter, self._presenter.scan.view
        if view is None:
            return
        self._later.stop()
        count, seen = p.points_shown(), self.shape != "mesh"
        before, self._drawn = self._drawn, self._wanted()
        self.scene.show_cloud(seen)
        self.scene.show_mesh(self.shape != "points")
        colour = self.colour if seen else "plain"
        cloud = (p.scan.serial, count, colour, self._other_look(colour))
        if cloud != self._cloud:
            self._cloud = cloud
            self.scene.set_cloud(
                view.points[:count],
                normals=view.normals[:count],
                keep_camera=bool(before),
                **self._look(view, count, colour),
            )
        mesh = (p.scan.serial, p.triangles_shown(), self.colour, self._other_look(self.colour))
        if view.mesh is not None and self.shape != "points" and mesh != self._mesh:
            self._mesh = mesh
            self._draw_mesh(view, view.mesh)
        self._mark_used(view, count)

    def _wanted(self) -> tuple[object, ...]:
        """What the picture of cloud and mesh hangs on."""
        p = self._presenter
        return p.scan.serial, self.shape, self.colour, p.points_shown(), self._other_look(self.colour)

    def _other_look(self, colour: str) -> tuple[object, ...]:
        """What the colours hang on where they are not of the scan alone."""
        if colour == "nominal":
            return (self._deviating(),)
        layer = self._presenter.layers.get(colour)
        return () if layer is None else (layer.coloured,)

    def _deviating(self) -> ShownFeature | None:
        """What of the chosen feature was compared with a nominal surface; None if nothing was."""
        features = self._presenter.features
        own, _ = features.rests_on(features.chosen)
        return next((one for one in own if one.deviations is not None), None)

    def _draw_mesh(self, view: InspectionView, mesh: ShownMesh) -> None:
        name, layer = self.colour, self._presenter.layers.get(self.colour)
        look: dict[str, Any] = {"colour": PLAIN}
        if layer is not None:
            look = _coloured(layer, layer.at_vertices(len(mesh.vertices))) or look
        if name == "nominal":
            look = {"values": np.full(len(mesh.vertices), np.nan, np.float32), "colouring": self._nominal_colouring()}
        if name in ("sigma", "height", "deviation"):
            look = {"values": getattr(mesh, name), "colouring": self._colouring(view, name)}
        self.scene.set_mesh(mesh.vertices, mesh.triangles[: self._presenter.triangles_shown()], **look)

    def _look(self, view: InspectionView, count: int, name: str) -> dict[str, Any]:
        layer = self._presenter.layers.get(name)
        if layer is not None:  # where it is there no more it has just been taken away
            return _coloured(layer, layer.at_points(view.number[:count])) or {"colours": PLAIN}
        if name == "plain":
            return {"colours": PLAIN}
        if name == "nominal":  # what was compared is marked over it, the rest is grey
            return {"values": np.full(count, np.nan, np.float32), "colouring": self._nominal_colouring()}
        if name == "faces":
            table = np.array([to_rgba(colour)[:3] for colour in (PLAIN, FACE_UPPER, FACE_LOWER)], dtype=np.uint8)
            return {"colours": table[view.face[:count]]}
        return {"values": getattr(view, name)[:count], "colouring": self._colouring(view, name)}

    def _nominal_colouring(self) -> Colouring:
        """Classes are quarters of the tolerance, those at the ends are of all beyond it."""
        feature = self._deviating()
        assert feature is not None and feature.deviations is not None
        deviation = self._presenter.features.plan.feature(feature.name).deviation
        assert deviation is not None  # else nothing was compared
        end = 1.25 * feature.deviations.tolerance_mm
        title = tr("deviation from {other}", other=Path(deviation.nominal).name)
        return Colouring(title, "mm", (-end, end), "classes")

    def _colouring(self, view: InspectionView, name: str) -> Colouring:
        titles = {
            "sigma": tr("σ of the depth"),
            "height": tr("depth") if view.height_is == DEPTH else tr("height over the lower face"),
            "deviation": tr("deviation from the face"),
            "frame": tr("frame number"),
        }
        return Colouring(
            titles[name],
            unit="" if name == "frame" else "mm",
            limits=view.ranges[name],
            colour_map="deviation" if name == "deviation" else "viridis",
        )

    def _mark_used(self, view: InspectionView, count: int) -> None:
        """Points used, on a mesh, which has no colours of its own for them."""
        if self.colour != "faces" or self.shape != "mesh":
            for name in ("used upper", "used lower"):
                self.scene.remove_highlight(name)
            return
        for name, used, colour in zip(
            ("used upper", "used lower"), view.used_up_to(count), (FACE_UPPER, FACE_LOWER), strict=True
        ):
            step = max(1, -(-len(used) // MOST_MARKED))
            self.scene.set_highlight(name, view.points[used[::step]], colour)

    def _show_feature(self) -> None:
        """The points that the chosen feature used, or its parts, and those of its datums, over whatever colours all."""
        own, datums = self._presenter.features.rests_on(self._presenter.features.chosen)
        classes = self.colour == "nominal"
        marked = [one for one in own if classes or one.deviations is None]
        drawn = [*marked, *(one for some in datums.values() for one in some)]
        if [id(one) for one in drawn] == [id(one) for one in self._feature]:
            return
        self._feature = drawn
        for name in self._highlights:
            self.scene.remove_highlight(name)
        self._highlights = []
        self.scene.remove(DATUMS)
        for one in (one for result in marked if result.deviations is not None for one in result.deviations.classes):
            self._highlight(f"deviation {one.number}", one.places, DEVIATIONS[one.number + len(DEVIATIONS) // 2])
        self._highlight("feature", _places(one for one in marked if one.deviations is None), FEATURE)
        labels = []
        for letter, some in datums.items():
            places = _places(some)
            self._highlight(f"datum {letter}", places, DATUM)
            if len(places):
                middle = np.linalg.norm(places - places.mean(axis=0), axis=1).argmin()
                labels.append((places[middle], letter))
        if labels:
            self.scene.set_labels(DATUMS, labels)

    def _show_next_pair(self) -> None:
        """The next best of several pairs of faces, until one is confirmed."""
        pair = self._presenter.faces.next_pair
        if pair is self._next:
            return
        self._next = pair
        if pair is None:
            self.scene.remove(NEXT_FACES)
        else:
            lines = [outline[[*range(len(outline)), 0]] for outline in pair.outlines]
            self.scene.set_polylines(NEXT_FACES, lines, NEXT_PAIR)

    def _show_beside(self) -> None:
        """Points that layers show beside the surface."""
        for name, layer in self._presenter.layers.items():
            points = layer.beside
            if points is self._beside.get(name):
                continue
            self._beside[name] = points
            if points is None:
                self.scene.remove_highlight(name)
            else:
                self.scene.set_highlight(name, points, OTHER_SURFACE)

    def _choose_nominal(self, wanted: bool) -> None:
        self._presenter.bench.settings.nominal_shown = wanted
        self._show_nominal()

    def _show_nominal(self) -> None:
        """The surface that the chosen feature was compared with, as it was aligned, over the part."""
        found = self._deviating()
        why_not = tr("Choose a deviation from a nominal surface in the list of features.") if found is None else ""
        enable(self.nominal, why_not, self._nominal_tip)
        shown = found if self._presenter.bench.settings.nominal_shown else None
        if shown is self._nominal:
            return
        self._nominal = shown
        if shown is None or shown.deviations is None:
            self.scene.remove(NOMINAL)
        else:
            self.scene.set_surface(NOMINAL, shown.deviations.nominal, NOMINAL_SURFACE, NOMINAL_OPACITY)

    def _show_proposal(self) -> None:
        """The faces that were clicked and are not taken yet."""
        proposal = self._presenter.clicked.proposal
        if proposal is self._proposal:
            return
        self._proposal = proposal
        for name in PROPOSALS:
            self.scene.remove_highlight(name)
        for name, face in zip(PROPOSALS, () if proposal is None else proposal.faces, strict=False):
            self.scene.set_highlight(name, face.places, PROPOSED)

    def _show_drawn(self) -> None:
        """The points that were drawn round, until there is a result of them."""
        places = self._presenter.drawn.places
        if [id(one) for one in places] == [id(one) for one in self._region]:
            return
        self._region = places
        if places:
            self.scene.set_highlight(DRAWN, np.concatenate(places), PROPOSED)
        else:
            self.scene.remove_highlight(DRAWN)

    def _grey(self) -> list[str]:
        """What is grey beside the colours of the bar."""
        if self.colour == "nominal":
            return [_dot(GREY, tr("not compared"))]
        layer = self._presenter.layers.get(self.colour)
        coloured = None if layer is None else layer.coloured
        return [] if coloured is None or not coloured.grey else [_dot(GREY, escape(coloured.grey))]

    def _legend(self) -> list[str]:
        """What the colours of the chosen feature mean, each with its sign; nothing where none is to be seen."""
        features = self._presenter.features
        own, datums = features.rests_on(features.chosen)
        if self._deviating() is not None or not any(one.used for one in own):
            return []
        used = [_dot(FEATURE, tr("used for {name}", name=escape(features.chosen)))]
        datum = [_dot(DATUM, tr("datum {letter}", letter=one)) for one in datums]
        return [wording().joined(used + datum)]

    def _highlight(self, name: str, places: Any, colour: str) -> None:
        if len(places):
            self.scene.set_highlight(name, places, colour)
            self._highlights.append(name)

    def _show_moved_cut(self) -> None:
        """The cut alone, and how much it leaves to be seen: nothing else changes as it is moved."""
        self._show_cut()
        view = self._presenter.scan.view
        if view is not None:
            self._show_words(view)

    def _show_cut(self) -> None:
        """The plane that is laid through the surface, and its profile."""
        plane, count = self._presenter.cut.plane, self._presenter.points_shown()
        self.cutting.setChecked(plane is not None)
        self.cut.show_all(plane is not None)
        self.cut.show_keep()
        if (plane, count, self._presenter.cut.hides) == self._cut:
            return
        self._cut = (plane, count, self._presenter.cut.hides)
        self.scene.hide_side(self._presenter.cut.clip)
        if plane is None:
            self.scene.remove(CUT)
            self.scene.set_handle(None)
            return
        corners = self._presenter.cut.corners()
        self.scene.set_planes(CUT, [corners], PROPOSED, CUT_OPACITY)
        self.scene.set_polylines(CUT, [corners[[0, 1, 2, 3, 0]]], PROPOSED)
        self.scene.set_handle((corners[2:].mean(axis=0), plane.normal))
        self.cut.refresh(count)

    # ---- picks

    def _show_picks(self) -> None:
        picks = self._presenter.picks
        wanted = [item.name for item in picks.items] + (["first"] if picks.first is not None else [])
        if wanted != self._marked:
            for name in set(self._marked) - set(wanted):
                self.scene.remove(name)
            for item in picks.items:
                if item.name not in self._marked:
                    self._mark(item)
            if picks.first is not None:
                self.scene.set_labels("first", [(picks.first.place, tr("first end"))])
            self._marked = wanted

    def _show_tool(self) -> None:
        """Let clicks pick points or faces, or nothing any more."""
        clicked = self._presenter.clicked
        for mode, action in self.clicks.items():
            action.setChecked(clicked.mode == mode)
        wanted = "faces" if clicked.mode else "points" if self._presenter.picks.mode else ""
        if wanted != self._picking:
            self._picking = ""  # what ends now is not ended by the user
            if wanted:
                self.scene.start_picking()
            else:
                self.scene.stop_drawing()
            self._picking = wanted
        if wanted == "faces":
            self.scene.set_hint(clicked.hint())

    def _mark(self, item: Pick | Span) -> None:
        if isinstance(item, Pick):
            self.scene.set_labels(item.name, [(item.place, item.name)])
        else:
            self.scene.set_measure(item.name, item.a.place, item.b.place, words.span_label(item))

    # ---- what the user does

    def _selected(self, chosen: Any) -> None:
        face, self._face = self._face, ""
        if face:
            self._presenter.outline(face, chosen)

    def _cancelled(self) -> None:
        self._face = ""
        if self._picking:
            self._picking = ""
            self._presenter.end_picking()

    def _show_words(self, view: InspectionView) -> None:
        p = self._presenter
        points = p.cut.count_shown(view.points[: p.points_shown()])
        shown = tr("{shown} of {total} points shown", shown=grouped(points), total=grouped(len(view)))
        if self.shape == "mesh":
            seen, triangles = 0, 0
            if view.mesh is not None:
                seen = p.cut.count_shown(view.mesh.vertices, view.mesh.triangles[: p.triangles_shown()])
                triangles = len(view.mesh.triangles)
            shown = tr("{shown} of {total} triangles shown", shown=grouped(seen), total=grouped(triangles))
        if self.colour == "faces" and view.gauge is not None:
            upper, lower = (p.cut.count_shown(view.points[used]) for used in view.used_up_to(p.points_shown()))
            shown += tr(
                ": {upper} used on the upper face, {lower} on the lower",
                upper=_dot(FACE_UPPER, grouped(upper)),
                lower=_dot(FACE_LOWER, grouped(lower)),
            )
        self.line.setText(wording().joined([shown, *self._grey(), *self._legend()], ";"))
        self.hint.setText(tr("Outlining …") if p.outlining else p.picks.hint())


def _places(features: Iterable[ShownFeature]) -> NDArray[np.float32]:
    """Points (N, 3) in mm of all of them."""
    return np.concatenate([np.zeros((0, 3), np.float32), *(one.places for one in features)])


def _coloured(layer: LayerOfWing, values: NDArray[np.float32] | None) -> dict[str, Any]:
    """How a layer's values are drawn; nothing where there are none."""
    coloured = layer.coloured
    if coloured is None or values is None:
        return {}
    ends = -coloured.end_mm, coloured.end_mm
    return {"values": values, "colouring": Colouring(coloured.title, "mm", ends, "deviation")}


def _dot(colour: str, text: str) -> str:
    """A text of a legend, with its colour before it."""
    return f"<span style='color:{colour}'>●</span>&nbsp;{text}"
