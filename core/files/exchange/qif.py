"""QIF 3.0 results (ISO 23952): definitions, nominals, items and measurements of every characteristic, as XML.

QIF states a standard uncertainty with a value (`combinedUncertainty`, in the unit of the value); k, U and the verdict
rule are attributes of the measurement. What is "not proven" is neither PASS nor FAIL: its status is INDETERMINATE.
Features (the points a characteristic rests on) and datums are not handed over.

References
----------
ANSI/DMSC QIF 3.0 - 2018, clause 5 and the schema files QIFDocument.xsd, QIFResults.xsd, Characteristics.xsd.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from typing import Any
from uuid import UUID
from xml.etree.ElementTree import Element

from core.files.exchange.records import one_line, result_row, unit_of
from core.files.exchange.xml_elements import decimal, put, write_document
from core.inspect.characteristic import Characteristic
from core.report.content import ReportContent

NAMESPACE = "http://qifstandards.org/xsd/qif3"
VERSION = "3.0.0"

LINEAR = {
    "thickness": "Thickness",
    "step height": "Height",
    "height": "Height",
    "diameter": "Diameter",
    "sphere": "SphericalDiameter",
    "sphere diameter": "SphericalDiameter",
    "radius": "Radius",
}
"""QIF's names of kinds of lengths; any other is a Length (its DistanceBetween asks for features, too)."""

ZONE = {
    "flatness": "Flatness",
    "sphericity": "Sphericity",
    "cylindricity": "Cylindricity",
    "parallelism": "Parallelism",
    "perpendicularity": "Perpendicularity",
    "position": "Position",
    "profile": "SurfaceProfile",
}
"""Those with a tolerance zone; without a tolerance QIF has no such characteristic, and it is a Length."""

ZONE_SHAPES = {
    "Parallelism": {"⌀": "DiametricalZone", "": "PlanarZone"},
    "Perpendicularity": {"⌀": "DiametricalZone", "": "PlanarZone"},
    "Position": {"S⌀": "SphericalZone", "⌀": "DiametricalZone", "": "NonDiametricalZone"},
}
"""Of those of which QIF wants it said, by the sign in the feature control frame."""

STATUS = {"conforming": "PASS", "not conforming": "FAIL", "not proven": "INDETERMINATE", "none": "NOT_ANALYZED"}

PART_STATUS = {"conforming": "PASS", "not conforming": "FAIL"}
"""Of all together; QIF has no INDETERMINATE there."""


def write_qif(path: Path, content: ReportContent) -> None:
    """Write a report's results as a QIF 3.0 document (XML); InputError if it cannot be written."""
    write_document(path, qif_document(content))


def qif_document(content: ReportContent) -> Element:
    """Make the root element of the QIF 3.0 document of a report's results."""
    ids = count(1)
    component, results, device, standard = (next(ids) for _ in range(4))
    rows = [(one, [next(ids) for _ in range(4)]) for one in content.characteristics]
    root = Element("QIFDocument", xmlns=NAMESPACE)
    root.set("versionQIF", VERSION)
    root.set("idMax", f"{next(ids) - 1}")
    put(root, "QPId", f"{_uuid(content, 'document')}")
    header = put(root, "Header")
    application = put(header, "Application")
    put(application, "Name", f"Trisect {content.version}")
    put(header, "Description", f"Measurement report {content.report_id}")
    named = put(put(root, "StandardsDefinitions", n="1"), "Standard", id=f"{standard}")
    put(put(named, "Organization"), "StandardsOrganizationEnum", "ISO")
    put(named, "Designator", "8015")
    put(named, "Year", "2011")
    _units(root)
    devices = put(put(root, "MeasurementResources"), "MeasurementDevices", n="1")
    rig = put(devices, "MeasurementDevice", id=f"{device}")
    put(rig, "Name", f"rig {content.rig_id or 'not named'}")
    put(rig, "Description", "; ".join(f"{name}: {value}" for name, value in content.rig.items()))
    if rows:
        asked = put(root, "Characteristics")
        put(asked, "FormalStandardId", f"{standard}")
        _characteristics(asked, content, rows, device)
    _results(put(root, "Results"), content, rows, component, results)
    return root


def _units(root: Element) -> None:
    primary = put(put(root, "FileUnits"), "PrimaryUnits")
    for element, si, name, factor in (
        ("AngularUnit", "radian", "deg", f"{math.radians(1.0):.17g}"),
        ("LinearUnit", "meter", "mm", "0.001"),
    ):
        unit = put(primary, element)
        put(unit, "SIUnitName", si)
        put(unit, "UnitName", name)
        put(put(unit, "UnitConversion"), "Factor", factor)


def _kind(one: Characteristic) -> str:
    if one.quantity == "angle":
        return "Angle"
    if one.kind in ZONE and one.limits is not None and math.isfinite(one.limits.upper):
        return ZONE[one.kind]
    return LINEAR.get(one.kind, "Length")


