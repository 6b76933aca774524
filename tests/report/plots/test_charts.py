import numpy as np

from core.inspect.results import PairCandidate
from core.report.layout.style import ReportLook
from core.report.plots.charts import points_figure
from core.report.wording import Words
from tests.report.report_samples import cloud_and_mesh


def test_the_measured_pair_of_faces_is_outlined_and_the_next_best_dashed():
    cloud, _, block = cloud_and_mesh()
    corners = (((10.0, 10.0), (90.0, 10.0), (50.0, 80.0)), ((200.0, 10.0), (290.0, 10.0), (250.0, 80.0)))
    pairs = tuple(PairCandidate(mm, (9, 9), (50.0, 30.0), (250.0, 30.0), corners) for mm in (30.0, 20.0, 10.0))
    points = {"Upper face": np.flatnonzero(block)}
    figure = points_figure(ReportLook(Words(), "#14586E"), cloud, points, (1920, 1374), 160.0, 70.0, pairs)
    styles = {line.get_label(): line.get_linestyle() for line in figure.axes[0].get_legend().get_lines()[1:]}
    assert styles == {"measured pair, 30.0 mm": "-", "next best pair, 20.0 mm: not measured": "--"}
