"""The layers of a picture by name: which there are, which are shown, what the mouse meets."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QObject, Signal

from workbench.views.colours import ColourLike, KeySign
from workbench.views.overlay_areas import Grip, PolygonLayer
from workbench.views.overlays import Layer
from workbench.views.picture_box import PictureBox


class LayerStack(QObject):
    """Layers in the order they first came; a layer set anew takes the place of the one of its name."""

    changed = Signal()

    def __init__(self, box: PictureBox, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._box = box
        self._layers: dict[str, Layer] = {}
        self._order: dict[str, int] = {}
        self._hidden: set[str] = set()

    def __getitem__(self, name: str) -> Layer:
        return self._layers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._layers, key=self._order.__getitem__))

    def put(self, name: str, layer: Layer) -> None:
        """Show a layer instead of the one of that name."""
        if (old := self._layers.pop(name, None)) is not None:
            self._box.removeItem(old)
        self._layers[name] = layer
        self._box.addItem(layer, ignoreBounds=True)
        layer.setZValue(10 + self._order.setdefault(name, len(self._order)))
        layer.setVisible(name not in self._hidden)
        self.changed.emit()

    def remove(self, name: str) -> None:
        """Take a layer away; none of that name is no error."""
        if (layer := self._layers.pop(name, None)) is not None:
            self._box.removeItem(layer)
            self.changed.emit()

    def clear(self) -> None:
        """Take all layers away; which are hidden stays known."""
        for layer in self._layers.values():
            self._box.removeItem(layer)
        self._layers = {}
        self.changed.emit()

    def set_visible(self, name: str, visible: bool) -> None:
        """Show or hide a layer, now and when it is set anew."""
        (self._hidden.discard if visible else self._hidden.add)(name)
        if name in self._layers:
            self._layers[name].setVisible(visible)
        self.changed.emit()

    def is_visible(self, name: str) -> bool:
        """Whether a layer is to be shown."""
        return name not in self._hidden

    def legend(self) -> list[tuple[str, KeySign, ColourLike]]:
        """Title, sign and colour of the layers shown that have a title."""
        shown = (self._layers[name] for name in self if self.is_visible(name))
        return [(layer.title, *layer.key) for layer in shown if layer.title]

    def point_at(self, u: float, v: float) -> tuple[str, int] | None:
        """The topmost layer with a point at (u, v), and the point's number."""
        for name in reversed(list(self)):
            if self.is_visible(name):
                index = self._layers[name].point_at(u, v, self._box.pixel)
                if index is not None:
                    return name, index
        return None

    def tip_at(self, u: float, v: float) -> str:
        """What the topmost point there that has something to say says."""
        for name in reversed(list(self)):
            layer = self._layers[name]
            index = layer.point_at(u, v, self._box.pixel) if self.is_visible(name) else None
            if index is not None and (tip := layer.tip(index)):
                return tip
        return ""

    def grip_at(self, u: float, v: float) -> tuple[str, Grip] | None:
        """The editable region that can be dragged from there, and by what."""
        for name in reversed(list(self)):
            layer = self._layers[name]
            if isinstance(layer, PolygonLayer) and self.is_visible(name):
                grip = layer.grip_at(u, v, self._box.pixel)
                if grip is not None:
                    return name, grip
        return None
