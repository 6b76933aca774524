"""Sentences of `core` as they are said in a window: what the command line calls a file or an option is a field here."""

from __future__ import annotations

import re

_ELSEWHERE = "make the folder writable, or copy the project to another disk and open it there"

_PLAINER = (
    (r"check laser_fan\.lines in rig\.toml", "check the number of lines under Laser"),
    (r"plane_target\.kind in rig\.toml", "the kind of plate"),
    (r"inner_corners in rig\.toml", "columns and rows of the target"),
    (r"the number of circles in rig\.toml", "columns and rows of the target"),
    (r"its columns, rows and dictionary in rig\.toml", "its columns, rows and markers"),
    (r"the dictionary in rig\.toml", "the markers of the target"),
    (r"\[camera_target\] in rig\.toml", "the target"),
    (r",? in rig\.toml", ""),
    (r": trisect \w+ (SET|…)( --plan plan\.toml)? --out DIR", ""),
    (r"name the folder of its results with --out", "choose the folder of its results"),
    (r"choose another folder with --out", _ELSEWHERE),
    (r"choose another --out", "choose another folder"),
)


def in_the_window(sentence: str) -> str:
    """The sentence without the words of the command line."""
    for pattern, plainer in _PLAINER:
        sentence = re.sub(pattern, plainer, sentence)
    return sentence
