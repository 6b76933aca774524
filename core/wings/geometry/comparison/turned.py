"""The files of a comparison as they are handed over: in the frame of the export."""

from __future__ import annotations

from core.pipeline.steps.export_kinds import in_frame
from core.wings.geometry.comparison.comparison_file import write_comparison_csv_in, write_comparison_ply_in

write_points = in_frame("compared", write_comparison_ply_in)
write_table = in_frame("comparison_table", write_comparison_csv_in)