def _characteristics(
    parent: Element, content: ReportContent, rows: list[tuple[Characteristic, list[int]]], device: int
) -> None:
    """Three elements for each: its requirement (definition), its nominal value, and its place on this part (item)."""
    definitions = put(parent, "CharacteristicDefinitions", n=f"{len(rows)}")
    nominals = put(parent, "CharacteristicNominals", n=f"{len(rows)}")
    items = put(parent, "CharacteristicItems", n=f"{len(rows)}")
    for one, (definition_id, nominal_id, item_id, _) in rows:
        kind, row = _kind(one), result_row(one)
        definition = put(definitions, f"{kind}CharacteristicDefinition", id=f"{definition_id}")
        if row["rule"]:
            put(definition, "Description", one_line(row["rule"]))
        put(definition, "Name", one_line(one.name))
        if kind in ZONE.values():
            put(definition, "ToleranceValue", decimal(row["upper_limit"]))
            frame = content.control_frames.get(one.name)
            _zone_shape(definition, kind, "" if frame is None else frame.round)
        else:
            _tolerance(definition, row)
        nominal = put(nominals, f"{kind}CharacteristicNominal", id=f"{nominal_id}")
        put(nominal, "CharacteristicDefinitionId", f"{definition_id}")
        put(nominal, "Name", one_line(one.name))
        if kind not in ZONE.values() and row["nominal"] is not None:
            put(nominal, "TargetValue", decimal(row["nominal"]))
        if kind == "Position":
            put(put(nominal, "CoordinateMethod"), "Method", "RECTANGULAR")
        item = put(items, f"{kind}CharacteristicItem", id=f"{item_id}")
        put(item, "Name", one_line(one.name))
        put(put(item, "MeasurementDeviceIds", n="1"), "Id", f"{device}")
        put(item, "CharacteristicNominalId", f"{nominal_id}")


def _zone_shape(definition: Element, kind: str, sign: str) -> None:
    """How a zone of orientation or position is bounded, whatever the size of the feature (ISO 8015)."""
    if kind in ZONE_SHAPES:
        put(definition, "MaterialCondition", "REGARDLESS")
        put(put(definition, "ZoneShape"), ZONE_SHAPES[kind].get(sign, ZONE_SHAPES[kind][""]))


def _tolerance(definition: Element, row: Mapping[str, Any]) -> None:
    """Limits as limits; a value with neither is only measured."""
    if row["upper_limit"] is None and row["lower_limit"] is None:
        put(definition, "NonTolerance", "MEASURED")
        return
    tolerance = put(definition, "Tolerance")
    for name, limit in (("MaxValue", row["upper_limit"]), ("MinValue", row["lower_limit"])):
        if limit is not None:
            put(tolerance, name, decimal(limit))
    put(tolerance, "DefinedAsLimit", "true")


def _results(
    parent: Element, content: ReportContent, rows: list[tuple[Characteristic, list[int]]], component: int, results: int
) -> None:
    measured = put(put(parent, "MeasurementResultsSet", n="1"), "MeasurementResults", id=f"{results}")
    trace = put(measured, "InspectionTraceability")
    laboratory = one_line(content.laboratory or content.template.name)
    if laboratory:
        put(put(trace, "InspectingOrganization"), "Name", laboratory)
    put(trace, "ReportNumber", content.report_id)
    put(trace, "InspectionEnd", content.timestamp.isoformat(timespec="seconds"))
    if one_line(content.operator):
        put(put(trace, "InspectionOperator"), "Name", one_line(content.operator))
    put(measured, "ThisResultsInstanceQPId", f"{_uuid(content, 'results')}")
    if rows:
        listed = put(put(measured, "MeasuredCharacteristics"), "CharacteristicMeasurements", n=f"{len(rows)}")
        for one, (_, _, item_id, own_id) in rows:
            _measurement(listed, one, item_id, own_id, component, content)
    status = PART_STATUS.get(content.results.verdict, "UNKNOWN")
    put(put(measured, "InspectionStatus"), "InspectionStatusEnum", status)
    put(put(measured, "ActualComponentIds", n="1"), "Id", f"{component}")
    parts = put(put(parent, "ActualComponentSets", n="1"), "ActualComponentSet", n="1")
    part = put(parts, "ActualComponent", id=f"{component}")
    if content.serial:
        put(part, "SerialNumber", one_line(content.serial))
    put(put(part, "Status"), "InspectionStatusEnum", status)


def _measurement(
    parent: Element, one: Characteristic, item_id: int, own_id: int, component: int, content: ReportContent
) -> None:
    """Status and value of one, with its standard uncertainty."""
    row, (unit, factor) = result_row(one), unit_of(one)
    own = put(parent, f"{_kind(one)}CharacteristicMeasurement", id=f"{own_id}")
    said = {"k": f"{one.k:g}", "verdict": row["verdict"], "decision rule": "ISO 14253-1"}
    said |= {} if row["U"] is None else {f"U, {unit}": decimal(row["U"])}
    attributes = put(own, "Attributes", n=f"{len(said)}")
    for name, value in said.items():
        put(attributes, "AttributeStr", name=name, value=value)
    put(put(own, "Status"), "CharacteristicStatusEnum", STATUS[row["verdict"]])
    put(own, "CharacteristicItemId", f"{item_id}")
    put(own, "TimeStamp", content.timestamp.isoformat(timespec="seconds"))
    put(own, "ActualComponentId", f"{component}")
    if row["value"] is not None:
        known = {} if row["u"] is None else {"combinedUncertainty": decimal(factor * one.u), "meanError": "0"}
        put(own, "Value", decimal(row["value"]), **known)


def _uuid(content: ReportContent, what: str) -> UUID:
    """Names this very content: the same result has the same one."""
    return UUID(
        bytes=hashlib.sha256(f"{content.report_id}/{content.timestamp}/{what}".encode()).digest()[:16], version=4
    )
