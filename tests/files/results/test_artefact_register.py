"""The register of artefacts: the user's own, and that beside rig.toml."""

from datetime import date

import pytest

from core.checks.artefact_check import Artefact
from core.errors import InputError
from core.files.results.artefact_register import (
    REGISTER,
    artefact_named,
    change_own,
    own_register,
    read_register,
    store_own,
)
from core.files.results.rig_history import own_folder

BLOCK = '[[artefact]]\nid = "GB 50-7"\nvalue_mm = 50.0003\nU_mm = 0.0004\ncertificate = "D-K-15070"\ndue = 2028-03-01\n'


@pytest.fixture
def own():
    own_folder().mkdir(parents=True)
    return own_folder() / REGISTER


def test_artefacts_are_the_users_own_and_those_beside_the_rig(own, tmp_path):
    own.write_text(BLOCK + '[[artefact]]\nid = "step 10"\nvalue_mm = 10.0\nU_mm = 0.001\nk = 3.0\n')
    assert artefact_named("GB 50-7", tmp_path) == Artefact(
        "GB 50-7", 50.0003, 0.0004, 2.0, "D-K-15070", date(2028, 3, 1)
    )
    (tmp_path / REGISTER).write_text(BLOCK.replace("50.0003", "50.0001"))
    assert artefact_named("GB 50-7", tmp_path).value_mm == 50.0001, "the one beside the rig counts"
    assert artefact_named("step 10", tmp_path).k == 3.0


def test_an_artefact_that_is_in_no_register_is_told_with_those_that_are(own, tmp_path):
    assert read_register(tmp_path) == {}
    own.write_text(BLOCK)
    with pytest.raises(InputError, match=r"there is no artefact GB 50-8 in artefacts\.toml, which has GB 50-7"):
        artefact_named("GB 50-8", tmp_path)


@pytest.mark.parametrize(
    ("wrong", "field"),
    [("U_mm = -1", "U_mm"), ("U_mm = 0.1\ndue = 7", "due"), ("U_mm = 0.1\ncolour = 1", "colour"), ("", "U_mm")],
)
def test_a_wrong_register_is_named_with_the_field(tmp_path, wrong, field):
    (tmp_path / REGISTER).write_text(f'[[artefact]]\nid = "a"\nvalue_mm = 50.0\n{wrong}\n')
    with pytest.raises(InputError, match=rf"artefacts\.toml.*{field}"):
        read_register(tmp_path)


@pytest.mark.parametrize(
    "before", ["", "# of the lab\n" + BLOCK, 'artefact = [{ id = "GB 50-7", value_mm = 50.0003, U_mm = 0.0004 }]\n']
)
def test_an_artefact_is_added_to_the_users_own_after_what_stands_there(before):
    path = own_folder() / REGISTER
    if before:
        path.parent.mkdir(parents=True)
        path.write_text(before)
    known = dict(own_register())
    step = Artefact('step "10"', 10.0, 5e-05, 3.0, "", date(2027, 6, 30))
    assert store_own(step) == own_register() == {**known, step.id: step}
    assert ("# of the lab" in path.read_text()) == ("#" in before), "what was written by hand is kept"
    with pytest.raises(InputError, match=r"there is an artefact step .* already"):
        store_own(step)


STEP = '[[artefact]]\nid = "step 10"\nkind = "step"\nvalue_mm = 10.0\nU_mm = 0.001\n'


def test_an_artefact_without_a_kind_is_a_block_and_no_other_kind_is_known(tmp_path):
    (tmp_path / REGISTER).write_text(BLOCK + STEP)
    assert [one.kind for one in read_register(tmp_path).values()] == ["block", "step"]
    (tmp_path / REGISTER).write_text(STEP.replace('"step"', '"cone"'))
    with pytest.raises(InputError, match=r'kind.*"block", "sphere" or "step"'):
        read_register(tmp_path)


@pytest.mark.parametrize("to", [Artefact("step 11", 11.0, 0.002, kind="step"), None], ids=["changed", "removed"])
def test_an_artefact_of_the_users_own_is_changed_or_removed_and_the_rest_stays_as_it_was_written(own, to):
    own.write_text("# of the lab\n" + STEP + "\n# the old block\n" + BLOCK)
    known = change_own("step 10", to)
    assert known == own_register() and list(known) == [*([to.id] if to else []), "GB 50-7"]
    assert all(line in own.read_text() for line in ("# of the lab", "# the old block", *BLOCK.splitlines()))
    assert "step 10" not in own.read_text()
    change_own("GB 50-7", None)
    assert list(own_register()) == ([to.id] if to else []) and "# of the lab" in own.read_text()


def test_a_register_in_one_line_is_written_anew_where_an_artefact_is_changed(own):
    own.write_text('artefact = [{ id = "a", value_mm = 50.0, U_mm = 0.1 }, { id = "b", value_mm = 9.0, U_mm = 0.1 }]\n')
    assert list(change_own("a", Artefact("c", 50.0, 0.2))) == list(own_register()) == ["c", "b"]
    with pytest.raises(InputError, match="there is no artefact a any more"):
        change_own("a", None)
    with pytest.raises(InputError, match="there is an artefact b already"):
        change_own("c", Artefact("b", 50.0, 0.2))
