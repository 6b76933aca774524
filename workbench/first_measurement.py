"""The first measurement, step by step: what to do next, told by where the project stands. Going back is no mistake.

On the pictures of the sample, with nothing measured: the window shows one instruction at a time and waits for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from core.messages import label
from workbench.step_state import SETTLED, State


@dataclass(frozen=True, slots=True)
class Instruction:
    """Instruction on the page of a step; `button` is one of the page's card, "" is the window's Next."""

    page: str
    button: str
    text: str


class Facts(NamedTuple):
    """Facts from which the instruction follows."""

    page: str
    """The step that is shown."""
    states: Mapping[str, State]
    """How far each step is."""
    solved: frozenset[str]
    """Steps with a calibration that waits to be accepted."""
    running: bool
    """Something is being calibrated or measured."""
    has_fan: bool = True
    """The fixed laser lines are there; else two printed boards stand for them."""


PROJECT = Instruction(
    "project",
    "",
    label(
        "These are pictures of a gauge block of 50 mm, nothing is measured yet. Enter your name as the operator, then "
        "press Next."
    ),
)
SOLVE_CAMERA = Instruction(
    "camera",
    "run",
    label(
        "The camera was shown a board of known size. Press Calibrate: its corners are found in each picture, and how "
        "the camera sees is worked out from them."
    ),
)
ACCEPT_CAMERA = Instruction(
    "camera",
    "accept",
    label(
        "Click some pictures in the list: the arrows are what is left over at each corner. RMS well below 0.1 pixels "
        "and no common direction are good. Then press Accept."
    ),
)
SOLVE_PLANES = Instruction(
    "planes",
    "run",
    label(
        "The plate was held into the three fixed laser lines at several distances. Press Calibrate: the plane of each "
        "line is fitted through its stripes."
    ),
)
ACCEPT_PLANES = Instruction(
    "planes",
    "accept",
    label("Each plane says by how much the stripes miss it, in mm; a few hundredths are good. Then press Accept."),
)
SCAN = Instruction(
    "scan",
    "run",
    label(
        "A single line was swept by hand over the part. Press Measure: its crossings with the fixed lines give its own "
        "plane in each picture, and so the surface."
    ),
)
SCAN_BY_BOARDS = Instruction(
    "scan",
    "run",
    label(
        "A single line was swept by hand over the part and two printed boards behind it. Press Measure: the camera "
        "sees where the boards are, and the line on them gives its plane in each picture, and so the surface."
    ),
)
INSPECT = Instruction(
    "inspect",
    "measure",
    label(
        "Turn the surface with the mouse. Press Measure: the thickness between plate and block, with its uncertainty U."
    ),
)
REPORT = Instruction(
    "report",
    "make",
    label("Look through the pages, then press Make the report. It says what was measured, how, and how sure it is."),
)
FINISHED = Instruction(
    "report",
    "",
    label(
        "This was a whole measurement: value, U and verdict are on the first page. Every decision can be undone with "
        "Ctrl+Z. Next, calibrate your own camera; the manual (F1) says how on each page."
    ),
)
ORDER = (PROJECT, SOLVE_CAMERA, ACCEPT_CAMERA, SOLVE_PLANES, ACCEPT_PLANES, SCAN, INSPECT, REPORT, FINISHED)
"""The instructions in the order of work."""
ORDERS = {True: ORDER, False: (PROJECT, SOLVE_CAMERA, ACCEPT_CAMERA, SCAN_BY_BOARDS, INSPECT, REPORT, FINISHED)}
"""The same by whether there is a fan."""
WAIT = label("Wait a moment: the bar at the bottom says how far it is.")


def instruction(facts: Facts) -> Instruction:
    """Choose the next instruction of the first measurement: the first thing that is not done yet."""
    begun = facts.solved or any(facts.states[step] is State.DONE for step in ("camera", "planes", "scan"))
    if facts.page == "project" and not begun and not facts.running:
        return PROJECT
    for step, solve, accept in (("camera", SOLVE_CAMERA, ACCEPT_CAMERA), ("planes", SOLVE_PLANES, ACCEPT_PLANES)):
        if facts.states[step] not in SETTLED:
            return accept if step in facts.solved else solve
    scan = SCAN if facts.has_fan else SCAN_BY_BOARDS
    left = (one for one in (scan, INSPECT, REPORT) if facts.states[one.page] is not State.DONE)
    return next(left, FINISHED)
