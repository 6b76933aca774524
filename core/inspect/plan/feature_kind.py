"""What the program knows of a kind of feature besides how it is fitted: the entries of `core.inspect.plan.kinds`.

All of it is data that takes no time to import: the window builds its menu, form and list from it, the files check
plans by it, and `FeatureKind.measure` loads the fit only when something is measured.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from core.inspect.characteristic import Quantity

ElementKind: TypeAlias = Literal["plane", "axis", "point"]
"""What other features can be measured from: see `core.inspect.fit.elements`."""

ToleranceSymbol: TypeAlias = Literal[
    "flatness", "cylindricity", "parallelism", "perpendicularity", "position", "profile of a surface"
]
"""What a characteristic is after ISO 1101."""

Automatic: TypeAlias = Literal["searched", "numbered", "all points"]
"""What an automatic region is: the surface of this kind that explains most points, the n-th largest plane face, or the
whole scan."""


@dataclass(frozen=True, slots=True)
class ResultKind:
    """Characteristic that a kind of feature gives.

    Parameters
    ----------
    name
        What limits are asked by, and `Characteristic.kind`.
    quantity
        "length" in mm or "angle" in rad.
    one_sided
        Whether it cannot be too small, as a deviation of form: of a tolerance only the upper limit counts.
    expands
        Whether it grows with the part's temperature, and can be compared with a master.
    numbered
        Whether there are several, "height 1", "height 2", …, each with its own of the feature's nominal heights.
    symbol
        What stands in its feature control frame; None: it has none.
    """

    name: str
    quantity: Quantity = "length"
    one_sided: bool = False
    expands: bool = False
    numbered: bool = False
    symbol: ToleranceSymbol | None = None


@dataclass(frozen=True, slots=True)
class NumberField:
    """Field of the form for a number; `key` is the name of the setting.

    With `none` it may be none, which is shown so; `first` is where it begins when one is wanted.
    """

    key: str
    label: str
    help: str
    unit: str
    minimum: float
    maximum: float
    decimals: int
    step: float
    none: str = ""
    first: float | None = None


@dataclass(frozen=True, slots=True)
class ChoiceField:
    """Field of the form for one of several `choices`, each (value, label)."""

    key: str
    label: str
    help: str
    choices: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class TextField:
    """Field of the form for a line of text."""

    key: str
    label: str
    help: str
    placeholder: str = ""


FormField: TypeAlias = NumberField | ChoiceField | TextField


@dataclass(frozen=True, slots=True)
class FeatureKind:
    """Kind of feature; texts are English labels that the window translates.

    Parameters
    ----------
    name
        In plan.toml and inspection.json.
    fit
        Where it is measured, as "module:function"; the function is a `core.inspect.features.measured.Measure`.
    title, help
        In menus: what it is called, what it measures.
    icon
        Name of its Material Design icon.
    results
        What it gives. Of a section what its cuts can be; the cuts have names of their own.
    element
        What other features can be measured from it as; None: as nothing.
    made_of
        Of how many other features it is made instead of points.
    made_from
        What those must be.
    automatic
        What its region is where none is drawn.
    most_regions
        How many regions it can have.
    part_titles
        What these regions, or the features it is made of, are called; empty: by their number.
    settings
        The field of `FeatureSpec` with its own settings, which it needs; "": it has none.
    fields
        Of its own settings in the form.
    nominal_file
        Whether it is compared with a nominal surface, for which a file is asked when it is added.
    plotted
        Whether it has a plot of its own.
    missing
        Whether the wing it is of is not there.
    """

    name: str
    fit: str
    title: str
    help: str
    icon: str
    results: tuple[ResultKind, ...] = ()
    element: ElementKind | None = None
    made_of: int = 0
    made_from: tuple[ElementKind, ...] = ("plane", "axis", "point")
    automatic: Automatic = "searched"
    most_regions: int = 1
    part_titles: tuple[str, ...] = ()
    settings: Literal["", "section", "deviation", "position"] = ""
    fields: tuple[FormField, ...] = ()
    nominal_file: bool = False
    plotted: bool = False
    missing: bool = False

    @property
    def measure(self) -> Callable[..., Any]:
        """Function that measures a feature of this kind; imported on first use."""
        module, _, function = self.fit.partition(":")
        found: Callable[..., Any] = getattr(importlib.import_module(module), function)
        return found

    @property
    def expands(self) -> bool:
        """Whether any characteristic of this kind of feature grows with the part's temperature."""
        return any(result.expands for result in self.results)

    def result(self, name: str) -> ResultKind:
        """Find the characteristic called `name` among those of this kind of feature; KeyError if there is none."""
        return {result.name: result for result in self.results}[name]
