"""A reader of E57 by the text of ASTM E2807 alone: nothing of the library that wrote the file is used.

Pages of 1024 bytes each end with the CRC-32C of the others, high byte first; offsets in the file count these four, what
is read without them does not. A compressed vector is a section header and packets; a data packet has one stream of
bytes for each field of the prototype, in its order.
"""

import struct

import numpy as np
from lxml import etree

PAGE, KEPT = 1024, 1020
SECTION, DATA_PACKET = 1, 1
TYPES = {"double": "<f8", "single": "<f4"}


def _crc_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte >> 1) ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    return table


CRC = _crc_table()


def crc32c(data):
    value = 0xFFFFFFFF
    for byte in data:
        value = CRC[(value ^ byte) & 0xFF] ^ (value >> 8)
    return value ^ 0xFFFFFFFF


def pages(path):
    """The file without its check sums, each of which must be right."""
    data = path.read_bytes()
    assert len(data) % PAGE == 0
    found = [data[start : start + PAGE] for start in range(0, len(data), PAGE)]
    for page in found:
        assert struct.unpack(">I", page[KEPT:])[0] == crc32c(page[:KEPT])
    return b"".join(page[:KEPT] for page in found)


def logical(offset):
    return offset // PAGE * KEPT + offset % PAGE


def xml_of(path, content=None):
    """The XML section."""
    content = pages(path) if content is None else content
    name, major, minor, length, place, size, page = struct.unpack_from("<8sIIQQQQ", content)
    assert (name, major, minor, length, page) == (b"ASTM-E57", 1, 0, path.stat().st_size, PAGE)
    return etree.fromstring(content[logical(place) : logical(place) + size])


def points_of(path):
    """{field: values} of the only scan."""
    content = pages(path)
    node = xml_of(path, content).find(".//{*}data3D/{*}vectorChild/{*}points")
    fields = [(etree.QName(one).localname, TYPES[one.get("precision", "double")]) for one in node.find("{*}prototype")]
    assert {one.get("type") for one in node.find("{*}prototype")} == {"Float"}
    start = logical(int(node.get("fileOffset")))
    assert content[start] == SECTION
    length, first = struct.unpack_from("<QQ", content, start + 8)
    at, streams = logical(first), {name: b"" for name, _ in fields}
    while at < start + length:
        kind, size, count = content[at], struct.unpack_from("<H", content, at + 2)[0] + 1, 0
        if kind == DATA_PACKET:
            (count,) = struct.unpack_from("<H", content, at + 4)
            assert count == len(fields)
            begin = at + 6 + 2 * count
            for name, length_of_stream in zip(streams, struct.unpack_from(f"<{count}H", content, at + 6), strict=True):
                streams[name] += content[begin : begin + length_of_stream]
                begin += length_of_stream
        at += size
    values = {name: np.frombuffer(streams[name], kind) for name, kind in fields}
    assert {len(one) for one in values.values()} == {int(node.get("recordCount"))}
    return values
