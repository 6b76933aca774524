"""The table of before and after in the manual counts what it says."""

import pytest

from tests.structure import CONE, ROOT, House, table

TREE = {
    "core/__init__.py": "",
    "core/low/__init__.py": "",
    "core/low/camera.py": '"""Knows no cylinder."""\n\n\nclass Source: ...\n',
    "core/low/other.py": "from core.low import camera\n",
    "core/high/__init__.py": "",
    "core/high/run.py": "def begin():\n    from core.low.other import camera\n",
    "core/high/shapes.py": "from core.high import run\n\nkind = 'a Cylinder'\n",
    "workbench/__init__.py": "",
    "workbench/page.py": "from core.high.shapes import kind as cylinder_kind\n",
    "resources/translations/de.po": "",
}


@pytest.fixture
def house(tmp_path):
    def build(**changed):
        for name, text in {**TREE, **{name.replace("__", "/") + ".py": text for name, text in changed.items()}}.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text)
        return House(tmp_path)

    return build


def test_modules_lines_rooms_and_arrows_are_counted(house):
    small = house()
    assert (len(small.modules), small.lines) == (9, 11)
    assert {room: len(names) for room, names in small.rooms.items()} == {"core.low": 2, "core.high": 2, "workbench": 1}
    assert [small.arrows(folder) for folder in ("core.low", "core.high", "workbench")] == [0, 1, 1]


def test_a_tree_without_circles_has_none(house):
    assert house().circles == 0


def test_modules_that_import_each_other_are_a_circle(house):
    assert house(core__low__camera="import core.low.other\n").circles == 1


def test_folders_that_import_each_other_are_a_circle_though_no_modules_do(house):
    assert house(core__low__third="import core.high.shapes\n").circles == 1


def test_what_is_opened_lies_on_the_shortest_ways(house):
    assert house().opened([("core.high.shapes", ("begin",))]) == 2
    assert house().opened([("core.high.shapes", ("begin", "Source"))]) == 4


def test_a_neighbour_is_named_in_code_not_in_docstrings_and_a_language_by_its_file(house):
    assert house().naming(("cylinder",)) == 2
    assert house().naming(("german", "de")) == 1


def test_both_trees_stand_side_by_side(house, monkeypatch):
    monkeypatch.setattr("tests.structure.SET_TO_GAUGE", [("begin", ("Source",))])
    monkeypatch.setattr("tests.structure.LIVE_TO_OVERLAY", [])
    small = house()
    assert "| modules, lines | 9, 11 | 9, 11 |" in table(small, small)
    assert "| core/high | 2, 5 | 1 | 1 | 2, 5 | 1 | 1 |" in table(small, small)


def test_a_recipe_counts_the_files_of_its_steps_and_the_catalogues(house):
    assert house().recipe("Add a cone") is None
    steps = "1. `core/NAME.py` as `old.py`,\n   `core/shapes.py`\n2. `make translations`\n\nElse `core/no.py`\n"
    (house().root / "resources" / "manual").mkdir()
    (house().root / "resources" / "manual" / "recipes.md").write_text(f"## Add a cone\n\n{steps}")
    assert house().recipe("Add a cone") == 3


def test_the_recipe_for_a_cone_is_in_the_manual():
    assert House(ROOT).recipe(CONE) == 6
