"""The program is under MIT, and stands on nothing that would make it otherwise."""

import sys
from email.message import Message

import pytest

from tests.licences import NOTICE, REASONS, WRITTEN_ON, licence, notice, runtime_licences


def test_no_runtime_dependency_binds_the_program_by_its_licence():
    licences = runtime_licences()
    assert {"numpy", "pyside6-essentials", "kiwisolver", "harvesters"} <= {one.package for one in licences}
    assert [one.refusal for one in licences if one.refusal] == []


def test_every_exception_is_still_needed():
    assert set(REASONS) <= {one.package for one in runtime_licences()}


@pytest.mark.parametrize(
    ("head", "value", "said"),
    [
        ("License", "GNU GENERAL PUBLIC LICENSE\n  Version 3", "one is under GNU GENERAL"),
        ("Classifier", "License :: OSI Approved :: GNU Affero General Public License v3", "one is under GNU Affero"),
        ("License-Expression", "LGPL-3.0-only", "one is under LGPL-3.0-only"),
        ("License-Expression", "MIT AND GPL-2.0-or-later", "one is under MIT AND GPL"),
        ("Summary", "a package", "one states no licence"),
    ],
)
def test_a_licence_that_binds_is_refused(head, value, said):
    metadata = Message()
    metadata["Name"] = "one"
    metadata[head] = value
    assert licence("one", metadata).refusal.startswith(said)


def test_the_notice_is_current():
    kept = NOTICE.read_text(encoding="utf-8")
    if sys.version_info[:2] == WRITTEN_ON:
        assert kept == notice(), "write it with `make notice`"
    else:  # which needs fewer packages
        assert set(notice().splitlines()) <= set(kept.splitlines())
