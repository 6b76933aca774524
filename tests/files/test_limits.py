import os
import struct
import zipfile
import zlib

import numpy as np
import pytest

from core.errors import InputError
from core.files.arrays_file import read_arrays, real, texts, truth, whole, write_arrays
from core.files.limits import PIXELS
from core.files.pictures import read_picture
from core.files.reading import csv_rows, json_of, read_bytes, read_text, toml_of
from core.messages import plain

NOTHING = plain("")


@pytest.mark.parametrize("read", [read_bytes, read_text])
def test_a_pipe_and_a_device_are_refused_before_they_are_opened(tmp_path, read):
    os.mkfifo(tmp_path / "scan.png")
    for path in (tmp_path / "scan.png", type(tmp_path)("/dev/zero")):
        with pytest.raises(InputError, match="this is a pipe, a socket or a device, not a file; name a file"):
            read(path)


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    with (tmp_path / "big.json").open("wb") as file:
        file.truncate(10**12)  # sparse: takes no room
    for read in (read_bytes, read_text):
        with pytest.raises(InputError, match=r"the file has 1000000\.0 MB, and no such file has more than"):
            read(tmp_path / "big.json")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[" * 100_000, "more than 60 deep"),
        ('{"a":' * 61, "more than 60 deep"),
        ('{"n": 1' + "0" * 5000 + "}", "more than 100 digits"),
        ('{"n": "\\ud800"}', "half a character"),
        ("[1,", "no valid JSON"),
    ],
)
def test_json_beyond_all_bounds_is_told(text, said):
    with pytest.raises(InputError, match=said):
        json_of(text, "a.json")


def test_json_within_them_is_read():
    assert json_of('{"a [[[": "' + "[" * 1000 + '", "b": [[1.5, 123456789]]}', "a.json")["b"] == [[1.5, 123456789]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"[{'.'.join(['a'] * 200_000)}]", "more than 60 deep"),
        (f"{' . '.join(['a'] * 70)} = 1", "more than 60 deep"),
        (f"{'.'.join(['a'] * 59)}.'b'.{'.'.join(['a'] * 70)} = 1", "more than 60 deep"),
        ("a = " + "[" * 61 + "]" * 61, "more than 60 deep"),
        ("a = " + "9" * 5000, "more than 100 digits"),
        ("a = 0x" + "f" * 5000, "more than 100 digits"),
        ("#" * 1_000_001, "the file has 1.0 MB"),
        ("a = ", "no valid TOML"),
    ],
)
def test_toml_beyond_all_bounds_is_told(text, said):
    with pytest.raises(InputError, match=said):
        toml_of(text, "a.toml")


def test_toml_within_them_is_read():
    text = f'a.b = "{"x." * 100}" # {"[" * 100}\nc = """\n{"[" * 100}"""\nd = 0.123'
    assert toml_of(text, "a.toml")["d"] == 0.123


def test_a_cell_longer_than_any_is_told(tmp_path):
    with pytest.raises(InputError, match="this is no table"):
        csv_rows(["a,b", '"' + "x" * 200_000 + '"'], tmp_path / "a.csv")


def npz(path, *, declared, packed=zipfile.ZIP_STORED, data=b"\0" * 64):
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {declared}, }}".ljust(117) + "\n"
    member = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode() + data
    with zipfile.ZipFile(path, "w", packed) as file:
        file.writestr("a.npy", member)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"declared": "(962072674304,)"}, "an array is not as long as it says"),
        ({"declared": "(-8,)"}, "not as long as it says"),
        ({"declared": "(8,)", "packed": zipfile.ZIP_DEFLATED, "data": bytes(10**6)}, "its arrays are packed"),
        ({"declared": "(" * 5000 + ")" * 5000}, "this is no whole file of arrays"),
        ({"declared": "('a',)"}, "this is no whole file of arrays"),
    ],
)
def test_arrays_that_declare_more_than_they_hold_are_refused(tmp_path, given, said):
    npz(tmp_path / "a.npz", **given)
    with pytest.raises(InputError, match=said):
        read_arrays(tmp_path / "a.npz", {"a": real(None)}, todo=NOTHING)


