"""run.json says of every frame why crossings of it do not count."""

import json
from datetime import UTC, datetime

from core.files.results.run_file import RunRecord, read_run, write_run
from core.image.exclusion import Exclusion
from core.scan.features.frames import CrossingUse, FrameRecord


def test_reasons_of_crossings_are_written_and_read(tmp_path):
    why = ((CrossingUse.NOT_THE_FAN, 2), (CrossingUse.MOVED, 7))
    frames = (FrameRecord(0, "frame0000", True, left_out=9, left_out_reasons=why), FrameRecord(1, "frame0001", True))
    record = RunRecord("set", "set", datetime(2026, 1, 1, tzinfo=UTC), frames=frames)
    write_run(tmp_path / "run.json", record)
    written = json.loads((tmp_path / "run.json").read_text())
    assert written["frames"][0]["left_out_reasons"] == {"not_the_fan": 2, "moved": 7}
    assert [frame.left_out_reasons for frame in read_run(tmp_path / "run.json").frames] == [why, ()]


def test_reasons_in_words_of_older_files_are_read(tmp_path):
    frames = (FrameRecord(0, "frame0000", False, Exclusion.WITHOUT_STRIPE.message, left_out=9),)
    write_run(tmp_path / "run.json", RunRecord("set", "set", datetime(2026, 1, 1, tzinfo=UTC), frames=frames))
    written = json.loads((tmp_path / "run.json").read_text())
    written["frames"][0] |= {"reason": "no stripe", "left_out_reasons": {"disagrees with the fan": 9}}
    (tmp_path / "run.json").write_text(json.dumps(written))
    (frame,) = read_run(tmp_path / "run.json").frames
    assert (str(frame.reason), frame.left_out_reasons) == ("no stripe", ((CrossingUse.NOT_THE_FAN, 9),))
