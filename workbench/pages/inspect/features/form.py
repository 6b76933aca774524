"""The chosen feature in a form: its name, where its points are, its limits, how it is measured."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from PySide6.QtCore import QSize, Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QToolButton, QVBoxLayout, QWidget

from core.inspect.plan.feature_kind import ChoiceField, FeatureKind, FormField, NumberField, ResultKind, TextField
from core.inspect.plan.feature_spec import Auto, Cut, FaceAt, FeatureSpec, InBox, InSphere, PointsOf, Polygon, Region
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import FILTERS, MOST_FACES, WIDEST_MM, kind_of, results_of
from core.messages import label
from workbench.language import tr
from workbench.pages.inspect.features import values as fields
from workbench.pages.inspect.features import words
from workbench.pages.inspect.features.edit import InspectFeatureEdit
from workbench.pages.inspect.features.plan import InspectFeatures
from workbench.pages.inspect.scan import InspectScan
from workbench.theme import icon
from workbench.views import ask
from workbench.views.control_frames import FramesMark
from workbench.views.forms.editors import NumberRange
from workbench.views.forms.form import SettingsForm
from workbench.views.layouts import enable, heading, in_column, in_row

CLICK = "face"
"""The tool that takes a face clicked in 3D for a region."""
TOOLS = {
    "polygon": "mdi6.vector-polygon",
    "lasso": "mdi6.lasso",
    CLICK: "mdi6.cursor-default-click-outline",
}
"""Tools to say where a region is, and their icons."""

BY_HAND = (fields.DRAWN, fields.CLICKED)
"""Sources of points that are not set by choosing them."""


def _of_the_list(kind: FeatureKind) -> str:
    """What a feature of this kind is made of."""
    if "point" not in kind.made_from:
        return tr("A plane or cylinder of the list.")
    if "plane" not in kind.made_from:
        return tr("A cylinder or sphere of the list.")
    return tr("A plane, sphere, cylinder or point of the list.")


def choose_nominal(parent: QWidget, folder: Path | None) -> Path | None:
    """Ask for the file of a nominal surface; return its path, or None if the user cancels."""
    kinds = tr("Nominal surfaces (*.step *.stp *.stl *.STEP *.STP *.STL)")
    return ask.choose_file_to_open(parent, tr("Nominal surface"), folder, kinds)


class FeatureForm(QWidget):
    """Two forms with the tools to draw regions between them; made anew for a feature with other fields."""

    draw = Signal(str, str)
    """Name of a region and kind of tool: it is to be drawn."""

    def __init__(
        self, features: InspectFeatures, edit: InspectFeatureEdit, scan: InspectScan, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._features, self._edit, self._scan = features, edit, scan
        self._made: object = None
        self.tools: dict[tuple[int, str], QToolButton] = {}
        self.buttons: dict[str, QPushButton] = {}
        self._column = in_column(on=self)
        self._begin()

    def refresh(self) -> None:
        """Show the chosen feature's fields; the forms are made again if it has other fields."""
        spec, plan = self._edit.spec, self._features.plan
        self.setVisible(spec is not None)
        if spec is None:
            return
        values = self._edit.values()
        made = _fields_of(spec, plan)
        if made != self._made:
            self._made = made
            self._make(spec, plan)
        for form in (self.where, self.what):
            form.set_values(values)
            for key in form.values():
                form.set_complaint(key, self._edit.complaint(key))
        self.frames.show_frames(words.frames_of(spec, plan))
        self._show_tools()

    @property
    def first_limit(self) -> QWidget | None:
        """Editor of the chosen feature's first limit; None if it has no limits."""
        key = next((key for key in self.what.values() if key.startswith("limits ")), None)
        return None if key is None else self.what.editor(key)

    # ---- making it

    def _make(self, spec: FeatureSpec, plan: InspectionPlan) -> None:
        self._column.removeWidget(self._inside)
        self._inside.hide()
        self._inside.deleteLater()  # its editors may be telling of the very edit that ends them
        self._begin()
        self.tools, self.buttons = {}, {}
        column = in_column(on=self._inside, margins=(0, 6, 0, 0), spacing=4)
        column.addLayout(in_row((heading(tr(kind_of(spec).title)), 1), self.frames))
        self._add_where(spec, plan)
        column.addWidget(self.where)
        if fields.own_regions(spec):
            column.addLayout(self._drawing_tools(spec))
        add_settings(self.what, spec)
        column.addWidget(self.what)
        self._add_buttons(spec, column)
        self.where.edited.connect(self._edited)
        self.what.edited.connect(self._edited)

    def _begin(self) -> None:
        """What is filled next, still empty."""
        self._inside = inside = QWidget(self)
        self.where, self.what, self.frames = SettingsForm(inside), SettingsForm(inside), FramesMark(inside)
        self._column.addWidget(inside)

    def _add_where(self, spec: FeatureSpec, plan: InspectionPlan) -> None:
        form = self.where
        form.add_text("name", tr("Name"), tr("As it is called in the list and in the report."))
        others = [(name, name) for name in fields.elements(plan, kind_of(spec))]
        usual = (tr("First feature"), tr("Second feature"))
        titles = [tr(title) for title in kind_of(spec).part_titles] or usual
        for place, title in zip(range(kind_of(spec).made_of), titles, strict=False):
            form.add_choice(f"of {place}", title, others, _of_the_list(kind_of(spec)))
        most = kind_of(spec).most_regions
        if most > 1:
            form.add_number(
                "parts",
                tr("Faces"),
                NumberRange(2, most, none_text=tr("automatic")),
                tr("How many faces are named one by one; automatic: all found."),
            )
        for place, region in enumerate(fields.own_regions(spec)):
            self._add_region(spec, plan, place, isinstance(region, Auto))

    def _add_region(self, spec: FeatureSpec, plan: InspectionPlan, place: int, found: bool) -> None:
        region = spec.regions[place]
        choices = [
            (fields.AUTO, words.source_of_none(spec)),
            (fields.DRAWN, tr("drawn")),
            (fields.CLICKED, tr("clicked face")),
        ]
        if plan.frame is not None or isinstance(region, InSphere | InBox):
            choices += [(fields.SPHERE, tr("in a sphere")), (fields.BOX, tr("in a box"))]
        choices += [
            (fields.POINTS_OF + one.name, tr("points of {name}", name=one.name))
            for one in plan.features
            if one.name != spec.name and not kind_of(one).made_of
        ]
        self.where.add_choice(
            f"source {place}", self._region_title(spec, place), choices, tr("Where its points are taken from.")
        )
        for one in _placed(place, region):
            _add(self.where, one)
        single = kind_of(spec).most_regions > 1 and len(spec.regions) == 1
        if found and kind_of(spec).automatic == "numbered" and not single:
            self.where.add_number(
                f"number {place}",
                tr("Number of the face"),
                NumberRange(1, MOST_FACES),
                tr("1 is the largest plane face of the scan, 2 the next."),
            )

    def _region_title(self, spec: FeatureSpec, place: int) -> str:
        titles = kind_of(spec).part_titles
        if len(titles) == len(spec.regions):
            return tr(titles[place])
        return tr("Level {number}", number=place + 1) if len(spec.regions) > 1 else tr("Region")

    def _drawing_tools(self, spec: FeatureSpec) -> QGridLayout:
        grid = QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(0, 1)
        for place in range(len(spec.regions)):
            several = tr("Draw “{name}”", name=self._region_title(spec, place))
            title = several if len(spec.regions) > 1 else tr("Draw the region")
            grid.addWidget(QLabel(title), place, 0)
            for column, (kind, symbol) in enumerate(TOOLS.items(), start=1):
                button = QToolButton()
                button.setAutoRaise(True)
                button.setIcon(icon(symbol))
                button.setIconSize(QSize(20, 20))
                button.setAccessibleName(f"{title}, {kind}")
                button.clicked.connect(lambda _=False, place=place, kind=kind: self._draw(place, kind))
                self.tools[place, kind] = button
                grid.addWidget(button, place, column)
        return grid

    def _add_buttons(self, spec: FeatureSpec, column: QVBoxLayout) -> None:
        wanted: list[tuple[str, str, str, Any]] = []
        if spec.deviation is not None:
            title = tr("Choose another nominal surface")
            wanted.append(("nominal", "mdi6.folder-open-outline", title, self._choose_nominal))
        if spec.section is not None:
            wanted.append(("cut", "mdi6.plus", tr("Add measurement"), self._edit.add_cut))
            if spec.section.cuts:
                last = len(spec.section.cuts) - 1
                wanted.append(("uncut", "mdi6.minus", tr("Remove the last"), lambda: self._edit.remove_cut(last)))
        row = QHBoxLayout()
        for name, symbol, text, does in wanted:
            button = QPushButton(icon(symbol), text)
            button.clicked.connect(lambda _=False, does=does: does())
            self.buttons[name] = button
            row.addWidget(button, 1)
        column.addLayout(row)

    # ---- using it

    def _edited(self, key: str, value: object) -> None:
        spec = self._edit.spec
        if not key.startswith("source ") or spec is None or value not in BY_HAND:
            self._edit.set_value(key, value)
            return
        place = int(key.removeprefix("source "))
        if value == fields.DRAWN and not isinstance(spec.regions[place], Polygon):
            self._draw(place, "polygon")
        if value == fields.CLICKED and not isinstance(spec.regions[place], FaceAt):
            self._draw(place, CLICK)
        self.where.set_values(self._edit.values())

    def _draw(self, place: int, kind: str) -> None:
        self.draw.emit(self._edit.region_name(place), kind)

    def _choose_nominal(self) -> None:
        path = choose_nominal(self, self._features.model.folder)
        if path is not None:
            self._edit.set_nominal(path)

    def _show_tools(self) -> None:
        more = tr("In the picture, or in 3D: what is drawn round there is outlined in the picture.")
        tips = {
            "polygon": tr("Draw the region corner by corner.") + " " + more,
            "lasso": tr("Draw round the region with the button held down.") + " " + more,
            CLICK: tr("Click the face in 3D: the region is all of it."),
        }
        for (_, kind), button in self.tools.items():
            enable(button, self._scan.buttons.use, tips[kind])


