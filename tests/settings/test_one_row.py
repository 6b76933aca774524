"""One row of the table makes a setting: in project.json, on the command line, in run.json, in the form of its page."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from core.cli.setting_flags import takes
from core.errors import InputError
from core.files.project.data import ProjectFile, new_project
from core.files.project.json_form import project_tables, project_text, read_project_text
from core.files.project.keys import inputs_of
from core.files.recording.rig import read_rig_tables
from core.files.toml_text import toml_text
from core.settings import options
from core.settings.options import Options, settings_of
from core.settings.rig import RIG
from core.settings.setting import Number, rows, rows_within

ROW = """
    reach_mm: float = field(
        default=300.0,
        metadata=described(
            Number(0.0, 900.0, label("a length above 0 and at most 900"), "mm", 1.0, 900.0, decimals=0, step=10.0),
            steps=("scan",),
            title=label("Reach"),
            help="Points farther away are left out.",
            flag=Flag("--reach", help="Leave out points farther away.", value="MM"),
            refused=lambda mm: Message("options.reach_range", "{mm:g} is not above 0 and at most 900 mm", mm=mm),
        ),
    )
"""
"""What somebody adds to the table who wants one more setting, and nothing else."""

STRANGER = """
import json, sys, types
from dataclasses import replace
from pathlib import Path

import core.settings.options as options

text = Path(options.__file__).read_text(encoding="utf-8")
head, class_, tail = text.partition("    def __post_init__")
exec(compile(head + sys.argv[1].lstrip("\\n") + "\\n" + class_ + tail, options.__file__, "exec"), options.__dict__)

from PySide6.QtWidgets import QApplication
from core.errors import InputError
from core.files.project.data import ProjectFile, new_project
from core.files.project.json_form import project_text, read_project_text
from core.files.project.keys import inputs_of
from tests.simulated import trisect

app = QApplication([])
from workbench.pages.setting_fields import add_settings
from workbench.pages.settings import changed_options, values_of
from workbench.views.forms.form import SettingsForm

usual = new_project("p")
form = SettingsForm()
add_settings(form, "scan")
changed = changed_options("scan", usual.options, None, "reach_mm", 250.0)
project = replace(usual, options=changed)
path = Path(sys.argv[2])
path.write_text(project_text(ProjectFile(project), path), encoding="utf-8")
tables = json.loads(path.read_text(encoding="utf-8"))
read = read_project_text(path).project.options.reach_mm
tables["options"]["reach_mm"] = 901
path.write_text(json.dumps(tables), encoding="utf-8")
try:
    read_project_text(path)
except InputError as error:
    refused = str(error)
key = "scan settings"
print(json.dumps({
    "shown": values_of("scan", changed)["reach_mm"], "help": form.help_of("reach_mm"), "read": read, "refused": refused,
    "told": changed.run_settings("scan")["reach_mm"], "flag": "--reach" in trisect("scan", "--help").out,
    "elsewhere": "--reach" in trisect("camera", "--help").out,
    "typed": trisect("scan", "nothing", "--out", "o", "--reach", 1000).err,
    "as before": inputs_of("scan", usual, {})[key], "stale": inputs_of("scan", project, {})[key],
}))
"""
"""A program into whose table the row was written."""


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What there is of the stranger's setting in a file, on the command line and in a form."""
    place = tmp_path_factory.mktemp("stranger") / "project.json"
    said = subprocess.run(
        [sys.executable, "-c", STRANGER, ROW, str(place)], capture_output=True, text=True, cwd=Path.cwd(), check=False
    )
    assert said.returncode == 0, said.stderr
    return json.loads(said.stdout)


def test_a_row_is_in_the_file_and_checked_there(seen):
    assert seen["read"] == 250.0
    assert "options.reach_mm is 901, not a length above 0 and at most 900" in seen["refused"]


def test_a_row_is_a_flag_of_its_step_alone_and_refused_by_its_own_words(seen):
    assert seen["flag"] and not seen["elsewhere"]
    assert "reach: 1000 is not above 0 and at most 900 mm" in seen["typed"]


