"""The picture with the two faces on it: the surface as the camera sees it, the reference, or a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from PySide6.QtWidgets import QLabel, QWidget

from core.inspect.plan.feature_spec import FaceAt, Polygon
from workbench.language import number, tr
from workbench.pages.inspect.faces import FACES
from workbench.pages.inspect.features.edit import LINE
from workbench.pages.inspect.presenter import RELIEF, InspectPresenter
from workbench.pages.inspect.stage import Stage
from workbench.views.colours import FACE_LOWER, FACE_UPPER, FEATURE, NEXT_PAIR
from workbench.views.common import Choice
from workbench.views.image.view import ImageView
from workbench.views.layouts import in_column, in_row, muted

if TYPE_CHECKING:
    from core.inspect.shown.shown_scan import InspectionView

USED = "feature points"
"""The layer of the points that the chosen feature used."""

COLOURS = {"upper": FACE_UPPER, "lower": FACE_LOWER}


class PictureTab(QWidget):
    """Tab with a picture on which regions are drawn and dragged."""

    def __init__(self, presenter: InspectPresenter, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._presenter = presenter
        self._shown: tuple[object, ...] = ()
        self._laid: tuple[object, ...] = ()
        self._feature: tuple[object, ...] = ()
        self._regions = 0
        self.image, self.pictures, self.line = ImageView(), Choice(), muted()
        self.pictures.setSizeAdjustPolicy(Choice.SizeAdjustPolicy.AdjustToContents)  # more come when there is a scan
        self.pictures.setAccessibleName(tr("Picture"))
        self.pictures.setToolTip(tr("The surface as the camera sees it, or a picture of the recording"))
        self.pictures.setMinimumContentsLength(22)
        label = QLabel(tr("Picture"))
        label.setBuddy(self.pictures)
        bar = in_row(label, self.pictures, (self.line, 1))
        in_column(bar, (self.image, 1), on=self, margins=(6, 6, 6, 4), spacing=4)
        self.pictures.activated.connect(lambda _: presenter.choose_picture(str(self.pictures.currentData())))
        self.image.polygon_drawn.connect(presenter.set_region)
        self.image.polygon_edited.connect(presenter.set_region)
        presenter.picture_ready.connect(self._show_picture)

    def refresh(self) -> None:
        """Show the chosen picture with the regions and points of the faces on it."""
        p, view = self._presenter, self._presenter.scan.view
        self.pictures.setEnabled(view is not None)
        if view is None:
            self._clear()
            return
        self._list_pictures(view)
        if p.picture == RELIEF and self._shown != (p.scan.serial, RELIEF):
            self._shown = (p.scan.serial, RELIEF)
            self.image.set_picture(view.relief.picture, scale=view.relief.cell_px)
        self._lay_faces(view)
        self._lay_feature()
        self.line.setText(self._words())

    def start_region(self, face: str, kind: Literal["polygon", "lasso"]) -> None:
        """Start drawing the region of a face on the picture, by its corners or by one stroke."""
        if kind == "polygon":
            self.image.start_polygon(face)
        else:
            self.image.start_lasso(face)

    def _show_picture(self, name: str, picture: Any) -> None:
        view = self._presenter.scan.view
        serial = self._presenter.scan.serial
        if view is None or self._shown == (serial, name):
            return
        self._shown = (serial, name)
        self.image.set_picture(picture)

    def _clear(self) -> None:
        p = self._presenter
        if p.stage is Stage.NO_SCAN:
            message = tr("There is no scan yet. Scan the part, then mark its faces here.")
        else:
            message = p.scan.problem or tr("Reading the scan …")
        button = tr("Go to Scan") if p.stage is Stage.NO_SCAN else ""
        self._shown = self._laid = self._feature = ()
        self.image.clear(message, button, lambda: p.go_to.emit("scan"))
        self.line.setText("")

    def _list_pictures(self, view: InspectionView) -> None:
        names = [RELIEF, *view.pictures]
        if [self.pictures.itemData(row) for row in range(self.pictures.count())] != names:
            self.pictures.clear()
            self.pictures.addItem(tr("the measured surface"), RELIEF)
            for name in view.pictures:
                text = name.rpartition("/")[2]
                self.pictures.addItem(tr("{name} (shows most)", name=text) if name == view.shown else text, name)
        self.pictures.setCurrentIndex(names.index(self._presenter.picture))

    def _lay_faces(self, view: InspectionView) -> None:
        """The regions, or the outlines of the faces found, and the points used; laid anew only if they changed."""
        faces = self._presenter.faces
        regions = {face: faces.region(face) for face in FACES}
        laid = (
            self._presenter.scan.serial,
            *(None if region is None else region.tobytes() for region in regions.values()),
        )
        if laid == self._laid:
            return
        self._laid = laid
        for place, face in enumerate(FACES):
            region = regions[face]
            found = view.outlines[place] if view.outlines is not None and not faces.own else None
            if region is not None:
                title = tr("upper face, own region") if face == "upper" else tr("lower face, own region")
                self.image.set_polygon(face, region, editable=True, colour=COLOURS[face], title=title)
            elif found is not None:
                title = tr("upper face, found") if face == "upper" else tr("lower face, found")
                self.image.set_polygon(face, found, colour=COLOURS[face], title=title)
            else:
                self.image.remove_layer(face)
            if view.used_uv is None:
                self.image.remove_layer(f"used {face}")
            else:
                title = tr("points used, upper") if face == "upper" else tr("points used, lower")
                self.image.set_points(
                    f"used {face}", view.used_uv[place], colour=COLOURS[face], symbol=".", size=3, title=title
                )
        self._lay_next_pair()

    def _lay_next_pair(self) -> None:
        """The next best of several pairs of faces, until one is confirmed."""
        pair = self._presenter.faces.next_pair
        for place in range(len(FACES)):
            self.image.remove_layer(f"next pair {place}")
        if pair is None:
            return
        label = tr("not measured: {mm} mm", mm=number(pair.thickness_mm, ".1f"))
        for place, outline in enumerate(pair.outlines_px):
            self.image.set_polygon(
                f"next pair {place}", outline, colour=NEXT_PAIR, title=tr("next best pair"), label=label
            )

    def _lay_feature(self) -> None:
        """The regions drawn for the chosen feature, and the points it used; laid anew only if they changed."""
        features, feature = self._presenter.features, self._presenter.feature
        spec, result = feature.spec, features.result(features.chosen)
        laid = (self._presenter.scan.serial, spec, result)
        if laid == self._feature:
            return
        self._feature = laid
        regions = () if spec is None else spec.regions
        for place in range(max(len(regions), self._regions)):
            name = feature.region_name(place)
            region = regions[place] if place < len(regions) else None
            if isinstance(region, Polygon):
                title = tr("region of the feature")
                self.image.set_polygon(name, region.corners_px, editable=True, colour=FEATURE, title=title)
            elif isinstance(region, FaceAt) and region.at_px is not None:
                title = tr("clicked face of the feature")
                self.image.set_points(name, [region.at_px], colour=FEATURE, symbol="+", size=16, title=title)
            else:
                self.image.remove_layer(name)
        self._regions = len(regions)
        section = None if spec is None else spec.section
        if section is not None and section.line_px is not None:
            title = tr("cut of {name}", name=spec.name if spec is not None else "")
            self.image.set_polygon(LINE, section.line_px, editable=True, colour=FEATURE, title=title)
        else:
            self.image.remove_layer(LINE)
        if result is None or not len(result.uv):
            self.image.remove_layer(USED)
        else:
            title = tr("points used, {name}", name=result.name)
            self.image.set_points(USED, result.uv, colour=FEATURE, symbol=".", size=3, title=title)

    def _words(self) -> str:
        faces = self._presenter.faces
        if faces.missing():
            return faces.missing()
        if faces.own:
            return tr("Drag a corner of a region, or its middle to move it.")
        return ""
