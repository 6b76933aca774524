"""Results of the inspect page in words and numbers with units, rounded by their uncertainty."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from core.files.csv_text import harmless
from core.files.project.data import Repeat
from core.messages import decimals_of
from core.report.facts.fact import Fact
from core.report.wording import thickness_line, with_uncertainty
from workbench.language import time_of, tr
from workbench.pages.inspect.picks import Pick, Span
from workbench.pages.words import wording
from workbench.views.lists.value_rows import VerdictKind

if TYPE_CHECKING:
    from core.inspect.result_list import ResultList
    from core.inspect.results import GaugeResult
    from core.inspect.shown.view_frame import ViewFrame


def thickness(gauge: GaugeResult) -> str:
    """Write a thickness with its U: '50.008 mm ± 0.027 mm (k = 2)'."""
    return thickness_line(gauge, wording())


def verdict(result: GaugeResult | ResultList | None) -> VerdictKind:
    """Return the kind of verdict to show on a thickness or a list of results; "" for None or without limits."""
    kinds: dict[str, VerdictKind] = {
        "conforming": "conforming",
        "not conforming": "not conforming",
        "not proven": "not proven",
    }
    return "" if result is None else kinds.get(result.verdict, "")


class RepeatRow(NamedTuple):
    """Row of a repeat in the list, in words."""

    scan: str
    thickness: str
    expanded: str
    """U."""
    calibration: str
    measured_at: str


def repeat_row(repeat: Repeat) -> RepeatRow:
    """Write one repeat as a row of the list."""
    value, expanded = with_uncertainty(repeat.thickness_mm, repeat.U_mm, wording())
    return RepeatRow(
        scan=scan_name(repeat.scan),
        thickness=value,
        expanded=f"± {expanded}",
        calibration=short_id(repeat.calibration_id),
        measured_at=time_of(repeat.measured_at),
    )


def repeats_tsv(repeats: tuple[Repeat, ...], *told: Iterable[Fact]) -> str:
    """Write the repeats, and the facts `told` about them, as tab-separated text with all digits."""
    lines = [[tr("scan"), tr("thickness [mm]"), "U [mm]", "k", tr("calibration"), tr("measured at")]]
    lines += [
        [
            harmless(repeat.scan),
            f"{repeat.thickness_mm:.6f}",
            f"{repeat.U_mm:.6f}",
            f"{repeat.k:g}",
            repeat.calibration_id,
            repeat.measured_at.isoformat(timespec="seconds"),
        ]
        for repeat in repeats
    ]
    for facts in told:
        lines += [[], *([_with_unit(fact), _in_full(fact)] for fact in facts)]
    return "\n".join("\t".join(line) for line in lines) + "\n"


def _with_unit(fact: Fact) -> str:
    name = wording().known(fact.label)
    return f"{name} [{fact.unit}]" if fact.unit else name


def _in_full(fact: Fact) -> str:
    if not isinstance(fact.value, float):
        return fact.text(wording())
    return f"{fact.value:.10g}" if fact.decimals is None else f"{fact.value:.6f}"


def short_id(calibration_id: str) -> str:
    """Shorten a calibration's ids, of camera and planes, enough to tell calibrations apart."""
    return "-".join(part[:6] for part in calibration_id.split("-"))


def scan_name(stored: str) -> str:
    """Return the short name of a recording: its folder, with the parent folder where that is ambiguous."""
    path = PurePosixPath(stored)
    return f"{path.parent.name}/{path.name}" if path.name == "scan" and path.parent.name else path.name


def pick_lines(pick: Pick, frame: ViewFrame) -> tuple[str, str]:
    """Write a picked point in two lines: its coordinates in `frame`, and the frame and pixel it was seen at."""
    decimals = max(decimals_of(pick.sigma_mm), 0)
    x, y, z = (wording().fixed(float(value), decimals) for value in frame.coordinates(pick.place))
    place = tr("{name}   x {x}   y {y}   z {z} mm", name=pick.name, x=x, y=y, z=z)
    u, v = pick.uv
    picture = PurePosixPath(pick.frame).name or tr("fan, no frame")
    return place, tr(
        "σ = {sigma} mm, {frame}, u {u} v {v} px",
        sigma=wording().fixed(pick.sigma_mm, decimals),
        frame=picture,
        u=wording().fixed(u, 1),
        v=wording().fixed(v, 1),
    )


def span_lines(span: Span, frame: ViewFrame) -> tuple[str, str]:
    """Write a picked distance in two lines: its length with u, and its ends in `frame`."""
    text = tr("{name}   {value} mm, u = {u} mm", name=span.name, **_span(span))
    ends = []
    for pick in (span.a, span.b):
        x, y, z = (wording().fixed(float(value), 1) for value in frame.coordinates(pick.place))
        ends.append(f"({x}, {y}, {z})")
    return text, tr("from {start} to {end} mm", start=ends[0], end=ends[1])


def span_label(span: Span) -> str:
    """Write the length of a picked distance for its dimension line."""
    return tr("{name}: {value} mm (u = {u} mm)", name=span.name, **_span(span))


def _span(span: Span) -> dict[str, str]:
    value, u = with_uncertainty(span.result.distance_mm, span.result.u_mm, wording())
    return {"value": value, "u": u}
