"""A comparison in the report."""

import math
from dataclasses import replace

from core.report.content import BroughtSection
from core.report.pdf import build_report
from core.wings.geometry.comparison.comparison_file import ChangedPart, ComparisonFile
from core.wings.geometry.comparison.facts import comparison_facts
from tests.report.report_samples import block_content
from tests.report.test_report_inspection import words


def test_a_comparison_is_told_in_figures():
    changed, same = ChangedPart(0.25, -0.1, -0.12), ChangedPart(0.0, math.nan, math.nan)
    found = ComparisonFile(
        "before.ply", "best fit", 1300, changed, same, lod95_mm=0.06, diameter_mm=12.0, reach_mm=5.0,
        registration_mm=0.002, calibration_id="",
    )  # fmt: skip
    section = BroughtSection("Comparison", comparison_facts(found), name="comparison")
    content = replace(block_content(), below_results={"comparison": section})
    text = words(build_report(content)).replace("\u00a0", " ")
    assert "Compared with Aligned Less material More material before.ply best fit" in text
    assert "25.0 % of the places, mean −0.100 mm, at most −0.120 mm" in text and "nowhere significant" in text
    assert "0.060 mm 0.0020 mm 1 300 12 mm" in text
    text = words(build_report(replace(content, hidden=frozenset({"comparison"}))))
    assert "Compared with" not in text and "Left out of this report by choice: Comparison." in text
