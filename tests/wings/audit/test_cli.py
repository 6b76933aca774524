"""`trisect verify`, `audit` and `people` on the command line: their words in every language, wrong folders."""

import shutil

import pytest

from core.files.project.data import ProjectFile, new_project
from core.files.project.folder import create_project
from core.wings.audit.trail import append, read_trail
from tests.simulated import trisect
from tests.test_cli_language import left_in_english, words_of


@pytest.mark.accuracy
def test_no_command_prints_an_untranslated_word(simulated, measured, tmp_path):
    out, project = shutil.copytree(measured, tmp_path / "out"), tmp_path / "project"
    create_project(project, ProjectFile(new_project("2026")))
    assert left_in_english("verify", out, "--set", simulated) == set()
    assert left_in_english("people", project) == set()


@pytest.mark.parametrize("command", ["verify", "audit", "people"])
def test_a_wrong_folder_is_refused(tmp_path, command):
    said = trisect(command, tmp_path / "none")
    assert (said.code, bool(said.sentence)) == (2, True)


def test_the_audit_trail_has_no_untranslated_word_but_names_of_fields_and_what_people_wrote(tmp_path):
    project = tmp_path / "project"
    create_project(project, ProjectFile(new_project("2026")))
    append(project, "measured", files={"camera.json": "0" * 64})
    append(project, "reported")
    own = {
        word for entry in read_trail(project).entries for one in entry.changes for word in words_of(one.field, one.new)
    }
    who = words_of(read_trail(project).entries[0].who, read_trail(project).entries[0].host)
    assert len(own) > 20
    assert left_in_english("audit", project, "--remark", "seen by the customer") - own - set(who) == {
        *("seen", "the", "customer")
    }
