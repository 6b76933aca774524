import math
from dataclasses import replace

import pytest
from lxml import etree

from core.files.exchange.qif import NAMESPACE, write_qif
from core.inspect.characteristic import Characteristic
from core.inspect.conformity import Limits
from core.inspect.plan.control_frame import ControlFrame

Q = {"q": NAMESPACE}


@pytest.fixture
def document(tmp_path, content):
    write_qif(tmp_path / "r.qif", replace(content, laboratory="Room\n2 \x01", operator=""))
    return etree.parse(tmp_path / "r.qif").getroot()


def test_it_is_a_qif_3_document_in_mm_and_degrees(document):
    assert etree.QName(document).text == f"{{{NAMESPACE}}}QIFDocument"
    assert document.get("versionQIF") == "3.0.0"
    units = dict(zip(document.xpath("//q:UnitName/text()", namespaces=Q),
                     document.xpath("//q:Factor/text()", namespaces=Q), strict=True))  # fmt: skip
    assert units == {"deg": "0.017453292519943295", "mm": "0.001"}


def test_ids_are_unique_up_to_the_largest_and_every_reference_is_there(document):
    ids = document.xpath("//@id")
    assert len(ids) == len(set(ids))
    assert max(map(int, ids)) == int(document.get("idMax"))
    references = document.xpath(
        "//*[substring(local-name(), string-length(local-name()) - 1) = 'Id']/text()", namespaces=Q
    )
    assert set(references) - {document.findtext("q:QPId", namespaces=Q)} <= set(ids) | {
        text for text in references if len(text) == 36
    }


def test_counts_say_how_many_there_are(document):
    for element in document.xpath("//*[@n]"):
        assert len(element) == int(element.get("n")), element.tag


def test_every_measurement_has_status_value_and_its_standard_uncertainty(document, content):
    measured = document.find(".//q:CharacteristicMeasurements", Q)
    names = [etree.QName(one).localname.removesuffix("CharacteristicMeasurement") for one in measured]
    assert names == ["Thickness", "Flatness", "Length", "Angle", "Height", "SphericalDiameter", "Length"]
    statuses = [one.findtext("q:Status/q:CharacteristicStatusEnum", namespaces=Q) for one in measured]
    assert statuses == ["PASS", "PASS", "NOT_ANALYZED", "PASS", "FAIL", "PASS", "INDETERMINATE"]
    value = measured[0].find("q:Value", Q)
    assert (value.text, value.get("combinedUncertainty"), value.get("meanError")) == ("50.0123", "0.005", "0")
    assert measured[3].findtext("q:Value", namespaces=Q) == "89.95"
    assert measured[6].find("q:Value", Q) is None, "not known"
    said = {one.get("name"): one.get("value") for one in measured[3].find("q:Attributes", Q)}
    assert said == {"k": "3", "verdict": "conforming", "decision rule": "ISO 14253-1", "U, deg": "0.06"}


def test_a_measurement_leads_to_what_was_asked(document):
    measurement = document.find(".//q:ThicknessCharacteristicMeasurement", Q)
    by_id = {one.get("id"): one for one in document.xpath("//*[@id]")}
    item = by_id[measurement.findtext("q:CharacteristicItemId", namespaces=Q)]
    nominal = by_id[item.findtext("q:CharacteristicNominalId", namespaces=Q)]
    definition = by_id[nominal.findtext("q:CharacteristicDefinitionId", namespaces=Q)]
    assert nominal.findtext("q:TargetValue", namespaces=Q) == "50"
    tolerance = definition.find("q:Tolerance", Q)
    assert [child.text for child in tolerance] == ["50.2", "49.8", "true"]
    flat = document.find(".//q:FlatnessCharacteristicDefinition", Q)
    assert flat.findtext("q:ToleranceValue", namespaces=Q) == "0.05"
    free = document.find(".//q:LengthCharacteristicDefinition", Q)
    assert free.findtext("q:NonTolerance", namespaces=Q) == "MEASURED"


@pytest.mark.parametrize(
    ("kind", "called", "sign", "shape"),
    [
        ("flatness", "Flatness", "", None),
        ("parallelism", "Parallelism", "", "PlanarZone"),
        ("parallelism", "Parallelism", "⌀", "DiametricalZone"),
        ("perpendicularity", "Perpendicularity", "⌀", "DiametricalZone"),
        ("position", "Position", "S⌀", "SphericalZone"),
        ("position", "Position", "⌀", "DiametricalZone"),
        ("profile", "SurfaceProfile", "", None),
    ],
)
def test_a_tolerance_zone_has_qifs_own_kind_in_the_order_of_its_schema(tmp_path, content, kind, called, sign, shape):
    asked = Characteristic(f"top {kind}", kind, 0.03, 0.004, limits=Limits(0.0, -math.inf, 0.1), doubts=())
    free = Characteristic(f"side {kind}", kind, 0.03, 0.004, doubts=())
    frames = {asked.name: ControlFrame(kind, 0.1, sign)}
    write_qif(tmp_path / "r.qif", replace(content, gauge=None, inspected=(asked, free), control_frames=frames))
    document = etree.parse(tmp_path / "r.qif").getroot()
    definitions, nominals = (document.find(f".//q:Characteristic{what}", Q) for what in ("Definitions", "Nominals"))
    names = [etree.QName(one).localname for one in definitions]
    assert names == [f"{called}CharacteristicDefinition", "LengthCharacteristicDefinition"]
    said = [etree.QName(one).localname for one in definitions[0]]
    assert said == ["Name", "ToleranceValue", *(["MaterialCondition", "ZoneShape"] if shape else [])]
    assert definitions[0].findtext("q:ToleranceValue", namespaces=Q) == "0.1"
    if shape:
        assert etree.QName(definitions[0].find("q:ZoneShape", Q)[0]).localname == shape
    assert nominals[0].find("q:TargetValue", Q) is None
    assert (nominals[0].find("q:CoordinateMethod", Q) is not None) == (kind == "position")


def test_one_that_fails_fails_the_part(document):
    assert document.xpath("//q:MeasurementResults/q:InspectionStatus//text()[normalize-space()]", namespaces=Q) == [
        "FAIL"
    ]


def test_the_same_result_gives_the_same_bytes_and_another_another_name(tmp_path, content):
    for name, what in (("a", content), ("b", content), ("c", replace(content, serial="X"))):
        write_qif(tmp_path / name, what)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    ids = [etree.parse(tmp_path / name).getroot().findtext("q:QPId", namespaces=Q) for name in "ac"]
    assert ids[0] != ids[1]


def test_without_any_characteristic_there_is_still_a_document(tmp_path, content):
    write_qif(tmp_path / "r.qif", replace(content, gauge=None, inspected=()))
    assert etree.parse(tmp_path / "r.qif").getroot().find("q:Characteristics", Q) is None
