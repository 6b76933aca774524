"""Why no sweep is tied to a known plane: its light lies on print, along one line alone, or not on it at all."""

from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError
from core.scan.reconstruct import reconstruct
from tests.scan.known_planes.planes_on_paper import CORNER, NO_FAN, board, scan_on_paper
from tests.scan.synthetic import CAMERA

PRINTED = np.ones(CAMERA.image_size[::-1], dtype=np.bool_)
ASIDE = ((0.0, 0.0), (2.0, 2.0))


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (
            {"marks": PRINTED},
            r"in all 12 frames .* its light lies on print.*larger plain fields",
        ),
        ({"outline": board(CORNER[0], 0, place=ASIDE).outline}, "no sweep is seen on a known plane"),
    ],
)
def test_why_no_sweep_is_tied_to_a_plane_is_told(change, why):
    paper = scan_on_paper(1, count=12)
    planes = [replace(plane, **change) for plane in paper.control.planes]
    with pytest.raises(InputError, match=why):
        reconstruct(paper.features, CAMERA, NO_FAN, planes=planes)


def test_sweeps_that_meet_one_line_alone_are_told():
    paper = scan_on_paper(1, count=12)
    alone = replace(paper.features, crossings=paper.features.crossings.select(np.zeros(0, dtype=np.int64)))
    with pytest.raises(InputError, match="meets known planes along one straight line only"):
        reconstruct(alone, CAMERA, NO_FAN, planes=paper.control.planes[:1])