def _fields_of(spec: FeatureSpec, plan: InspectionPlan) -> object:
    """What decides which fields there are, and what they can be chosen from."""
    regions = [(type(region), region.feature if isinstance(region, PointsOf) else "") for region in spec.regions]
    others = [(one.name, one.kind) for one in plan.features if one.name != spec.name]
    cuts: object = None
    if spec.section is not None:
        cuts = spec.section.line_px is None, tuple((cut.name, cut.kind) for cut in spec.section.cuts)
    return spec.kind, regions, others, cuts, plan.frame is None


def _placed(place: int, region: Region) -> tuple[FormField, ...]:
    """Where a region of part coordinates is."""
    if isinstance(region, InSphere):
        centre = label("Middle of the sphere: x; y; z in part coordinates.")
        return (
            TextField(f"centre {place}", label("Centre in mm"), centre, "10; 20; 0"),
            NumberField(
                f"radius {place}",
                label("Radius"),
                label("Points so near to it are used."),
                "mm",
                1e-3,
                WIDEST_MM,
                3,
                1.0,
            ),
        )
    if isinstance(region, InBox):
        low, high = (
            label("The corner of the smallest x; y; z in part coordinates."),
            label("The corner of the largest x; y; z in part coordinates."),
        )
        return (
            TextField(f"low {place}", label("From, in mm"), low, "0; 0; 0"),
            TextField(f"high {place}", label("To, in mm"), high, "10; 20; 5"),
        )
    return ()


