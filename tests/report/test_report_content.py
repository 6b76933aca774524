from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from core.findings.proof import OF_SCAN
from core.messages import ENGLISH, plain
from core.report.content import Overlay
from core.report.facts.pictures import left_out
from core.report.layout.paragraph import Paragraph
from core.report.layout.style import ACCENT, ALARM, ReportLook, color, prepare_reportlab
from core.report.pdf import LIMITS
from core.report.sections.evidence import warnings
from core.report.sections.head import head
from core.report.sections.standard import faces_table
from core.report.wording import Words

from .report_samples import block_content, overlay


@pytest.fixture(scope="module")
def content():
    return block_content()


def test_report_id_comes_from_the_inputs_and_not_from_the_clock(content):
    again = replace(content, timestamp=datetime(2030, 1, 1, tzinfo=UTC))
    assert again.report_id == content.report_id
    hashes = dict(content.hashes)
    hashes["rig.toml"] = "0" * 64
    assert replace(content, hashes=hashes).report_id != content.report_id


def test_report_id_differs_for_other_settings_and_versions(content):
    names = {
        content.report_id,
        replace(content, settings={"method": "three-crossings"}).report_id,
        replace(content, version="0.2.0").report_id,
    }
    assert len(names) == 3


def test_order_of_the_hashes_does_not_matter(content):
    backwards = dict(reversed(content.hashes.items()))
    assert replace(content, hashes=backwards).report_id == content.report_id


def test_frames_left_out_come_by_reason_commonest_first(content):
    reasons = left_out(content.frames)
    assert reasons[0] == (plain("no sweep stripe found"), ["frame_017.png", "frame_018.png"])
    assert len(reasons) == 3


def test_notes_of_gauge_and_calibrations_are_printed_once(content):
    noted = replace(
        content,
        camera=replace(content.camera, notes=(plain("Too few tilts."), content.notes[0])),
        gauge=replace(content.gauge, notes=(plain("The faces are small."),)),
    )
    assert [str(note) for note in noted.all_notes] == [
        *map(str, content.notes),
        "The faces are small.",
        "Too few tilts.",
    ]


def test_a_change_of_the_rig_is_printed_first_and_in_red(content):
    changed = replace(content, notes=(*content.notes, OF_SCAN["rig_changed"].note))
    assert changed.all_notes[0] == OF_SCAN["rig_changed"].note
    prepare_reportlab()
    (section,) = warnings(ReportLook(Words(ENGLISH), ACCENT), changed, LIMITS[0])
    told = [one for one in section._content if isinstance(one, Paragraph) and one.style.name in ("alarm", "bullet")]
    assert [one.style.textColor == color(ALARM) for one in told] == [True] + [False] * (len(changed.all_notes) - 1)
    assert told[0].getPlainText() == str(OF_SCAN["rig_changed"].note)


def test_overlay_refuses_what_does_not_fit_together():
    good = overlay()
    with pytest.raises(ValueError, match="uint8"):
        replace(good, picture=good.picture.astype(np.float64))
    with pytest.raises(ValueError, match="sweep_sigma"):
        Overlay(good.name, good.picture, good.fan, good.sweep, good.sweep_sigma[:1], good.crossings)


def test_the_flatness_of_a_face_is_printed_with_its_uncertainty(content):
    gauge = replace(content.gauge, upper=replace(content.gauge.upper, flatness_mm=0.016, flatness_u_mm=0.0095))
    prepare_reportlab()
    look = ReportLook(Words(), ACCENT)
    table = next(part for part in faces_table(look, gauge) if hasattr(part, "_cellvalues"))
    (flatness, *_) = table._cellvalues[1][1:]
    assert flatness.getPlainText().replace("\xa0", " ") == "0.016 ± 0.019"


@pytest.mark.parametrize(("simulated", "told"), [(True, 1), (False, 0), (None, 0)])
def test_only_of_a_simulated_scan_the_head_says_so(simulated, told):
    content = replace(block_content(), simulated=simulated)
    said = [part for part in head(ReportLook(Words(), ACCENT), content) if isinstance(part, Paragraph)]
    assert [part.getPlainText().startswith("Simulated: ") for part in said] == [True] * told
