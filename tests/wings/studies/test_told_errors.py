"""Why no study can be made is told in every language."""

import json

from core.wings.studies.files.study_file import read_study, write_study
from core.wings.studies.study_step import keep_study, keep_type1
from tests.test_told_errors import refused
from tests.wings.studies.test_study_file import STUDIES


def test_tables_and_repeats_of_which_no_study_can_be_made(tmp_path):
    table = "part;operator;value\n" + "1;A;50\n1;A;50\n2;A;50\n2;A;50\n"
    with refused("a gauge R&R study needs values that differ"):
        keep_study(tmp_path, "grr", table, tmp_path, {})
    with refused("a type-1 study needs two finite values or more"):
        keep_type1(tmp_path, [("scan", 50.0, ())], 50.0, 1.0)


def test_a_study_file_of_which_no_study_can_be_made(tmp_path):
    path = write_study(tmp_path, STUDIES["repeats"])
    path.write_text(json.dumps(json.loads(path.read_text()) | {"scans": []}))
    with refused("repeats need one finite thickness or more"):
        read_study(path)
