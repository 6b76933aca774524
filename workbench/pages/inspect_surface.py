"""The surface in 3D: points and mesh, what colours them, how uncertain they may be; picking and choosing regions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from PySide6.QtCore import QEvent, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import (
    QButtonGroup,
    QComboBox,
    QDoubleSpinBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from core.inspect.inspection import DEPTH
from core.report.wording import grouped
from workbench.pages import inspect_words as words
from workbench.pages.inspect_picks import Pick, Span
from workbench.pages.inspect_presenter import InspectPresenter, Stage
from workbench.theme import icon
from workbench.views.colours import FACE_LOWER, FACE_UPPER, to_colour
from workbench.views.scene_view import SceneView

if TYPE_CHECKING:
    from core.inspect.inspection import InspectionView, ShownMesh

PLAIN = "#8A96A3"
"""The surface where colour means nothing, and points that were not used."""

STEPS = 200
"""Of the slider from the smallest σ to the largest."""

MOST_MARKED = 100_000
"""So many of the points used are marked on a mesh; more would be no clearer."""

DRAW_WITHIN_MS = 60

Shape = Literal["points", "mesh", "both"]


class SurfaceTab(QWidget):
    """The 3D view with its choices above it and a line of words below."""

    notice = Signal(str)

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._face = ""
        self._drawn: tuple[object, ...] = ()
        self._marked: list[str] = []
        self._cloud: tuple[object, ...] = ()
        self._mesh: tuple[object, ...] = ()
        self._oriented = False
        self._picking = False
        self._later = QTimer(self)
        self._later.setSingleShot(True)
        self._later.setInterval(DRAW_WITHIN_MS)
        self._later.timeout.connect(self._draw)
        self.scene, self.line, self.hint = SceneView(), QLabel(), QLabel()
        self.shapes, self.colours, self.limit, self.slider = self._choices()
        for label in (self.line, self.hint):
            label.setObjectName("muted")
        self.hint.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        foot = QHBoxLayout()
        foot.addWidget(self.line)
        foot.addWidget(self.hint, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(6, 6, 6, 4)
        column.setSpacing(4)
        column.addLayout(self._bar())
        column.addWidget(self.scene, 1)
        column.addLayout(foot)
        self.scene.point_picked.connect(lambda point, _: presenter.picks.pick(point))
        self.scene.region_selected.connect(self._selected)
        self.scene.drawing_cancelled.connect(self._cancelled)
        self.scene.notice.connect(self.notice)
        presenter.measured.connect(lambda: self.choose_colour("faces"))

    def refresh(self) -> None:
        """Show what the presenter says now."""
        p, view = self._presenter, self._presenter.view
        for widget in (*self.shapes.values(), self.colours, self.limit, self.slider):
            widget.setEnabled(view is not None)
        if view is None:
            self._clear()
            return
        self._name_colours(view)
        self._show_limit(view)
        for name in ("mesh", "both"):
            self.shapes[name].setEnabled(view.mesh is not None)
        if view.mesh is None and self.shape != "points":
            self.shapes["points"].setChecked(True)
        if (p.serial, self.shape, self.colour, p.points_shown()) != self._drawn:
            if self._drawn[:1] != (p.serial,):
                self._draw()  # the first picture at once
            else:
                self._later.start()
        self._show_picks()
        self._show_words(view)

    @property
    def shape(self) -> Shape:
        """What is shown of the surface."""
        return next(name for name, button in self.shapes.items() if button.isChecked())

    @property
    def colour(self) -> str:
        """What colours it: "faces", "sigma", "height", "deviation", "frame", "plain"."""
        return str(self.colours.currentData())

    def choose_colour(self, name: str) -> None:
        """Colour by something else."""
        self.colours.setCurrentIndex(self.colours.findData(name))

    def start_region(self, face: str, kind: Literal["polygon", "lasso"]) -> None:
        """Let the user draw round the points of a face."""
        self._presenter.picks.stop()
        if kind == "polygon":
            self.scene.start_polygon()
        else:
            self.scene.start_lasso()
        self._face = face

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "shapes"):
            self._dress()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self.refresh()

    def hideEvent(self, event: QHideEvent) -> None:
        self._later.stop()
        super().hideEvent(event)

    # ---- making it

    def _choices(self) -> tuple[dict[Shape, QPushButton], QComboBox, QDoubleSpinBox, QSlider]:
        shapes: dict[Shape, QPushButton] = {}
        group = QButtonGroup(self)
        entries: tuple[tuple[Shape, str, str], ...] = (
            ("points", self.tr("Points"), self.tr("Show the measured points")),
            ("mesh", self.tr("Mesh"), self.tr("Show the triangulated surface")),
            ("both", self.tr("Both"), self.tr("Show the points on the triangulated surface")),
        )
        for name, text, tip in entries:
            button = QPushButton()
            button.setText(text)
            button.setToolTip(tip)
            button.setCheckable(True)
            group.addButton(button)
            shapes[name] = button
        shapes["points"].setChecked(True)
        group.buttonToggled.connect(lambda _, on: self.refresh() if on else None)
        colours = QComboBox()
        colours.setAccessibleName(self.tr("Colour by"))
        colours.setToolTip(self.tr("What the colours of the surface mean"))
        for name, text in (
            ("faces", self.tr("points used")),
            ("height", self.tr("height")),
            ("sigma", self.tr("σ of the points")),
            ("deviation", self.tr("deviation from face")),
            ("frame", self.tr("frame")),
            ("plain", self.tr("nothing (plain)")),
        ):
            colours.addItem(text, name)
        colours.setCurrentIndex(colours.findData("height"))
        colours.currentIndexChanged.connect(self.refresh)
        limit, slider = QDoubleSpinBox(), QSlider(Qt.Orientation.Horizontal)
        limit.setSuffix(" mm")
        limit.setKeyboardTracking(False)
        slider.setRange(1, STEPS)
        slider.setMinimumWidth(60)
        slider.setMaximumWidth(150)
        for widget in (limit, slider):
            widget.setAccessibleName(self.tr("Show points up to this σ"))
            widget.setToolTip(
                self.tr(
                    "Show points up to this standard uncertainty σ. Only what is seen changes: the thickness uses all "
                    "points of its faces."
                )
            )
        limit.valueChanged.connect(self._limited)
        slider.valueChanged.connect(self._slid)
        return shapes, colours, limit, slider

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setSpacing(4)
        for button in self.shapes.values():
            bar.addWidget(button)
        bar.addSpacing(8)
        colour, sigma = QLabel(self.tr("Colour")), QLabel(self.tr("σ up to"))
        colour.setBuddy(self.colours)
        sigma.setBuddy(self.limit)
        sigma.setToolTip(self.limit.toolTip())
        bar.addWidget(colour)
        bar.addWidget(self.colours)
        bar.addStretch(1)
        bar.addWidget(sigma)
        bar.addWidget(self.limit)
        bar.addWidget(self.slider, 1)
        self._dress()
        return bar

    def _dress(self) -> None:
        for name, symbol in (
            ("points", "mdi6.dots-hexagon"),
            ("mesh", "mdi6.triangle-outline"),
            ("both", "mdi6.vector-triangle"),
        ):
            self.shapes[name].setIcon(icon(symbol))  # type: ignore[index]

    # ---- showing it

    def _clear(self) -> None:
        p = self._presenter
        if p.stage is Stage.NO_SCAN:
            message = self.tr("There is no scan yet. Scan the part, then look at its surface here.")
        elif p.problem:
            message = p.problem
        else:
            message = self.tr("Reading the scan …")
        self._later.stop()
        self._drawn = self._cloud = self._mesh = ()
        self._marked, self._oriented = [], False
        self.scene.clear(message)
        self.line.setText("")
        self.hint.setText("")

    def _name_colours(self, view: InspectionView) -> None:
        """Without a lower face heights are depths, and there is nothing to colour by faces."""
        place = self.colours.findData("height")
        self.colours.setItemText(place, self.tr("depth") if view.height_is == DEPTH else self.tr("height"))
        model: Any = self.colours.model()
        for name in ("faces", "deviation"):
            model.item(self.colours.findData(name)).setEnabled(view.gauge is not None)
        if view.gauge is None and self.colour in ("faces", "deviation"):
            self.choose_colour("height")

    def _show_limit(self, view: InspectionView) -> None:
        largest = float(view.sigma[-1])
        for widget in (self.limit, self.slider):
            widget.blockSignals(True)
        self.limit.setDecimals(4 if largest < 0.1 else 3)
        self.limit.setRange(float(view.sigma[0]), _up(largest, self.limit.decimals()))
        self.limit.setSingleStep(10.0 ** -(self.limit.decimals() - 1))
        shown = self._presenter.clip_mm
        self.limit.setValue(self.limit.maximum() if shown is None else shown)
        self.slider.setValue(STEPS if shown is None else round(STEPS * shown / self.limit.maximum()))
        for widget in (self.limit, self.slider):
            widget.blockSignals(False)

    def _draw(self) -> None:
        """Send cloud and mesh to the 3D view as far as they changed; parts of arrays, so nothing large is copied."""
        p, view = self._presenter, self._presenter.view
        if view is None:
            return
        self._later.stop()
        count, seen = p.points_shown(), self.shape != "mesh"
        before, self._drawn = self._drawn, (p.serial, self.shape, self.colour, count)
        if view.gauge is not None and view.gauge.normal is not None and not self._oriented:
            self._oriented = True
            self.scene.set_orientation(-view.gauge.normal, (0.0, -1.0, 0.0))
        self.scene.show_cloud(seen)
        self.scene.show_mesh(self.shape != "points")
        cloud = (p.serial, count, self.colour if seen else "plain")
        if cloud != self._cloud:
            self._cloud = cloud
            self.scene.set_cloud(view.points[:count], keep_camera=bool(before), **self._look(view, count, cloud[2]))
        mesh = (p.serial, p.triangles_shown(), self.colour)
        if view.mesh is not None and self.shape != "points" and mesh != self._mesh:
            self._mesh = mesh
            self._draw_mesh(view, view.mesh)
        self._mark_used(view, count)

    def _draw_mesh(self, view: InspectionView, mesh: ShownMesh) -> None:
        name = self.colour
        look: dict[str, Any] = {"colour": PLAIN}
        if name in ("sigma", "height", "deviation"):
            look = {"values": getattr(mesh, name), **self._scale(view, name)}
        self.scene.set_mesh(mesh.vertices, mesh.triangles[: self._presenter.triangles_shown()], **look)

    def _look(self, view: InspectionView, count: int, name: str) -> dict[str, Any]:
        if name == "plain":
            return {"colours": PLAIN}
        if name == "faces":
            table = np.array(
                [to_colour(colour).getRgb()[:3] for colour in (PLAIN, FACE_UPPER, FACE_LOWER)], dtype=np.uint8
            )
            return {"colours": table[view.face[:count]]}
        return {"values": getattr(view, name)[:count], **self._scale(view, name)}

    def _scale(self, view: InspectionView, name: str) -> dict[str, Any]:
        titles = {
            "sigma": self.tr("σ of the depth"),
            "height": self.tr("depth") if view.height_is == DEPTH else self.tr("height over the lower face"),
            "deviation": self.tr("deviation from the face"),
            "frame": self.tr("frame number"),
        }
        maps = {"deviation": "deviation", "sigma": "plasma"}
        return {
            "value_name": titles[name],
            "unit": "" if name == "frame" else "mm",
            "limits": view.ranges[name],
            "colour_map": maps.get(name, "viridis"),
        }

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
                self.scene.set_labels("first", [(picks.first.place, self.tr("first end"))])
            self._marked = wanted
        if picks.mode and not self._picking:
            self.scene.start_picking()
            self._picking = True
        elif not picks.mode and self._picking:
            self._picking = False
            self.scene.stop_drawing()

    def _mark(self, item: Pick | Span) -> None:
        if isinstance(item, Pick):
            self.scene.set_labels(item.name, [(item.place, item.name)])
        else:
            self.scene.set_measure(item.name, item.a.place, item.b.place, words.span_label(item))

    # ---- what the user does

    def _limited(self, value: float) -> None:
        self._presenter.clip(None if value >= self.limit.maximum() else value)

    def _slid(self, step: int) -> None:
        self._presenter.clip(None if step >= STEPS else self.limit.maximum() * step / STEPS)

    def _selected(self, chosen: Any) -> None:
        face, self._face = self._face, ""
        if face:
            self._presenter.outline(face, chosen)

    def _cancelled(self) -> None:
        self._face = ""
        if self._picking:
            self._picking = False
            self._presenter.picks.stop()

    def _show_words(self, view: InspectionView) -> None:
        p = self._presenter
        shown = self.tr("{0} of {1} points shown").format(grouped(p.points_shown()), grouped(len(view)))
        if self.shape == "mesh":
            triangles = len(view.mesh.triangles) if view.mesh is not None else 0
            shown = self.tr("{0} of {1} triangles shown").format(grouped(p.triangles_shown()), grouped(triangles))
        if self.colour == "faces" and view.gauge is not None:
            upper, lower = (len(used) for used in view.used_up_to(p.points_shown()))
            shown += self.tr(": <span style='color:{0}'>●</span> {1} used on the upper face, ").format(
                FACE_UPPER, grouped(upper)
            ) + self.tr("<span style='color:{0}'>●</span> {1} on the lower").format(FACE_LOWER, grouped(lower))
        self.line.setText(shown)
        self.hint.setText(self.tr("Outlining …") if p.outlining else p.picks.hint())


def _up(value: float, decimals: int) -> float:
    """The next number of so many decimals that is not below `value`."""
    return float(np.ceil(round(value * 10**decimals, 6)) / 10**decimals)
