"""A digital calibration certificate: DCC 3.3.0 with D-SI numbers, the XML pattern of the national metrology institutes.

It holds what the report says of the results: each value with U, k and coverage, limits and verdict, the calibrations
it rests on with their hashes, conditions, software and method. It is a document of the laboratory that issues it: the
program does not sign, and a statement says that it claims no accreditation. A verdict that proves neither has no
`conformity`: DCC has no word for it. Texts are English.

References
----------
PTB, DCC 3.3.0, https://ptb.de/dcc/v3.3.0/. SmartCom, Digital System of Units (D-SI) 2.2, doi:10.5281/zenodo.3816686.
"""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from scipy.stats import t as student

from core.errors import InputError
from core.files.exchange.records import degrees_of_freedom, one_line, result_row
from core.files.exchange.xml_elements import decimal, put, write_document
from core.inspect.characteristic import Characteristic
from core.messages import Message
from core.report.content import ReportContent

VERSION = "3.3.0"
NAMESPACES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}
UNITS = {"mm": r"\milli\metre", "deg": r"\degree"}
CONFORMITY = {"conforming": "pass", "not conforming": "fail"}
NOT_STATED = "not stated"


def write_dcc(path: Path, content: ReportContent) -> None:
    """Write a report's results as a digital calibration certificate (DCC, XML); InputError if that fails.

    Raises
    ------
    InputError
        If the laboratory or its country is not named, nothing was measured, or the file cannot be written.
    """
    write_document(path, dcc_document(content))


def dcc_document(content: ReportContent) -> Element:
    """Make the root element of a digital calibration certificate; InputError if what it must state is missing."""
    laboratory, country = one_line(content.laboratory or content.template.name), content.template.country
    if not laboratory or not country:
        raise InputError(
            Message(
                "export.dcc_without_laboratory",
                "a digital calibration certificate names the laboratory and its country",
            ),
            todo=Message("export.advice_name_laboratory", 'give name and country = "DE" in the template of the report'),
        )
    if not content.characteristics:
        raise InputError(
            Message("export.dcc_without_result", "there is no result to certify"),
            todo=Message("export.advice_measure", "measure the thickness or inspect the scan first"),
        )
    root = Element("dcc:digitalCalibrationCertificate", {f"xmlns:{key}": uri for key, uri in NAMESPACES.items()})
    root.set("schemaVersion", VERSION)
    administrative = put(root, "dcc:administrativeData")
    _software(put(administrative, "dcc:dccSoftware"), content)
    _core_data(put(administrative, "dcc:coreData"), content)
    _item(put(put(administrative, "dcc:items"), "dcc:item"), content)
    contact = put(put(administrative, "dcc:calibrationLaboratory"), "dcc:contact")
    _text(contact, "dcc:name", laboratory)
    location = put(contact, "dcc:location")
    put(location, "dcc:countryCode", country)
    if address := [line for line in map(one_line, content.template.address) if line]:
        _text(location, "dcc:further", *address)
    person = put(put(administrative, "dcc:respPersons"), "dcc:respPerson")
    _text(put(person, "dcc:person"), "dcc:name", one_line(content.operator) or NOT_STATED)
    put(person, "dcc:role", "operator")
    customer = put(administrative, "dcc:customer")
    _text(customer, "dcc:name", one_line(content.customer) or NOT_STATED)
    _text(put(customer, "dcc:location"), "dcc:further", NOT_STATED)
    _statements(put(administrative, "dcc:statements"), content)
    _results(put(put(root, "dcc:measurementResults"), "dcc:measurementResult"), content)
    return root


def _software(parent: Element, content: ReportContent) -> None:
    software = put(parent, "dcc:software")
    _text(software, "dcc:name", "Trisect")
    put(software, "dcc:release", content.version)
    put(software, "dcc:type", "application")


def _core_data(core: Element, content: ReportContent) -> None:
    put(core, "dcc:countryCodeISO3166_1", content.template.country)
    put(core, "dcc:usedLangCodeISO639_1", "en")
    put(core, "dcc:mandatoryLangCodeISO639_1", "en")
    put(core, "dcc:uniqueIdentifier", content.report_id)
    for name in ("beginPerformanceDate", "endPerformanceDate"):
        put(core, f"dcc:{name}", content.timestamp.date().isoformat())
    put(core, "dcc:performanceLocation", "other")  # nobody states where


def _item(item: Element, content: ReportContent) -> None:
    _text(item, "dcc:name", one_line(content.part) or NOT_STATED)
    identification = put(put(item, "dcc:identifications"), "dcc:identification")
    serial = one_line(content.serial)
    put(identification, "dcc:issuer", "owner" if serial else "other")
    put(identification, "dcc:value", serial or content.report_id)
    _text(identification, "dcc:name", "serial number" if serial else "measurement report")