MOST_PX = 100_000.0
"""Furthest place in a picture in pixels that can be entered, to either side."""

_LINE = tuple(
    NumberField(f"line {place} {axis}", title, help, "px", -MOST_PX, MOST_PX, 1, 10.0)
    for place, help, titles in (
        (0, label("Where it begins; drag its end in the picture."), (label("From, u"), label("From, v"))),
        (1, label("Where it ends; drag its end in the picture."), (label("To, u"), label("To, v"))),
    )
    for axis, title in enumerate(titles)
)
"""Where a section is that was drawn in the picture."""

_PLANE = (
    TextField(
        "place",
        label("Place in mm"),
        label("A point that the cut goes through: x; y; z in part coordinates."),
        "10; 20; 0",
    ),
    TextField(
        "direction",
        label("Direction"),
        label("What the cut is square to: x; y; z in part coordinates."),
        "0; 1; 0",
    ),
)
"""Where a section is that is placed by numbers."""

_ENDS = {
    "first": (label("1st stretch, from"), label("1st stretch, to")),
    "second": (label("2nd stretch, from"), label("2nd stretch, to")),
    "only": (label("Stretch, from"), label("Stretch, to")),
}


def add_settings(form: SettingsForm, spec: FeatureSpec) -> None:
    """Add the fields of all settings of a feature to a form."""
    for title, settings in _sections(spec):
        if title:
            form.add_section(title)
        for one in settings:
            _add(form, one)


