import tomllib

import pytest

from core.files.toml_text import toml_text

TABLES = {
    "feature": [{"name": 'a "ball"', "limits": {"height 2": {"nominal_mm": 1e-7}}}, {"name": "Größe", "of": []}],
    "gauge": {"polygon_px": [[1, 2.5], [3, 4]], "cuts": [{"kind": "height"}], "empty": {}},
    "k": 2.0,
    "sure": True,
}


def test_what_is_written_is_read_as_the_same_tables():
    assert tomllib.loads(toml_text(TABLES)) == TABLES


def test_single_values_stand_before_the_tables_that_would_swallow_them():
    assert toml_text(TABLES).splitlines()[:4] == ["k = 2.0", "sure = true", "", "[gauge]"]


def test_a_value_that_toml_does_not_have_is_refused():
    with pytest.raises(TypeError):
        toml_text({"size": object()})
