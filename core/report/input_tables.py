"""Tables of what a result was made from: frames and pictures left out, and every input with its hash."""

from __future__ import annotations

from collections.abc import Mapping

from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.platypus import Flowable, Paragraph, TableStyle

from core.report.content import ReportContent
from core.report.language import grouped
from core.report.look import Look
from core.report.style import MONO, MUTED, SANS, markup
from core.report.tables import Cell, heads, more_line, plain_table, ruled_table

SHORT_HASH = 10
"""Characters printed of an input's SHA-256; the whole of it is in run.json."""

NO_REASON = "no reason recorded"


def left_out_table(
    look: Look, left_out: list[tuple[str, list[str]]], width: float, most: int, most_names: int
) -> list[Flowable]:
    """Reasons, how often, and which: at most `most` reasons, and of each at most `most_names` names."""
    if not left_out:
        return []
    rows: list[list[Flowable]] = [heads(look, "Left out because", "how many", "which", numbers=(1,))]
    for reason, names in left_out[:most]:
        which = ", ".join(names[:most_names])
        if len(names) > most_names:
            which += look.words(" and {n} more", n=grouped(len(names) - most_names))
        rows.append(
            [
                look.text(look.words.known(reason), "small"),
                look.text(grouped(len(names)), "number"),
                look.text(which, "small"),
            ]
        )
    table = ruled_table(rows, [0.4 * width, 0.12 * width, 0.48 * width])
    table.setStyle(TableStyle([("LEFTPADDING", (2, 0), (2, -1), 6)]))
    return [table, *more_line(look, len(left_out) - most)]


def left_out_of_calibration(content: ReportContent) -> list[tuple[str, list[str]]]:
    """Views and poses the calibrations did without, by reason."""
    reasons: dict[str, list[str]] = {}
    for view in content.camera.views:
        if not view.used:
            reasons.setdefault(view.reason or NO_REASON, []).append(view.view.name or "view without a name")
    for pose in content.fan.poses:
        if not pose.used:
            reasons.setdefault(pose.reason or NO_REASON, []).append(pose.name)
    return sorted(reasons.items(), key=lambda item: -len(item[1]))


def hash_table(look: Look, hashes: Mapping[str, str], width: float, most: int) -> list[Flowable]:
    """Every input by folder, with the beginning of its SHA-256; at most `most` of them.

    As many columns as the longest name leaves room for.
    """
    shown = sorted(hashes, key=lambda path: ("/" in path, path))[:most]
    folders: dict[str, list[str]] = {}
    for path in shown:
        folders.setdefault(path.rpartition("/")[0], []).append(path)
    longest = max((stringWidth(path.rpartition("/")[2], SANS, 6) for path in shown), default=0.0)
    room = longest + stringWidth("0" * (SHORT_HASH + 2), MONO, 5.6) + 6
    columns = int(min(max(width // room, 1), 6))
    rows: list[list[Cell]] = []
    head_rows = []
    for folder, paths in folders.items():
        if folder:
            head_rows.append(len(rows))
            rows.append([look.text(f"{folder}/", "hash_folder"), *[""] * (columns - 1)])
        depth = -(-len(paths) // columns)
        cells = [_hash_cell(look, path, hashes[path]) for path in paths]
        rows += [[*cells[row::depth], *[""] * (columns - len(cells[row::depth]))] for row in range(depth)]
    parts: list[Flowable] = []
    if rows:
        table = plain_table(rows, [width / columns] * columns)
        style: list[tuple[object, ...]] = [(side, (0, 0), (-1, -1), 0.3) for side in ("TOPPADDING", "BOTTOMPADDING")]
        style += [("FONTSIZE", (0, 0), (-1, -1), 1), ("LEADING", (0, 0), (-1, -1), 1)]  # of the empty cells
        style += [("SPAN", (0, row), (-1, row)) for row in head_rows]
        style += [("TOPPADDING", (0, row), (-1, row), 2) for row in head_rows]
        table.setStyle(TableStyle(style))
        parts.append(table)
    return [*parts, *more_line(look, len(hashes) - most)]


def _hash_cell(look: Look, path: str, digest: str) -> Paragraph:
    name = markup(path.rpartition("/")[2])
    code = f'<font name="{MONO}" size="5.6" color="{MUTED}">{markup(digest[:SHORT_HASH])}</font>'
    return Paragraph(f"{name} {code}", look.style("hash"))
