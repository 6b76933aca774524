"""The readers of the wing's files, with a good file of each kind: for `tests.hostile`."""

from __future__ import annotations

import shutil
from pathlib import Path

from core.wings.studies.files.input import read_crossed, read_readings, read_repeats
from core.wings.studies.files.study_file import read_study, write_study
from core.wings.studies.files.table import read_table
from tests.hostile.readers import Reader
from tests.wings.studies.test_study_file import STUDIES

READERS = {
    "table": Reader("table.csv", read_table),
    "repeats": Reader("repeats.csv", lambda path: read_repeats([path])),
    "crossed": Reader("crossed.csv", read_crossed),
    "readings": Reader("readings.csv", read_readings),
    **{f"study {name}": Reader(f"study-{place}.json", read_study) for place, name in enumerate(STUDIES)},
}


def good_files(folder: Path) -> None:
    """Write a good file of each kind into `folder`."""
    for place, study in enumerate(STUDIES.values()):
        shutil.move(write_study(folder / "study", study), folder / f"study-{place}.json")
    (folder / "table.csv").write_text("a;b;c\n1,5;2;x\n3;4;y\n")
    (folder / "repeats.csv").write_text("value\n" + "".join(f"50.{i}\n" for i in range(9)))
    rows = "".join(f"p{p},o{o},{p + o / 10 + r / 100}\n" for p in range(3) for o in range(2) for r in range(2))
    (folder / "crossed.csv").write_text(f"part,operator,value\n{rows}")
    (folder / "readings.csv").write_text(
        "quantity,position,measured_mm,calibrated_mm\nsize,left,30.01,30.0\nform,left,0.02,\n"
    )
