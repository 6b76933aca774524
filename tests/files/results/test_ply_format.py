import numpy as np
import pytest

from core.files.results.ply_format import Ply, parse_ply, ply_bytes

MIXED = np.array(
    [(1.5, -2.25, 7, -300, 255, (1, -2)), (0.1, 3e8, 0, 3, 0, (3, 4))],
    dtype=[("x", "f8"), ("sigma", "f4"), ("a", "i1"), ("b", "i2"), ("c", "u1"), ("pair", "i4", (2,))],
)
TEXT = b"""ply
format ascii 1.0
comment unit mm
obj_info of another program
element vertex 2
property double x
property float32 sigma
element face 1
property list uchar int vertex_indices
property uint8 filled
end_header
1.5 0.25
-2e-3 1
3 0 1 0 1
"""


@pytest.mark.parametrize("order", ["<", ">"])
def test_scalars_of_all_types_lists_and_comments_come_back_in_both_byte_orders(order):
    data = ply_bytes(Ply({"vertex": MIXED, "other": MIXED[:0]}, ("unit mm", "")), byte_order=order)
    back = parse_ply(data)
    assert back.comments == ("unit mm", "")
    for name in MIXED.dtype.names:
        assert np.array_equal(back.elements["vertex"][name], MIXED[name])
    assert len(back.elements["other"]) == 0


def test_text_is_read():
    back = parse_ply(TEXT)
    assert back.comments == ("unit mm",)
    assert back.elements["vertex"]["x"].tolist() == [1.5, -2e-3]
    assert back.elements["face"]["vertex_indices"].tolist() == [[0, 1, 0]]
    assert back.elements["face"]["filled"].tolist() == [1]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b"ply\n", b"obj\n", "no PLY header"),
        (b"ascii", b"binary_middle_endian", "no PLY header"),
        (b"end_header", b"", "the header has no end"),
        (b"vertex 2", b"vertex 900", "has no count that fits"),
        (b"vertex 2", b"vertex -2", "has no count that fits"),
        (b"vertex 2", b"vertex " + b"9" * 5000, "has no count that fits"),
        (b"face 1", b"face 2", "the data end early"),
        (b"double x", b"quadruple x", "property not understood"),
        (b"3 0 1 0 1", b"4000 0 1 0 1", "ends early"),
        (b"3 0 1 0 1", b"3 0 1 nan 1", "are no int"),
        (b"3 0 1 0 1", b"3 0 1 0 256", "are no uchar"),
        (b"element face", b"something face", "header line not understood"),
    ],
)
def test_what_is_wrong_is_said(old, new, said):
    assert old in TEXT
    with pytest.raises(ValueError, match=said):
        parse_ply(TEXT.replace(old, new, 1))


def test_lists_of_several_lengths_are_refused():
    lists = np.zeros(3, dtype=[("k", "u1", (2,))])
    data = bytearray(ply_bytes(Ply({"face": lists})))
    data[-3] = 1
    with pytest.raises(ValueError, match="not all of one length"):
        parse_ply(bytes(data))
