"""A picture with layers of points, lines and regions over it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from workbench.views.colours import ColourLike, Symbol


class ImageView(QWidget):
    """Shows one picture; layers lie over it by name, in the coordinates of the full-resolution picture.

    The centre of the first pixel is (0, 0). Setting a layer replaces the one of that name; `title` puts it into the
    legend and the layers menu.
    """

    polygon_drawn = Signal(str, object)
    """Name, corners (N, 2) in pixels; a lasso as well."""

    polygon_edited = Signal(str, object)
    """Name, corners (N, 2) in pixels, when a corner or the whole has been dragged."""

    drawing_cancelled = Signal(str)
    """Name of what was not drawn: Esc, or `stop_drawing`."""

    point_clicked = Signal(str, int)
    """Layer and index of the point."""

    def set_picture(
        self,
        picture: ArrayLike,
        *,
        keep_view: bool = True,
        scale: float = 1.0,
        levels: tuple[float, float] | None = None,
    ) -> None:
        """Show a picture (rows, columns) of uint8, uint16, float or bool, or (rows, columns, 3) of uint8.

        `scale` is how many full-resolution pixels one pixel of a reduced picture is wide. `levels` are the values of
        black and white; by default those of the type, of the camera's bits, or of the values of a float picture.
        """

    def clear(self, message: str = "", button: str = "", on_button: Callable[[], None] | None = None) -> None:
        """Show no picture and no layer but a sentence in the middle, with a button if one is named."""

    def set_points(
        self,
        name: str,
        uv: ArrayLike,
        *,
        colour: ColourLike | ArrayLike,
        symbol: Symbol = "o",
        size: float = 8,
        tips: Sequence[str] | None = None,
        title: str = "",
    ) -> None:
        """Points (N, 2); `colour` for all or (N, 3 or 4) uint8; `size` in screen pixels; `tips` show on hover."""

    def set_lines(
        self,
        name: str,
        lines: Sequence[ArrayLike],
        *,
        colour: ColourLike | None = None,
        colours: Sequence[ColourLike] | None = None,
        values: Sequence[ArrayLike] | None = None,
        limits: tuple[float, float] = (0.0, 1.0),
        width: float = 1.5,
        labels: Sequence[str] | None = None,
        title: str = "",
    ) -> None:
        """Lines, each (N, 2): one colour for all, one each, or by a value at each point.

        `values` are coloured as σ between `limits`; beyond them and NaN are grey. NaN in a line leaves a gap.
        """

    def set_vectors(
        self, name: str, uv: ArrayLike, d_uv: ArrayLike, *, factor: float, colour: ColourLike = "", title: str = ""
    ) -> None:
        """Arrows from uv (N, 2) to uv + factor · d_uv."""

    def set_cells(self, name: str, grid: ArrayLike, colour: ColourLike = "", *, title: str = "") -> None:
        """Tint the cells of a grid (rows, columns) over the whole picture where it is True."""

    def set_text(self, name: str, texts: Sequence[tuple[float, float, str]], *, colour: ColourLike = "") -> None:
        """Texts (u, v, text), centred there."""

    def set_polygon(
        self, name: str, uv: ArrayLike, *, editable: bool = False, colour: ColourLike = "", title: str = ""
    ) -> None:
        """A closed region (N, 2); with `editable` its corners can be dragged."""

    def remove_layer(self, name: str) -> None:
        """Take a layer away; none of that name is no error."""

    def set_layer_visible(self, name: str, visible: bool) -> None:
        """Show or hide a layer; remembered for the name, also while there is no such layer."""

    def clear_layers(self) -> None:
        """Take all layers away."""

    def layer_names(self) -> tuple[str, ...]:
        """The layers there are."""
        return ()

    def set_legend_visible(self, visible: bool) -> None:
        """Show or hide the key of colours and symbols."""

    def start_polygon(self, name: str) -> None:
        """Let the user draw: click corners; double-click or Enter closes, Backspace takes one back, Esc cancels."""

    def start_lasso(self, name: str) -> None:
        """Let the user draw round a region with the button held down."""

    def stop_drawing(self) -> None:
        """End drawing without a result."""

    def fit(self) -> None:
        """Show the whole picture."""

    def one_to_one(self) -> None:
        """One pixel of the picture on one of the screen."""

    def centre_on(self, u: float, v: float) -> None:
        """Bring a place into the middle."""

    def add_tool(self, widget: QWidget) -> None:
        """A page's own widget in the strip under the picture."""
