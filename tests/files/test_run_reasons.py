"""run.json says of every frame why crossings of it do not count."""

import json
from datetime import UTC, datetime

from core.files.run_file import RunRecord, read_run, write_run
from core.scan.frame_record import FrameRecord
from core.scan.left_out import MOVED, NOT_THE_FAN, REASONS


def test_reasons_of_crossings_are_written_and_read(tmp_path):
    why = ((REASONS[NOT_THE_FAN], 2), (REASONS[MOVED], 7))
    frames = (FrameRecord(0, "frame0000", True, left_out=9, left_out_reasons=why), FrameRecord(1, "frame0001", True))
    record = RunRecord("set", "set", datetime(2026, 1, 1, tzinfo=UTC), frames=frames)
    write_run(tmp_path / "run.json", record)
    written = json.loads((tmp_path / "run.json").read_text())
    assert written["frames"][0]["left_out_reasons"] == {"disagrees with the fan": 2, REASONS[MOVED]: 7}
    assert [frame.left_out_reasons for frame in read_run(tmp_path / "run.json").frames] == [why, ()]
