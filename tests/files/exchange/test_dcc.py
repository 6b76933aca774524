"""Digital calibration certificates: complete, in the order the schema wants, and true to the report."""

from dataclasses import replace

import pytest
from lxml import etree
from scipy.stats import norm

from core.errors import InputError
from core.files.exchange.dcc import NAMESPACES, UNITS, write_dcc

ORDER = {
    "digitalCalibrationCertificate": "administrativeData measurementResults",
    "administrativeData": "dccSoftware coreData items calibrationLaboratory respPersons customer statements",
    "software": "name release type",
    "coreData": "countryCodeISO3166_1 usedLangCodeISO639_1 mandatoryLangCodeISO639_1 uniqueIdentifier "
    "beginPerformanceDate endPerformanceDate performanceLocation",
    "item": "name identifications",
    "identification": "issuer value name",
    "contact": "name location",
    "customer": "name location",
    "measurementResult": "name usedMethods usedSoftware measuringEquipments influenceConditions results",
    "measuringEquipment": "name description certificate",
    "hash": "referral referralID procedure value",
    "result": "name description data",
    "quantity": "name noQuantity real measurementMetaData",
    "real": "value unit measurementUncertaintyUnivariate",
    "expandedMU": "valueExpandedMU coverageFactor coverageProbability distribution",
}
"""Children of elements as the sequences of DCC 3.3.0 and D-SI 2.2 have them."""


@pytest.fixture
def known(content):
    template = replace(content.template, name="Room 2", address=("Street 1",), country="DE")
    return replace(content, template=template, laboratory="", operator="A\nB", air_celsius=20.5, serial="")


@pytest.fixture
def document(tmp_path, known):
    write_dcc(tmp_path / "r.xml", known)
    return etree.parse(tmp_path / "r.xml").getroot()


def texts(document, path):
    return document.xpath(f"{path}/text()", namespaces=NAMESPACES)


def test_children_stand_in_the_order_of_the_schema(document):
    for element in document.iter():
        order = ORDER.get(etree.QName(element).localname)
        if order is not None:
            places = [order.split().index(etree.QName(child).localname) for child in element]
            assert places == sorted(places), element.tag
    assert document.get("schemaVersion") == "3.3.0"


def test_laboratory_person_and_part_are_named_and_what_is_not_stated_says_so(document, known):
    assert texts(document, "//dcc:calibrationLaboratory//dcc:content") == ["Room 2", "Street 1"]
    assert texts(document, "//dcc:respPerson//dcc:name/dcc:content") == ["A B"]
    assert texts(document, "//dcc:customer/dcc:name/dcc:content") == [known.customer or "not stated"]
    assert texts(document, "//dcc:coreData/dcc:uniqueIdentifier") == [known.report_id]
    assert texts(document, "//dcc:influenceConditions//si:value")[0] == "20.5"


def test_every_result_has_its_value_with_U_and_the_coverage_that_k_has(document, known):
    results = document.xpath("//dcc:result", namespaces=NAMESPACES)
    assert len(results) == len(known.characteristics)
    first = results[0].find(".//{*}real")
    assert (first.findtext("{*}value"), first.findtext("{*}unit")) == ("50.0123", UNITS["mm"])
    assert float(first.findtext(".//{*}valueExpandedMU")) == pytest.approx(known.characteristics[0].U)
    angle = results[3].find(".//{*}real")
    assert (angle.findtext("{*}value"), angle.findtext("{*}unit")) == ("89.95", UNITS["deg"])
    assert float(angle.findtext(".//{*}coverageProbability")) == pytest.approx(2 * norm.cdf(3) - 1, abs=1e-4)
    few = float(first.findtext(".//{*}coverageProbability"))
    assert few < 2 * norm.cdf(2) - 1 and first.findtext(".//{*}distribution") == "t", "few degrees of freedom"
    assert texts(results[6], ".//dcc:noQuantity/dcc:content") == ["not known"]


def test_conformity_is_stated_where_it_is_proven_and_limits_stand_beside(document):
    results = document.xpath("//dcc:result", namespaces=NAMESPACES)
    found = [texts(one, ".//dcc:conformity") for one in results]
    assert found == [["pass"], ["pass"], [], ["pass"], ["fail"], ["pass"], []]
    kinds = [one.get("refType") for one in results[0].iter("{*}quantity")]
    assert kinds[1:] == ["basic_nominalValue", "basic_acceptanceLimitLower", "basic_acceptanceLimitUpper"]
    assert any("no conformity is stated" in said for said in texts(document, "//dcc:declaration/dcc:content"))
    assert any("claims no accreditation" in said for said in texts(document, "//dcc:declaration/dcc:content"))


def test_both_calibrations_stand_with_their_hashes(document, known):
    assert texts(document, "//dcc:certificate/dcc:value") == [mark.sha256 for mark in known.calibrations]


@pytest.mark.parametrize(
    ("missing", "said"),
    [
        ({"country": ""}, "names the laboratory and its country"),
        ({"name": ""}, 'give name and country = "DE"'),
    ],
)
def test_without_laboratory_or_country_there_is_none(tmp_path, known, missing, said):
    with pytest.raises(InputError, match=said):
        write_dcc(tmp_path / "r.xml", replace(known, template=replace(known.template, **missing)))
    assert not (tmp_path / "r.xml").exists()


def test_without_a_result_there_is_none(tmp_path, known):
    with pytest.raises(InputError, match="no result to certify"):
        write_dcc(tmp_path / "r.xml", replace(known, inspected=(), gauge=None))
