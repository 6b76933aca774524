"""What other rooms say in English is said in German in a German report: notes, reasons, problems, rules."""

import ast
import re
from pathlib import Path

import pytest

import core
from core.report.german_notes import GERMAN_NOTES
from core.report.language import Words

ROOT = Path(core.__file__).parent
NOTES = (
    "calibrate/camera_notes.py", "calibrate/fan_summary.py", "calibrate/fan_verdict.py", "calibrate/plane_pose.py",
    "calibrate/located_pose.py", "calibrate/screening.py", "scan/datum.py", "scan/frame_reader.py", "scan/records.py",
    "scan/feature_notes.py", "scan/still_part.py", "scan/locate.py", "scan/fan_lines.py", "scan/calibration_check.py",
    "scan/reconstruct.py", "inspect/gauge.py", "inspect/evaluate.py", "inspect/temperature.py", "study/type1.py",
    "study/grr.py", "study/repeats.py", "study/repeats_budget.py", "study/acceptance.py", "pipeline/scan_step.py",
    "files/exchange/imported.py",
)  # fmt: skip
"""Modules that say something in notes, reasons and rules."""
PROBLEMS = (*(f"inspect/features/{path.name}" for path in sorted((ROOT / "inspect" / "features").glob("*.py"))),
            "inspect/cylinder.py", "inspect/surface_fit.py", "inspect/sphere.py")  # fmt: skip
"""Modules whose complaints are printed as the problem of a feature."""
PARTS = {
    ", and prove nothing",
    "fitted freely, the angles are NAME, and the planes miss one axis by up to 1.25 mm; p = 7",
    "it holds corners without finite coordinates",
    "NAME: this suits the laser",
}
"""Pieces of sentences that stand in the table as a whole."""
WHOLE = {
    "The stated uncertainties do not hold that of NAME: they are less than is knownNAME.": (
        "The stated uncertainties do not hold that of the fan: they are less than is known, and prove nothing."
    ),
    "NAME frameNAME lost while recording: camera, computer or disk were too slow.": (
        "3 frames were lost while recording: camera, computer or disk were too slow."
    ),
    "diameter of the NAME of least squares, by the points' covariance": (
        "diameter of the sphere of least squares, by the points' covariance"
    ),
    "range that holds 95 % of the deviations from the NAME": "range that holds 95 % of the deviations from the sphere",
}
"""Sentences whose places hold pieces of words, as they come out."""
DE = Words("de")


def said(path, *, complaints):
    """Every text of a module that has four words or more, with something in its places."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    skipped = set()
    for node in ast.walk(tree):
        for line in getattr(node, "body", None) if isinstance(getattr(node, "body", None), list) else ():
            if isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant):
                skipped.add(line.value)  # a docstring
        if isinstance(node, ast.Raise) and not complaints:
            skipped |= set(ast.walk(node))
        if isinstance(node, ast.JoinedStr):
            skipped |= set(node.values)
    for node in ast.walk(tree):
        if node in skipped:
            continue
        if isinstance(node, ast.JoinedStr):
            text = "".join(part.value if isinstance(part, ast.Constant) else filled(part) for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            text = node.value
        else:
            continue
        if text.count(" ") >= 3:
            yield text


def filled(place):
    spec = "" if place.format_spec is None else ast.unparse(place.format_spec)
    return "1.25" if re.search(r"\.[1-9]f", spec) else "7" if spec else "NAME"


def is_german(text):
    shown = DE.known(text)
    return shown != text or DE.known(f"{text}.") != f"{text}."


@pytest.mark.parametrize(
    ("path", "complaints"), [*((path, False) for path in NOTES), *((path, True) for path in PROBLEMS)]
)
def test_everything_a_module_says_has_its_german(path, complaints):
    texts = {WHOLE.get(text, text) for text in said(ROOT / path, complaints=complaints)} - PARTS
    assert sorted(text for text in texts if not is_german(text)) == []


@pytest.mark.parametrize(
    ("english", "german"),
    [
        ("The relief under the fan fixes the scale to 0.023 %.",
         "Das Relief unter dem Fächer legt den Maßstab auf 0,023 % fest."),
        ("block thickness: Stated at 20 °C: -0.75 µm for a part at 21.3 °C.",
         "block thickness: Angegeben bei 20 °C: -0,75 µm für ein Teil bei 21,3 °C."),
        ("2 of 9 poses left out: a1 (no stripe was found: is the fan on?); b2.0 (left out by hand)",
         "2 von 9 Posen ausgelassen: a1 (kein Streifen gefunden: ist der Fächer an?); b2.0 (von Hand ausgelassen)"),
        ("There is no corner in the upper left, top and right of the picture: take a view that reaches there.",
         "Keine Ecke liegt hier im Bild: oben links, oben und rechts; eine Ansicht aufnehmen, die dorthin reicht."),
        ("feature ball: its region holds no measured point; draw it over what the scan covers, or allow a larger σ.",
         "Merkmal ball: sein Bereich enthält keinen gemessenen Punkt; ihn über Aufgenommenes ziehen oder ein größeres "
         "σ zulassen."),
    ],
)  # fmt: skip
def test_places_take_over_names_numbers_reasons_and_lists(english, german):
    assert DE.known(english) == german


@pytest.mark.parametrize("foreign", ["Hergestellt 1.5 Tage zuvor", "Was (wer weiß); das: so, und so", "", "1.25 mm"])
def test_what_is_not_in_the_table_stays_as_it_is(foreign):
    assert DE.known(foreign) == foreign


def test_a_sentence_in_german_has_the_places_of_the_english_one():
    for english, german in GERMAN_NOTES.items():
        assert sorted(re.findall(r"{\w+}", english)) == sorted(re.findall(r"{\w+}", german)), english
