"""Results as CSV, XLSX, JSON and DFQ, read back by others."""

import csv
import json
import math
import re
from dataclasses import replace
from datetime import UTC, datetime
from importlib.resources import files

import pytest
from openpyxl import load_workbook

from core.files.exchange.dfq import write_dfq
from core.files.exchange.records import write_result_csv
from core.files.exchange.result_json import write_result_json
from core.files.exchange.xlsx import write_xlsx
from core.messages import visible

WRITERS = {"csv": write_result_csv, "json": write_result_json, "xlsx": write_xlsx, "dfq": write_dfq}


@pytest.mark.parametrize("kind", WRITERS)
def test_the_same_result_gives_the_same_bytes(tmp_path, content, kind):
    for name in ("a", "b"):
        WRITERS[kind](tmp_path / name, content)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


@pytest.mark.parametrize("kind", WRITERS)
def test_without_any_characteristic_there_is_still_a_file(tmp_path, content, kind):
    WRITERS[kind](tmp_path / "a", replace(content, gauge=None, inspected=()))
    assert (tmp_path / "a").stat().st_size > 0


def test_a_spreadsheet_reads_a_line_for_each_characteristic(tmp_path, content):
    write_result_csv(tmp_path / "r.csv", content)
    with (tmp_path / "r.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"].lstrip("'") for row in rows] == [one.name for one in content.inspected]
    first, angle, ball = rows[0], rows[3], rows[5]
    assert (float(first["value"]), first["unit"], float(first["U"])) == (50.0123, "mm", 0.01)
    assert (first["verdict"], float(first["lower_limit"])) == ("conforming", 49.8)
    assert (angle["unit"], float(angle["value"])) == ("deg", pytest.approx(89.95, abs=1e-12))
    assert (float(ball["lower_limit"]), ball["upper_limit"]) == (49.9, "")
    assert (rows[6]["value"], rows[6]["verdict"], rows[2]["verdict"]) == ("", "not proven", "none")


def test_the_workbook_has_result_budget_frames_and_settings_with_full_numbers(tmp_path, content):
    write_xlsx(tmp_path / "r.xlsx", content)
    book = load_workbook(tmp_path / "r.xlsx")
    assert book.sheetnames == ["result", "budget", "frames", "facts", "settings"]
    result = [dict(zip([c.value for c in book["result"][1]], [c.value for c in row], strict=True))
              for row in book["result"].iter_rows(min_row=2)]  # fmt: skip
    assert [row["measured"] for row in result[:2]] == [50.0123, 0.031]
    assert result[6]["measured"] is None
    budget = list(book["budget"].iter_rows(min_row=2, values_only=True))
    assert budget[1][:7] == ("thickness", "temperature of the part", 20.4, "°C", "rectangular", 0.5, 0.006)
    assert budget[1][9] == 8
    assert budget[0][9] is None, "infinitely many degrees of freedom"
    assert book["frames"].max_row == 1 + len(content.frames)
    settings = dict(book["settings"].iter_rows(min_row=2, values_only=True))
    assert settings["SHA-256 over all inputs"] == content.inputs_digest
    assert settings["rig"] == "0123456789ab"
    assert book.properties.modified == datetime(2026, 3, 14, 15, 9, 26)


def test_a_name_like_a_formula_stays_a_text(tmp_path, content):
    write_xlsx(tmp_path / "r.xlsx", content)
    cell = load_workbook(tmp_path / "r.xlsx")["result"]["A6"]
    assert (cell.value, cell.data_type) == ("=step(2)", "s")


def broken(value, rule, schema, where="file"):
    """What of `value` is not as a JSON schema's rule asks: as much of the language as our schema uses."""
    if "$ref" in rule:
        return broken(value, schema["$defs"][rule["$ref"].rpartition("/")[2]], schema, where)
    kinds = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool,
             "null": type(None)}  # fmt: skip
    wanted = rule.get("type", [])
    wanted = [wanted] if isinstance(wanted, str) else wanted
    of_kind = [kind for kind in wanted if isinstance(value, kinds[kind])]
    if isinstance(value, bool) and wanted and "boolean" not in wanted:
        of_kind = []
    if wanted and not of_kind:
        return [f"{where} is {value!r}, not {wanted}"]
    found = []
    checks = {
        "const": lambda r: value == r,
        "enum": lambda r: value in r,
        "pattern": lambda r: re.search(r, value) is not None,
        "minimum": lambda r: value >= r,
        "maximum": lambda r: value <= r,
        "exclusiveMinimum": lambda r: value > r,
    }
    found += [
        f"{where} = {value!r} breaks {key}" for key, check in checks.items() if key in rule and not check(rule[key])
    ]
    known = {*checks, "type", "title", "description", "$schema", "$defs", "required", "properties", "items",
             "additionalProperties"}  # fmt: skip
    assert not set(rule) - known, "the schema uses what this check does not know"
    if isinstance(value, dict):
        properties, others = rule.get("properties", {}), rule.get("additionalProperties", True)
        found += [f"{where} lacks {key}" for key in rule.get("required", []) if key not in value]
        for key, item in value.items():
            if key in properties:
                found += broken(item, properties[key], schema, f"{where}.{key}")
            elif others is False:
                found.append(f"{where} has {key}, which the schema does not know")
            elif isinstance(others, dict):
                found += broken(item, others, schema, f"{where}.{key}")
    if isinstance(value, list) and "items" in rule:
        for place, item in enumerate(value):
            found += broken(item, rule["items"], schema, f"{where}[{place}]")
    return found