def _statements(parent: Element, content: ReportContent) -> None:
    claims = put(parent, "dcc:statement")
    _text(
        claims,
        "dcc:declaration",
        "Written by measuring software from its report. It is not signed and claims no accreditation: whoever issues "
        "it answers for it.",
    )
    rule = put(parent, "dcc:statement")
    put(rule, "dcc:norm", "ISO 14253-1")
    _text(
        rule,
        "dcc:declaration",
        "A deviation must stay within its tolerance even when it is enlarged by U. Where neither conformity nor "
        "non-conformity is proven, no conformity is stated.",
    )
    for said in dict.fromkeys((*content.limits, *content.all_notes)):
        _text(put(parent, "dcc:statement"), "dcc:declaration", str(said))


def _results(result: Element, content: ReportContent) -> None:
    _text(result, "dcc:name", f"Measurement report {content.report_id}")
    if method := one_line(content.method):
        _text(put(put(result, "dcc:usedMethods"), "dcc:usedMethod"), "dcc:name", method)
    _software(put(result, "dcc:usedSoftware"), content)
    equipment = put(result, "dcc:measuringEquipments")
    rig = put(equipment, "dcc:measuringEquipment")
    _text(rig, "dcc:name", "rig of camera, fan laser and hand-held laser")
    said = [f"{name}: {value}" for name, value in content.rig.items()]
    _text(rig, "dcc:description", *said, f"SHA-256 over all inputs: {content.inputs_digest}")
    for mark in content.calibrations:
        one = put(equipment, "dcc:measuringEquipment")
        _text(one, "dcc:name", f"{mark.of} calibration")
        certificate = put(one, "dcc:certificate")
        _text(certificate, "dcc:referral", f"{mark.of} calibration of this rig")
        put(certificate, "dcc:referralID", mark.id)
        put(certificate, "dcc:procedure", "SHA-256")
        put(certificate, "dcc:value", mark.sha256)
    _conditions(result, content)
    results = put(result, "dcc:results")
    for row in content.characteristics:
        _characteristic(put(results, "dcc:result"), row)


def _conditions(result: Element, content: ReportContent) -> None:
    """Temperatures, as far as they are stated."""
    stated = {"air": content.air_celsius, "part": content.part_celsius}
    known = {name: value for name, value in stated.items() if value is not None}
    conditions = put(result, "dcc:influenceConditions") if known else result
    for name, celsius in known.items():
        condition = put(conditions, "dcc:influenceCondition")
        _text(condition, "dcc:name", f"temperature of the {name}")
        _real(_quantity(put(condition, "dcc:data"), "temperature"), celsius, r"\degreecelsius")


def _characteristic(result: Element, one: Characteristic) -> None:
    """Value with U, what was asked of it, and whether it conforms."""
    row = result_row(one)
    unit = UNITS[row["unit"]]
    _text(result, "dcc:name", one_line(one.name))
    if row["rule"]:
        _text(result, "dcc:description", one_line(row["rule"]))
    data = put(result, "dcc:data")
    measured = _quantity(data, "measured value", "basic_measuredValue")
    if row["value"] is None:
        _text(measured, "dcc:noQuantity", "not known")
    else:
        _uncertain(_real(measured, row["value"], unit), one, row["U"])
    if row["verdict"] in CONFORMITY:
        meta = put(put(measured, "dcc:measurementMetaData"), "dcc:metaData")
        put(meta, "dcc:norm", "ISO 14253-1")
        put(meta, "dcc:conformity", CONFORMITY[row["verdict"]])
    for key, name, kind in (
        ("nominal", "nominal value", "basic_nominalValue"),
        ("lower_limit", "lower limit", "basic_acceptanceLimitLower"),
        ("upper_limit", "upper limit", "basic_acceptanceLimitUpper"),
    ):
        if row[key] is not None:
            _real(_quantity(data, name, kind), row[key], unit)


def _uncertain(real: Element, one: Characteristic, U: float | None) -> None:
    """U, k, and how probable ±U covers the value by Student's distribution."""
    if U is None:
        return
    dof = degrees_of_freedom(one)
    covered = 2 * float(student.cdf(one.k, math.inf if dof is None else dof)) - 1
    expanded = put(put(real, "si:measurementUncertaintyUnivariate"), "si:expandedMU")
    put(expanded, "si:valueExpandedMU", decimal(U))
    put(expanded, "si:coverageFactor", decimal(one.k))
    put(expanded, "si:coverageProbability", f"{covered:.4f}")
    put(expanded, "si:distribution", "normal" if dof is None else "t")


def _quantity(parent: Element, name: str, kind: str = "") -> Element:
    quantity = put(parent, "dcc:quantity", **({"refType": kind} if kind else {}))
    _text(quantity, "dcc:name", name)
    return quantity


def _real(quantity: Element, value: float, unit: str) -> Element:
    real = put(quantity, "si:real")
    put(real, "si:value", decimal(value))
    put(real, "si:unit", unit)
    return real


def _text(parent: Element, name: str, *paragraphs: str) -> None:
    """A text of DCC: its paragraphs, each with its language."""
    text = put(parent, name)
    for paragraph in paragraphs:
        put(text, "dcc:content", paragraph, lang="en")