def test_arrays_of_numbers_truths_and_texts_come_back(tmp_path):
    given = {
        "a": np.arange(6.0).reshape(2, 3).T, "b": np.array("ü"), "c": np.zeros((0, 2), np.int64), "d": np.array([True])
    }  # fmt: skip
    schema = {"a": real("n", "m"), "b": texts(), "c": whole(None, "m"), "d": truth(1)}
    write_arrays(tmp_path / "a.npz", given)
    back = read_arrays(tmp_path / "a.npz", schema, todo=NOTHING)
    for name, array in given.items():
        assert back[name].dtype == array.dtype
        assert np.array_equal(back[name], array)


@pytest.mark.parametrize(
    ("name", "array", "said"),
    [
        ("a", np.zeros((3, 2)), r"the array a has shape \(3, 2\), not n"),
        ("a", np.zeros(4), r"the array b has shape \(3,\), not 4"),
        ("a", np.array(["1", "2", "3"]), "the array a holds texts, not real numbers"),
        ("a", np.array([1, 2, 3]), "the array a holds whole numbers, not real numbers"),
        ("a", np.array([1.0, np.nan, 2.0]), "the array a holds values that are not finite"),
        ("a", np.array([1.0, 1e100, 2.0]), "the array a holds values that are not finite"),
        ("b", np.array([True, False, True]), "the array b holds true or false, not whole numbers"),
        ("c_1", np.zeros((2, 3)), r"the array c_1 has shape \(2, 3\), not n × 2"),
        ("b", None, "the array b is missing"),
    ],
)
def test_an_array_that_is_not_what_it_must_be_is_told(tmp_path, name, array, said):
    good = {"a": np.zeros(3), "b": np.arange(3), "c_0": np.zeros((5, 2)), "c_1": np.zeros((0, 2)), "more": np.zeros(9)}
    schema = {"a": real("n"), "b": whole("n"), "c_*": real(None, 2), "d": texts(optional=True)}
    write_arrays(tmp_path / "a.npz", good)
    assert set(read_arrays(tmp_path / "a.npz", schema, todo=NOTHING)) == {"a", "b", "c_0", "c_1"}
    write_arrays(tmp_path / "a.npz", {key: one for key, one in (good | {name: array}).items() if one is not None})
    with pytest.raises(InputError, match=said):
        read_arrays(tmp_path / "a.npz", schema, todo=NOTHING)


@pytest.mark.parametrize("array", [np.zeros(2, complex), np.zeros(2, ">f8"), np.zeros(1, "V4")])
def test_arrays_of_other_types_are_refused(tmp_path, array):
    write_arrays(tmp_path / "a.npz", {"a": array})
    with pytest.raises(InputError, match="an array is of type"):
        read_arrays(tmp_path / "a.npz", {"a": real(None)}, todo=NOTHING)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height):
    rows = chunk(b"IDAT", zlib.compress(bytes(1000)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) + rows + chunk(b"IEND", b"")  # noqa: E501  # fmt: skip


def tiff(width, height):
    tags = struct.pack("<HHHIIHHII", 2, 256, 4, 1, width, 257, 4, 1, height)
    return b"II*\0" + struct.pack("<I", 8) + tags + struct.pack("<I", 0)


@pytest.mark.parametrize(
    "data",
    [
        png(30_000, 30_000),
        tiff(30_000, 30_000),
        b"BM" + struct.pack("<IIIIii", 54, 0, 54, 40, 30_000, -30_000) + bytes(28),
        b"\xff\xd8\xff\xc0\x00\x0b\x08\x75\x30\x75\x30\x01\x01\x11\x00\xff\xda\x00\x02\xff\xd9",
        b"P5 30000 30000 255\n" + bytes(30_000 * 30_000 // 1000),
    ],
    ids=["png", "tif", "bmp", "jpg", "pgm"],
)
def test_a_picture_that_declares_too_many_pixels_is_refused(tmp_path, data):
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(InputError, match=r"said to have 30000 × 30000 pixels, and at most 160 million|ends early"):
        read_picture(tmp_path / "a.png")


@pytest.mark.parametrize("data", [b"P5 0 0 255\n", png(0, 5)], ids=["pgm", "png"])
def test_a_picture_without_pixels_is_refused(tmp_path, data):
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(InputError, match="the picture has no pixels"):
        read_picture(tmp_path / "a.png")


def test_the_largest_sensor_is_within_the_limit():
    assert PIXELS > 14_204 * 10_652