def test_a_row_is_in_the_form_with_its_words_and_in_run_json(seen):
    assert seen["shown"] == 250.0 and seen["told"] == 250.0
    assert seen["help"] == "Points farther away are left out."


def test_a_row_makes_a_result_stale_only_where_it_is_stated(seen):
    assert seen["as before"] == inputs_of("scan", new_project("p"), {})["scan settings"]
    assert seen["stale"] != seen["as before"]


def test_every_setting_of_the_table_is_in_the_file_or_on_the_command_line():
    in_file = project_tables(ProjectFile(new_project("p")))["options"]
    assert list(in_file) == [row.key for row in rows(Options) if row.setting.in_file]
    assert all(row.setting.in_file or row.setting.flag for row in rows(Options))


def test_the_flags_of_a_command_are_those_of_its_steps():
    @takes("camera", "planes")
    def command(out, typed=options, json=False):
        """Any."""

    assert list(command.__signature__.parameters) == [
        "out", "skew", "k3", "adjust_camera", "accept_few_poses", "stripe_width", "contrast", "channel", "json",
    ]  # fmt: skip


@pytest.mark.parametrize("row", [one for row in rows(Options) for one in rows_within(row)], ids=lambda row: row.key)
def test_a_default_is_within_its_own_range(row):
    if row.default is not None:
        assert row.setting.complaint(row.default) is None
    kind = row.setting.kind
    if isinstance(kind, Number) and row.setting.refused is not None:
        assert all(row.setting.complaint(value) is None for value in (kind.least, kind.largest))
        assert row.setting.complaint(kind.above) is not None and row.setting.complaint(kind.most * 1.01) is not None


def test_a_step_is_told_its_own_settings_only():
    stated = Options(sigma_cut_mm=0.2, constrain_fan=False, excluded=frozenset({"scan/a.png", "camera/b.png"}))
    assert stated.for_scan == Options(sigma_cut_mm=0.2, excluded=frozenset({"scan/a.png"}))
    assert stated.for_planes == Options(constrain_fan=False)
    assert stated.for_plan == Options(sigma_cut_mm=0.2)


def test_a_project_with_every_setting_changed_is_read_again(tmp_path):
    stated = replace(Options(), sigma_cut_mm=0.2, constrain_fan=False, adjust_camera=True, accept_few_poses=True)
    stated = replace(stated, camera=replace(stated.camera, skew=True, fixed=frozenset({"k2", "k1"}), outliers="all"))
    path = tmp_path / "project.json"
    path.write_text(project_text(ProjectFile(replace(new_project("p"), options=stated)), path), encoding="utf-8")
    assert read_project_text(path).project.options == stated


def test_settings_that_more_steps_share_stand_behind_a_steps_own():
    shared = [len(row.setting.steps) for row in settings_of("scan")]
    assert shared == sorted(shared)


def test_a_value_out_of_range_is_refused_wherever_options_are_made():
    with pytest.raises(InputError, match="sigma-cut: 11 is not above 0"):
        replace(Options(), sigma_cut_mm=11)


@pytest.mark.parametrize(("table", "key"), [(table, key) for table, settings in RIG.items() for key in settings])
def test_rig_toml_takes_what_the_form_of_a_setting_lets_one_enter_and_no_more_than_its_row_says(tmp_path, table, key):
    kind = RIG[table][key].kind
    beside = {"lines": 3, "angle_deg": 5.0} if table == "laser_fan" else {}
    beside |= {"nominal_mm": 50.0, "tolerance_mm": 0.2} if table == "gauge" else {}

    def read(value):
        path = tmp_path / "rig.toml"
        path.write_text(toml_text({table: {**beside, key: value if kind.decimals else int(value)}}), encoding="utf-8")
        return getattr(getattr(read_rig_tables(path), table), key)

    assert [read(value) for value in (kind.least, kind.largest, kind.most)] == [kind.least, kind.largest, kind.most]
    for value in (kind.most + 1, kind.above - (1 if kind.also_at else 0)):
        with pytest.raises(InputError, match=re.escape(f"not {kind.stated}")):
            read(value)