def _sections(spec: FeatureSpec) -> Iterator[tuple[str, tuple[FormField, ...]]]:
    """Title ("" for none) and fields of each group."""
    kind, section = kind_of(spec), spec.section
    where = () if section is None else _PLANE if section.line_px is None else _LINE
    yield "", (*where, *kind.fields)
    for place, cut in enumerate(section.cuts if section is not None else ()):
        yield tr("Measurement {number}", number=place + 1), _cut(f"cut {place}", cut)
    for result, given in results_of(spec).items():
        yield tr("Asked of the {result}", result=result) if section is None else result, _limits(result, given)
    if not kind.made_of:
        yield tr("Which points are used"), FILTERS


def _cut(key: str, cut: Cut) -> tuple[FormField, ...]:
    """What is measured in a section."""
    stretches = {"first": "only"} if cut.kind == "radius" else {"first": "first", "second": "second"}
    kinds = (("height", label("height")), ("distance", label("distance")), ("radius", label("radius")))
    return (
        TextField(f"{key} name", label("Name"), label("As it is called in the list and in the report.")),
        ChoiceField(f"{key} kind", label("What"), label("Of what lies over the stretches below."), kinds),
        *(
            NumberField(
                f"{key} {stretch} {end}", title, label("Position along the cut."), "mm", -WIDEST_MM, WIDEST_MM, 2, 1.0
            )
            for stretch, named in stretches.items()
            for end, title in enumerate(_ENDS[named])
        ),
    )


def _limits(result: str, kind: ResultKind) -> tuple[FormField, ...]:
    """Nominal value and permitted deviations."""
    asked = {
        "nominal": (label("Nominal value"), label("What it should be; empty: no verdict.")),
        "lower": (label("Lower deviation"), label("Permitted below, as −0.1; empty: no limit.")),
        "upper": (label("Upper deviation"), label("Permitted above, as 0.1; empty: no limit.")),
    }
    if kind.one_sided:
        asked = {"upper": (label("Tolerance"), label("Largest permitted value; empty: no verdict."))}
    elif kind.numbered:
        del asked["nominal"]
    unit = "°" if kind.quantity == "angle" else "mm"
    return tuple(
        NumberField(
            f"limits {side} {result}", title, help, unit, -WIDEST_MM, WIDEST_MM, 4, 0.01, none=label("none"), first=0.0
        )
        for side, (title, help) in asked.items()
    )


def _add(form: SettingsForm, one: FormField) -> None:
    match one:
        case NumberField():
            form.add_number(
                one.key,
                tr(one.label),
                NumberRange(
                    one.minimum,
                    one.maximum,
                    decimals=one.decimals,
                    step=one.step,
                    unit=one.unit,
                    none_text=tr(one.none) if one.none else None,
                    first=one.first,
                ),
                tr(one.help),
            )
        case ChoiceField():
            form.add_choice(one.key, tr(one.label), [(value, tr(text)) for value, text in one.choices], tr(one.help))
        case TextField():
            form.add_text(one.key, tr(one.label), tr(one.help), placeholder=one.placeholder)
