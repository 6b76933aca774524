"""A thickness that was not found: whether that ends a job."""

from dataclasses import replace

from core.errors import NoThickness
from core.files.recording.rig import GaugeSpec, default_rig
from core.messages import plain
from core.pipeline.steps.gauge_step import Thickness, missing_thickness

PROBLEM = NoThickness(plain("there are no two parallel faces"))
ASKED, NOT_ASKED = replace(default_rig(), gauge=GaugeSpec(50.0, 0.2)), replace(default_rig(), gauge=None)


def test_a_thickness_that_was_not_found_ends_a_job_only_where_it_is_asked_for():
    assert missing_thickness(ASKED, PROBLEM) is PROBLEM and missing_thickness(NOT_ASKED, PROBLEM) is None
    assert missing_thickness(ASKED, None) is None, "it was found"


def test_why_there_is_no_thickness_is_a_note_of_the_scan():
    assert Thickness(None).note is None
    note = Thickness(None, PROBLEM).note
    assert note is not None and "no two parallel faces" in str(note)
