"""Q-DAS ASCII transfer format (AQDEF), .dfq: description and values in one file, for statistical software.

Keys written, lines ended by CR LF:

=========  ==========================================================================
K0100      number of characteristics
K1001/2    part number (the serial number, if one is known) and part description
K2001/2    number and name of characteristic n, as K2001/n
K2004      0: a variable characteristic
K2022      decimals: so that U has two digits
K2101      nominal value
K2110/1    lower and upper limit, only where there is one
K2120/1    kind of each limit: 1 a limit, 0 none
K2142      unit: mm or deg
K2900      remark: kind, what exactly was measured, U, k and the verdict, which AQDEF has no key for
K0001/n    measured value; K0002/n attribute: 0 valid, 255 not; K0004/n date and time; K0014/n serial number
=========  ==========================================================================

References
----------
Q-DAS GmbH, ASCII transfer format, version 12 (AQDEF).
"""

from __future__ import annotations

from pathlib import Path

from core.files.atomic import write_bytes
from core.files.exchange.records import one_line, result_row
from core.inspect.characteristic import Characteristic
from core.messages import decimals_of
from core.report.content import ReportContent

_NAME, _TEXT = 80, 255
"""Longest name and remark that the format takes, in characters."""

_VALID, _INVALID = 0, 255
"""K0002, the attribute of a value, by AQDEF: valid; not valid."""


def write_dfq(path: Path, content: ReportContent) -> None:
    """Write a report's characteristics as a Q-DAS file in Latin letters, else UTF-8; InputError if that fails.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    text = "".join(f"{line}\r\n" for line in dfq_lines(content))
    try:
        data = text.encode("cp1252")
    except UnicodeEncodeError:
        data = text.encode("utf-8-sig")
    write_bytes(path, data)


def dfq_lines(content: ReportContent) -> list[str]:
    """Make the lines, without line ends, of the Q-DAS file of a report's characteristics."""
    found = content.characteristics
    part = content.part or "not named"
    lines = [f"K0100 {len(found)}", f"K1001 {_cut(content.serial or part, 30)}", f"K1002 {_cut(part, _NAME)}"]
    for number, one in enumerate(found, start=1):
        lines += [f"{key}/{number} {value}" for key, value in _description(number, one).items()]
    for number, one in enumerate(found, start=1):
        lines += [f"{key}/{number} {value}" for key, value in _value(one, content).items()]
    return lines


def _description(number: int, one: Characteristic) -> dict[str, str]:
    row = result_row(one)
    keys = {
        "K2001": f"{number}",
        "K2002": _cut(one.name, _NAME),
        "K2004": "0",
        "K2022": f"{_decimals(one)}",
    }
    limits = {"K2101": row["nominal"], "K2110": row["lower_limit"], "K2111": row["upper_limit"]}
    keys |= {key: _number(value) for key, value in limits.items() if value is not None}
    keys |= {"K2120": f"{int('K2110' in keys)}", "K2121": f"{int('K2111' in keys)}", "K2142": row["unit"]}
    U = "unknown" if row["U"] is None else f"{row['U']:.{_decimals(one)}f} {row['unit']}"
    said = f"{one.kind}; U = {U} (k = {one.k:g}); verdict: {row['verdict']}; {row['rule']}"
    return keys | {"K2900": _cut(said.rstrip("; "), _TEXT)}


def _value(one: Characteristic, content: ReportContent) -> dict[str, str]:
    value = result_row(one)["value"]
    at = content.timestamp
    keys = {
        "K0001": _number(0.0 if value is None else value),
        "K0002": f"{_INVALID if value is None else _VALID}",
        "K0004": f"{at.day}.{at.month}.{at.year}/{at:%H:%M:%S}",
    }
    return keys | ({"K0014": _cut(content.serial, 40)} if content.serial else {})


def _decimals(one: Characteristic) -> int:
    U = result_row(one)["U"]
    return max(decimals_of(U), 0) if U else 3


def _number(value: float) -> str:
    """In full, without an exponent."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def _cut(text: str, most: int) -> str:
    return one_line(text)[:most]
