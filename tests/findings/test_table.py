"""The table of findings holds every note, and no other; each call that makes a note gives what its text tells."""

import ast
import re
from dataclasses import fields

import pytest

from core.findings import of_proof
from core.findings.finding import Effect, Finding, Weight
from core.findings.of_proof import DAY
from core.findings.proof import ScanFacts
from core.findings.table import FINDINGS, all_findings, note_of
from core.messages import plural_message
from tests.code import ROOT, modules, nodes
from tests.translations import all_texts, called, literals, texts

pytestmark = pytest.mark.usefixtures("syntax_trees")

ROOMS = (
    *("core/calibrate/", "core/image/", "core/scan/", "core/inspect/", "core/checks/", "core/pipeline/steps/"),
    "core/wings/studies/kinds/",
)
"""Rooms whose sentences are notes of results."""
LIVE = ("core/calibrate/camera/capture.py", "core/calibrate/camera/missing.py", "core/scan/preview/")
"""What these say is of the moment: of one picture, one crossing, the next sweep."""
ANSWERS = {"readjust.undone"}
"""What a command answers."""
OF_ONE_RESULT = {
    "carrier_as_printed", "few_marks_fit", "marks_apart", "part_may_have_slipped", "slip_unseen",
    "faces_not_spanned", "joint_hangs_on_one_mark", "joint_inside_out", "light_skewed",
    "marks_disagree", "master_doubted", "overlap_disagrees", "several_faces", "u_incomplete",
}  # fmt: skip
"""Facts that take away the proof of one result."""
OF_THE_DAY = {
    "calibration_lapsed", "calibration_undated", "check_failed", "check_lapsed", "history_unreadable", "never_checked",
    "planes_disagree",
}  # fmt: skip
"""Facts of the day of a scan."""
NOT_KNOWN = {"scan_unknown", "planes_unknown"}
"""That facts of a scan are not known."""


def wrong_calls(of_module):
    """(line, code, why) of each call of `note_of` in a module, given all its nodes, that fails when it is run."""
    for node in of_module:
        if isinstance(node, ast.Call) and called(node) == "note_of":
            given = {keyword.arg for keyword in node.keywords}
            codes = literals(node.args[0]) or [""]
            for code in codes:
                if code not in all_findings():
                    yield node.lineno, code, "has no row"
                elif given != all_findings()[code].places:
                    yield node.lineno, code, f"tells {sorted(all_findings()[code].places)}"


def test_when_a_finding_holds_is_written_once():
    """In the table by its fact (`core.findings.proof`), or at the one call that makes its note."""
    by_fact = {row.code for row in (*of_proof.SCAN, *of_proof.PLANES)}
    told = [
        code
        for path in modules("core", "workbench", "trisect")
        for node in nodes(path)
        if isinstance(node, ast.Call) and called(node) == "note_of"
        for code in literals(node.args[0])
    ]
    assert sorted(told) == sorted(all_findings().keys() - by_fact), "each once, and none of a fact of a scan"


def test_every_note_that_is_made_has_a_row_and_gets_what_its_text_tells():
    found = [
        f"{path.relative_to(ROOT)}:{line} {code} {why}"
        for path in modules("core", "workbench", "trisect")
        for line, code, why in wrong_calls(nodes(path))
    ]
    assert found == [], "a code of the table, and its values by name: no ** hides them"


@pytest.mark.parametrize(
    ("call", "why"),
    [
        ('note_of("camera.no_such_code")', "has no row"),
        ("note_of(code, n=1, least=2)", "has no row"),
        ('note_of("camera.few_views", n=1)', "tells ['least', 'n']"),
        ('table.note_of("camera.few_views", n=1, least=2, more=3)', "tells ['least', 'n']"),
        ('note_of("camera.few_views", **values)', "tells ['least', 'n']"),
        ('note_of("camera.misfound_corners", view=name)', "tells ['n', 'view']"),
        ('note_of("profile.stood_still" if x else "camera.few_views")', "tells ['least', 'n']"),
        ('note_of("camera.few_views", n=1, least=2)', None),
        ('note_of("profile.stood_still" if x else "profile.one_line_on_part")', None),
    ],
)
def test_a_call_that_would_fail_is_seen(call, why):
    assert [why for *_, why in wrong_calls(list(ast.walk(ast.parse(call))))] == ([] if why is None else [why])


def test_values_that_are_not_those_of_the_text_are_refused():
    for values in ({"n": 1}, {"n": 1, "least": 2, "more": 3}):
        with pytest.raises(ValueError, match="tells"):
            note_of("camera.few_views", **values)
    with pytest.raises(KeyError):
        note_of("camera.no_such_code")


def test_a_note_that_counts_has_a_text_for_one_and_one_for_more():
    one, many = "One misfound corner of {view} is left out.", "{n} misfound corners of {view} are left out."
    for n in (1, 3):
        told = note_of("camera.misfound_corners", view="a", n=n)
        assert told == plural_message("camera.misfound_corners", one, many, n=n, view="a")
        assert list(told.values) == ["n", "view"]


def test_no_other_call_tells_a_text_of_the_table():
    rows = re.compile(r"core/(findings/of_\w+|wings/\w+/findings)\.py")
    elsewhere = {text.code for text in all_texts() if not rows.fullmatch(text.path)}
    assert elsewhere & set(all_findings()) == set()


def test_what_takes_away_a_proof_is_grave_and_nothing_else_names_a_fact():
    with pytest.raises(ValueError, match="is not grave"):
        Finding("scan.x", Weight.CAUTION, Effect.NO_PROOF, "It moved.")
    with pytest.raises(ValueError, match="takes away none"):
        Finding("scan.x", Weight.GRAVE, Effect.NONE, "It moved.", fact="moved")
    with pytest.raises(ValueError, match="by no fact"):
        Finding("scan.x", Weight.GRAVE, Effect.NO_PROOF, "It moved.")


def test_what_takes_away_a_proof_names_the_fact_that_does_so():
    named = {row.fact for row in FINDINGS.values() if row.effect == Effect.NO_PROOF}
    of_scan = {one.name for one in fields(ScanFacts)} - {DAY}
    assert named == of_scan | OF_THE_DAY | OF_ONE_RESULT | NOT_KNOWN


def test_every_sentence_that_is_told_of_a_result_is_a_row_of_the_table():
    told = {
        text.code
        for text in texts(*ROOMS)
        if text.code and text.english[0].endswith(".") and not text.path.startswith(LIVE)
    }
    assert told == ANSWERS
