"""The kinds of features that the wing measures, and what of them is left where it is away."""

import inspect

import pytest

from core.door import WITHOUT
from core.files.plan.plan_file import read_plan, write_plan
from core.inspect.plan.control_frame import control_frames
from core.inspect.plan.kinds import brought_kinds, every_kind, kind_named
from core.wing import OUR_KINDS
from core.wings.geometry.kinds import KINDS
from tests.wings.geometry.test_control_frame import PLAN
from tests.wings.strangers import look_again
from workbench.pages.inspect.features import values as fields


@pytest.fixture
def away(monkeypatch):
    """The wing is left out."""
    monkeypatch.setenv(WITHOUT, "geometry")
    look_again()
    yield
    monkeypatch.undo()
    look_again()


def test_the_house_knows_the_names_of_its_kinds():
    assert [name for name, wing in OUR_KINDS.items() if wing == "geometry"] == [kind.name for kind in KINDS]
    assert [brought_kinds()[kind.name] for kind in KINDS] == [(kind, None) for kind in KINDS]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_kind_is_measured_by_a_function_of_a_feature_and_a_scene(kind):
    assert list(inspect.signature(kind.measure).parameters) == ["spec", "scene"]


def test_without_the_wing_a_plan_keeps_its_features_whole(away, tmp_path):
    assert not {kind.name for kind in every_kind()} & {kind.name for kind in KINDS}
    assert all(kind_named(kind.name).missing for kind in KINDS)
    write_plan(tmp_path / "plan.toml", PLAN)
    assert read_plan(tmp_path / "plan.toml") == PLAN and len(PLAN.ordered()) == len(PLAN.features)
    assert {name.split()[0] for name in control_frames(PLAN)} == {"top", "pin"}
    for spec in PLAN.features:
        renamed = fields.with_value(spec, "name", "other")
        assert (renamed.of, renamed.position, renamed.deviation) == (spec.of, spec.position, spec.deviation)
        assert not kind_named(spec.kind).missing or set(fields.values_of(spec)) <= {"name", "of 0", "of 1"}