@pytest.fixture(scope="module")
def schema():
    return json.loads(files("resources").joinpath("report", "measurement.schema.json").read_text(encoding="utf-8"))


def test_json_is_as_its_schema_says(tmp_path, content, schema):
    write_result_json(tmp_path / "r.json", content)
    tables = json.loads((tmp_path / "r.json").read_text())
    assert broken(tables, schema, schema) == []
    first = tables["characteristics"][0]
    assert (first["value"], first["U"], first["verdict"]) == (50.0123, 0.01, "conforming")
    assert math.hypot(*(row["contribution"] for row in first["budget"])) == pytest.approx(first["u"])
    assert first["effective_dof"] == pytest.approx(0.005**4 / (0.003**4 / 8))
    assert tables["report_id"] == content.report_id


def test_the_schema_finds_what_is_wrong(tmp_path, content, schema):
    write_result_json(tmp_path / "r.json", content)
    tables = json.loads((tmp_path / "r.json").read_text())
    for spoil in (
        lambda t: t.pop("frames"),
        lambda t: t.update(more=1),
        lambda t: t["characteristics"][0].update(verdict="fine"),
        lambda t: t["characteristics"][0].update(value="50"),
        lambda t: t["software"].update(version=1),
    ):
        copy = json.loads(json.dumps(tables))
        spoil(copy)
        assert broken(copy, schema, schema)


def keys_of(path, encoding):
    data = path.read_bytes()
    assert data.endswith(b"\r\n")
    assert data.count(b"\n") == data.count(b"\r\n")
    return dict(line.split(" ", 1) for line in data.decode(encoding).splitlines())


def test_dfq_has_description_limits_and_value_of_each_characteristic(tmp_path, content):
    write_dfq(tmp_path / "r.dfq", content)
    keys = keys_of(tmp_path / "r.dfq", "cp1252")
    assert next(iter(keys.items())) == ("K0100", "7")
    assert (keys["K1001"], keys["K1002"]) == ("GB-50-0417", "Gauge block 50 mm")
    assert (keys["K2001/2"], keys["K2002/2"]) == ("2", "Ebenheit größer")
    assert [keys[f"{key}/1"] for key in ("K2022", "K2101", "K2110", "K2111", "K2120", "K2121", "K2142")] == [
        "3", "50", "49.8", "50.2", "1", "1", "mm"]  # fmt: skip
    assert "U = 0.010 mm (k = 2); verdict: conforming" in keys["K2900/1"]
    assert "K2110/2" not in keys, "a form has no lower limit"
    assert (keys["K2120/2"], keys["K2121/2"]) == ("0", "1")
    assert (keys["K0001/4"], keys["K2142/4"]) == ("89.95", "deg")
    assert (keys["K0001/1"], keys["K0002/1"], keys["K0004/1"]) == ("50.0123", "0", "14.3.2026/15:09:26")
    assert (keys["K2002/7"], keys["K0002/7"]) == ("gap of two", "255"), "one line, and no valid value"


def test_dfq_with_letters_beyond_latin_is_utf_8_with_its_mark(tmp_path, content):
    write_dfq(tmp_path / "r.dfq", replace(content, part="校正ブロック"))
    assert (tmp_path / "r.dfq").read_bytes().startswith(b"\xef\xbb\xbf")
    assert keys_of(tmp_path / "r.dfq", "utf-8-sig")["K1002"] == "校正ブロック"


def test_times_of_another_zone_stay_what_the_clock_there_showed(tmp_path, content):
    write_dfq(tmp_path / "r.dfq", replace(content, timestamp=datetime(2026, 12, 1, 7, 8, 9, tzinfo=UTC)))
    assert keys_of(tmp_path / "r.dfq", "cp1252")["K0004/1"] == "1.12.2026/07:08:09"


@pytest.mark.parametrize("name", ['=HYPERLINK("http://x")', "+1", "-1+1", "@SUM(A1)", "\t=1", " =1", "\r=1"])
def test_no_name_becomes_a_formula_and_numbers_stay_numbers(tmp_path, content, name):
    first = replace(content.inspected[0], name=name, value=-1.5)
    write_result_csv(tmp_path / "r.csv", replace(content, inspected=(first,)))
    with (tmp_path / "r.csv").open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert row["name"] == visible(f"'{name}")
    assert float(row["value"]) == -1.5
