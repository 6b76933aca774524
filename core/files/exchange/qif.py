"""QIF 3.0 results (ISO 23952): definitions, nominals, items and measurements of every characteristic, as XML.

QIF states a standard uncertainty with a value (`combinedUncertainty`, in the unit of the value); k, U and the decision
rule are attributes of the measurement. What is "not proven" is neither PASS nor FAIL: its status is INDETERMINATE.
Features (the points a characteristic rests on) are not handed over.

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
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from core.files.atomic import write_bytes
from core.files.exchange.records import one_line, result_row, unit_of
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

FORM = {"flatness": "Flatness", "sphericity": "Sphericity", "cylindricity": "Cylindricity"}
"""Those with a tolerance zone; without a tolerance QIF has no such characteristic, and it is a Length."""

STATUS = {"conforming": "PASS", "not conforming": "FAIL", "not proven": "INDETERMINATE", "none": "NOT_ANALYZED"}


def write_qif(path: Path, content: ReportContent) -> None:
    """Write the results as a QIF 3.0 document; InputError if it cannot be written."""
    root = qif_document(content)
    ElementTree.indent(root)
    data = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    write_bytes(path, data + b"\n")


def qif_document(content: ReportContent) -> Element:
    """The document's root element."""
    ids = count(1)
    component, results, device, standard = (next(ids) for _ in range(4))
    rows = [(one, [next(ids) for _ in range(4)]) for one in content.characteristics]
    root = Element("QIFDocument", xmlns=NAMESPACE)
    root.set("versionQIF", VERSION)
    root.set("idMax", f"{next(ids) - 1}")
    _put(root, "QPId", f"{_uuid(content, 'document')}")
    header = _put(root, "Header")
    application = _put(header, "Application")
    _put(application, "Name", f"Trisect {content.version}")
    _put(header, "Description", f"Measurement report {content.report_id}")
    named = _put(_put(root, "StandardsDefinitions", n="1"), "Standard", id=f"{standard}")
    _put(_put(named, "Organization"), "StandardsOrganizationEnum", "ISO")
    _put(named, "Designator", "8015")
    _put(named, "Year", "2011")
    _units(root)
    devices = _put(_put(root, "MeasurementResources"), "MeasurementDevices", n="1")
    rig = _put(devices, "MeasurementDevice", id=f"{device}")
    _put(rig, "Name", f"rig {content.rig_id or 'not named'}")
    _put(rig, "Description", "; ".join(f"{name}: {value}" for name, value in content.rig.items()))
    if rows:
        asked = _put(root, "Characteristics")
        _put(asked, "FormalStandardId", f"{standard}")
        _characteristics(asked, rows, device)
    _results(_put(root, "Results"), content, rows, component, results)
    return root


def _units(root: Element) -> None:
    primary = _put(_put(root, "FileUnits"), "PrimaryUnits")
    for element, si, name, factor in (
        ("AngularUnit", "radian", "deg", f"{math.radians(1.0):.17g}"),
        ("LinearUnit", "meter", "mm", "0.001"),
    ):
        unit = _put(primary, element)
        _put(unit, "SIUnitName", si)
        _put(unit, "UnitName", name)
        _put(_put(unit, "UnitConversion"), "Factor", factor)


def _kind(one: Characteristic) -> str:
    if one.quantity == "angle":
        return "Angle"
    if one.kind in FORM and one.limits is not None and math.isfinite(one.limits.upper):
        return FORM[one.kind]
    return LINEAR.get(one.kind, "Length")


def _characteristics(parent: Element, rows: list[tuple[Characteristic, list[int]]], device: int) -> None:
    """Three elements for each: its requirement (definition), its nominal value, and its place on this part (item)."""
    definitions = _put(parent, "CharacteristicDefinitions", n=f"{len(rows)}")
    nominals = _put(parent, "CharacteristicNominals", n=f"{len(rows)}")
    items = _put(parent, "CharacteristicItems", n=f"{len(rows)}")
    for one, (definition_id, nominal_id, item_id, _) in rows:
        kind, row = _kind(one), result_row(one)
        definition = _put(definitions, f"{kind}CharacteristicDefinition", id=f"{definition_id}")
        if row["rule"]:
            _put(definition, "Description", one_line(row["rule"]))
        _put(definition, "Name", one_line(one.name))
        if kind in FORM.values():
            _put(definition, "ToleranceValue", _number(row["upper_limit"]))
        else:
            _tolerance(definition, row)
        nominal = _put(nominals, f"{kind}CharacteristicNominal", id=f"{nominal_id}")
        _put(nominal, "CharacteristicDefinitionId", f"{definition_id}")
        _put(nominal, "Name", one_line(one.name))
        if kind not in FORM.values() and row["nominal"] is not None:
            _put(nominal, "TargetValue", _number(row["nominal"]))
        item = _put(items, f"{kind}CharacteristicItem", id=f"{item_id}")
        _put(item, "Name", one_line(one.name))
        _put(_put(item, "MeasurementDeviceIds", n="1"), "Id", f"{device}")
        _put(item, "CharacteristicNominalId", f"{nominal_id}")


