"""Kinds of features and checks that other packages bring."""

import sys

import numpy as np
import pytest

from core.errors import InputError
from core.files.plan.plan_file import read_plan
from core.inspect.evaluate import evaluate
from core.inspect.plan import plugins as plugins_module
from core.inspect.plan.feature_spec import FeatureSpec
from core.inspect.plan.inspection_plan import InspectionPlan
from core.inspect.plan.kinds import every_kind, kind_named
from core.inspect.plan.plugins import CHECKS_GROUP, KINDS_GROUP
from core.messages import ENGLISH
from tests.inspect.block_scan import BlockScan

SOURCE = """
from dataclasses import replace
from core.inspect.features.plane import measure_plane
from trisect import FeatureKind, ResultKind

def measure_wear(spec, scene):
    if spec.name == "broken":
        raise ZeroDivisionError("no sweeps")
    return measure_plane(replace(spec, kind="plane"), scene)

WEAR = FeatureKind("wear", "{module}:measure_wear", "Wear", "How a face is worn", "mdi6.saw-blade",
                   results=(ResultKind("flatness", one_sided=True),), element="plane", automatic="numbered")
TAKEN = replace(WEAR, name="plane")
NO_KIND = 7

def few_points(inspection):
    return [f"{{one.spec.name}} rests on {{len(one.indices)}} points" for one in inspection.results if not one.problem]

def breaks(inspection):
    return [1 / 0]
"""


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Install a package that brings these entry points, by group."""

    def install(version="1.2", **groups):
        module = f"lab_wear_{len(list(tmp_path.iterdir()))}"
        (tmp_path / f"{module}.py").write_text(SOURCE.format(module=module))
        info = tmp_path / "lab_wear.dist-info"
        info.mkdir(exist_ok=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: lab-wear\nVersion: {version}\n")
        lines = [
            f"[{dict(kinds=KINDS_GROUP, checks=CHECKS_GROUP)[group]}]\n"
            + "\n".join(f"{name} = {module}:{name}" for name in names)
            for group, names in groups.items()
        ]
        (info / "entry_points.txt").write_text("\n\n".join(lines) + "\n")
        plugins_module.plugins.cache_clear()

    monkeypatch.syspath_prepend(tmp_path)
    yield install
    plugins_module.plugins.cache_clear()
    for name in [name for name in sys.modules if name.startswith("lab_wear")]:
        del sys.modules[name]


def measured(*specs, **more):
    cloud = BlockScan(sweeps=6).measure(np.random.default_rng(1))
    return evaluate(InspectionPlan(specs), cloud, **more)


def said(inspection):
    return "\n".join(str(note) for note in inspection.notes)


def test_a_kind_of_a_package_is_measured_and_its_result_says_whose_it_is(installed):
    installed(kinds=("WEAR",))
    assert kind_named("wear").title == "Wear" and every_kind()[-1].name == "wear"
    (row,) = measured(FeatureSpec("top", "wear")).characteristics
    assert row.name == "top flatness" and row.value >= 0 and row.u > 0
    assert str(row.notes[-1]) == "Measured by the package lab-wear 1.2, which is no part of Trisect."


def test_another_version_of_a_package_measures_anew(installed):
    installed(kinds=("WEAR",))
    first = measured(FeatureSpec("top", "wear"))
    again = measured(FeatureSpec("top", "wear"), previous=first)
    assert again.results[0].key == first.results[0].key
    installed(version="1.3", kinds=("WEAR",))
    assert measured(FeatureSpec("top", "wear"), previous=first).results[0].key != first.results[0].key


def test_a_kind_that_fails_is_a_feature_that_could_not_be_measured(installed):
    installed(kinds=("WEAR",))
    inspection = measured(FeatureSpec("broken", "wear"), FeatureSpec("top", "plane"))
    assert "wear of the package lab-wear 1.2 failed: ZeroDivisionError: no sweeps" in str(inspection.problems[0])
    assert [row.name for row in inspection.characteristics] == ["top flatness"]


def test_a_check_of_a_package_is_told_with_the_results(installed):
    installed(checks=("few_points", "breaks"))
    inspection = measured(FeatureSpec("top", "plane"))
    assert f"few_points (lab-wear 1.2): top rests on {len(inspection.results[0].indices)} points" in said(inspection)
    assert "breaks of the package lab-wear 1.2 failed: ZeroDivisionError" in said(inspection)


@pytest.mark.parametrize(
    ("groups", "why"),
    [
        ({"kinds": ("NO_KIND",)}, "it is no FeatureKind"),
        ({"kinds": ("MISSING",)}, "AttributeError"),
        ({"kinds": ("TAKEN",)}, "its name is taken"),
        ({"checks": ("NO_KIND",)}, "it is no function"),
    ],
)
def test_what_cannot_be_used_is_told_and_our_own_kinds_stay(installed, groups, why):
    before = every_kind()
    installed(**groups)
    assert every_kind() == before
    found = said(measured(FeatureSpec("top", "plane")))
    assert "of the package lab-wear 1.2 cannot be used" in found and why in found


def test_without_packages_nothing_is_said(monkeypatch):
    assert not [note for note in measured(FeatureSpec("top", "plane")).notes if note.code.startswith("plugin.")]


def test_a_plan_with_an_unknown_kind_is_told_all_kinds_those_of_packages_among_them(installed, tmp_path):
    installed(kinds=["WEAR"])
    plan = tmp_path / "plan.toml"
    plan.write_text('[[feature]]\nname = "a"\nkind = "wera"\n')
    with pytest.raises(InputError) as told:
        read_plan(plan)
    known = ENGLISH.joined([kind.name for kind in every_kind()], "and")
    assert 'there is no kind of feature "wera"' in str(told.value) and f"the kinds are {known}" in str(told.value)
    assert known.endswith("and wear")