def _tolerance(definition: Element, row: Mapping[str, Any]) -> None:
    """Limits as limits; a value with neither is only measured."""
    if row["upper_limit"] is None and row["lower_limit"] is None:
        _put(definition, "NonTolerance", "MEASURED")
        return
    tolerance = _put(definition, "Tolerance")
    for name, limit in (("MaxValue", row["upper_limit"]), ("MinValue", row["lower_limit"])):
        if limit is not None:
            _put(tolerance, name, _number(limit))
    _put(tolerance, "DefinedAsLimit", "true")


def _results(
    parent: Element, content: ReportContent, rows: list[tuple[Characteristic, list[int]]], component: int, results: int
) -> None:
    measured = _put(_put(parent, "MeasurementResultsSet", n="1"), "MeasurementResults", id=f"{results}")
    trace = _put(measured, "InspectionTraceability")
    laboratory = one_line(content.laboratory or content.template.name)
    if laboratory:
        _put(_put(trace, "InspectingOrganization"), "Name", laboratory)
    _put(trace, "ReportNumber", content.report_id)
    _put(trace, "InspectionEnd", content.timestamp.isoformat(timespec="seconds"))
    if one_line(content.operator):
        _put(_put(trace, "InspectionOperator"), "Name", one_line(content.operator))
    _put(measured, "ThisResultsInstanceQPId", f"{_uuid(content, 'results')}")
    if rows:
        listed = _put(_put(measured, "MeasuredCharacteristics"), "CharacteristicMeasurements", n=f"{len(rows)}")
        for one, (_, _, item_id, own_id) in rows:
            _measurement(listed, one, item_id, own_id, component, content)
    verdicts = {one.verdict for one, _ in rows} - {""}
    status = "FAIL" if "not conforming" in verdicts else "PASS" if verdicts == {"conforming"} else "UNKNOWN"
    _put(_put(measured, "InspectionStatus"), "InspectionStatusEnum", status)
    _put(_put(measured, "ActualComponentIds", n="1"), "Id", f"{component}")
    parts = _put(_put(parent, "ActualComponentSets", n="1"), "ActualComponentSet", n="1")
    part = _put(parts, "ActualComponent", id=f"{component}")
    if content.serial:
        _put(part, "SerialNumber", one_line(content.serial))
    _put(_put(part, "Status"), "InspectionStatusEnum", status)


def _measurement(
    parent: Element, one: Characteristic, item_id: int, own_id: int, component: int, content: ReportContent
) -> None:
    """Status and value of one, with its standard uncertainty."""
    row, (unit, factor) = result_row(one), unit_of(one)
    own = _put(parent, f"{_kind(one)}CharacteristicMeasurement", id=f"{own_id}")
    said = {"k": f"{one.k:g}", "decision": row["decision"], "decision rule": "ISO 14253-1"}
    said |= {} if row["U"] is None else {f"U, {unit}": _number(row["U"])}
    attributes = _put(own, "Attributes", n=f"{len(said)}")
    for name, value in said.items():
        _put(attributes, "AttributeStr", name=name, value=value)
    _put(_put(own, "Status"), "CharacteristicStatusEnum", STATUS[row["decision"]])
    _put(own, "CharacteristicItemId", f"{item_id}")
    _put(own, "TimeStamp", content.timestamp.isoformat(timespec="seconds"))
    _put(own, "ActualComponentId", f"{component}")
    if row["value"] is not None:
        known = {} if row["u"] is None else {"combinedUncertainty": _number(factor * one.u), "meanError": "0"}
        _put(own, "Value", _number(row["value"]), **known)


def _uuid(content: ReportContent, what: str) -> UUID:
    """Names this very content: the same result has the same one."""
    return UUID(
        bytes=hashlib.sha256(f"{content.report_id}/{content.timestamp}/{what}".encode()).digest()[:16], version=4
    )


def _put(parent: Element, element_name: str, text: str = "", /, **attributes: str) -> Element:
    element = ElementTree.SubElement(parent, element_name, attributes)
    if text:
        element.text = "".join(c for c in text if c.isprintable() or c in "\t\n")
    return element


def _number(value: float) -> str:
    """xs:decimal: no exponent."""
    text = f"{value:.12f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
