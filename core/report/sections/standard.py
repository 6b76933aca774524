"""The sections of the report, in printing order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from reportlab.lib.units import mm
from reportlab.lib.utils import ImageReader
from reportlab.platypus import Flowable, Spacer, TableStyle

from core.inspect.results import GaugeResult
from core.messages import capital, label, plural_message
from core.report.content import ReportContent
from core.report.facts.of_gauge import LOWER, UPPER, angle_fact, face_facts
from core.report.layout.blocks import (
    Bookmark,
    Heading,
    Limits,
    OnOnePage,
    Picture,
    Sections,
    heads,
    more_line,
    plain_table,
    ruled_table,
    section,
)
from core.report.layout.style import MUTED, TEXT_WIDTH, ReportLook, color
from core.report.sections import evidence
from core.report.sections.budget import budget_table
from core.report.sections.head import head
from core.report.sections.reading import reading
from core.report.sections.repeats import repeats_head, repeats_table
from core.report.sections.result import budget_key, characteristics_table, result_box, result_table
from core.report.sections.studies import studies
from core.report.wording import grouped, limits_of_cloud, limits_of_inspection, limits_of_thickness, shown_name

Pictures = Mapping[str, ImageReader]
Part = tuple[str, Callable[[], Sequence[Flowable]]]
"""The name it is hidden by, "" for what cannot be hidden, and what makes it."""


def story(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[Flowable]:
    """Make the whole report in printing order, without sections that are hidden."""
    figures: list[Part] = [
        ("surface", lambda: _surface(look, content, pictures, limits)),
        ("view", lambda: _view(look, content, pictures, limits)),
        ("frame", lambda: _frame(look, content, pictures, limits)),
        ("profiles", lambda: _profiles(look, content, pictures, limits)),
        ("sections", lambda: _sections(look, content, pictures, limits)),
        ("points", lambda: _points(look, pictures, limits)),
        ("maps", lambda: _maps(look, content, pictures, limits)),
        ("deviation", lambda: _deviations(look, content, pictures, limits)),
    ]
    tables: list[Part] = [
        ("budget", lambda: _budgets(look, content, limits)),
        ("repeats", lambda: _repeats(look, content, pictures, limits)),
        ("studies", lambda: studies(look, content, pictures, limits)),
        ("artefacts", lambda: evidence.artefacts(look, content)),
        ("", lambda: evidence.brought(look, content)),
    ]
    rest: list[Part] = []
    grounds: list[Part] = [
        ("", lambda: evidence.traceability(look, content)),
        ("calibrations", lambda: evidence.calibrations(look, content, limits)),
        ("frames", lambda: evidence.pictures_used(look, content, limits)),
        ("", lambda: evidence.warnings(look, content, limits)),
        ("reading", lambda: reading(look, content)),
    ]
    remarks = evidence.remarks(look, content)
    (grounds if len(remarks) == 1 else rest).append(("remarks", lambda: remarks))  # long ones flow from page to page
    rest += [
        ("settings", lambda: evidence.settings(look, content, limits)),
        ("", lambda: evidence.inputs(look, content, limits)),
        ("signatures", lambda: signatures(look, content)),
    ]

    def shown(parts: list[Part]) -> list[Flowable]:
        return [flowable for name, part in parts if name not in content.hidden for flowable in part()]

    def filling_pages(parts: list[Part]) -> list[Flowable]:
        sections = shown(parts)
        return [Sections(sections)] if sections else []

    return [
        *head(look, content),
        Spacer(0, 4 * mm),
        Bookmark("result", look.words("Result")),
        result_box(look, content, TEXT_WIDTH),
        *_results(look, content, limits),
        *evidence.below_results(look, content),
        *_not_covered(look, content),
        *filling_pages(figures),
        *shown(tables),
        *filling_pages(grounds),
        *shown(rest),
        *evidence.end(look, content),
    ]


def _results(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """The table of all results; one alone is told in full above."""
    if len(content.characteristics) < 2:
        return []
    budgets = () if "budget" in content.hidden else _with_budget(content)[: limits.budgets]
    return [Spacer(0, 3 * mm), result_table(look, content, budgets)]


def _with_budget(content: ReportContent) -> tuple[int, ...]:
    """Numbers of the characteristics that have a budget."""
    return tuple(number for number, one in enumerate(content.characteristics) if one.budget)


def _not_covered(look: ReportLook, content: ReportContent) -> list[Flowable]:
    stated = content.air_celsius is not None or content.part_celsius is not None
    words, gauge = look.words, content.gauge
    if len(content.characteristics) > 1:
        general = limits_of_inspection(words, temperatures=stated, corrected=content.at_reference)
    elif gauge:
        general = limits_of_thickness(gauge, words, temperatures=stated, corrected=content.at_reference)
    else:
        general = limits_of_cloud(words, temperatures=stated)
    sentences = general + tuple(words.known(limit) for limit in content.limits)
    return [section(look, "limits", "What this result does not cover", list(look.bullets(sentences)))]


def _surface(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    words = look.words
    if "surface" not in pictures:
        nothing = look.fixed_text("No point was measured, so there is no surface to show.")
        return [section(look, "surface", "Measured surface", [nothing])]
    drawn = len(content.mesh.triangles)
    if drawn:
        what = words("Mesh of {n} triangles", n=grouped(drawn))
    else:
        what = words("Cloud of {n} points", n=grouped(len(content.cloud)))
    caption = words(
        "{what}, in parallel projection, shaded; colour: {height}. Dimensions are those of the measured area. Blank: "
        "not measured.",
        what=what,
        height=_height(look, content),
    )
    body = [Picture(pictures["surface"], limits.picture_scale), look.text(caption, "caption")]
    return [section(look, "surface", "Measured surface", body)]


def _height(look: ReportLook, content: ReportContent) -> str:
    """What the colours of the surface are."""
    words = look.words
    return (
        words("height above the lower face")
        if content.gauge
        else words("height above the farthest points, towards the camera")
    )


def _view(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    if "view" not in pictures:
        return []
    words = look.words
    cut = "" if content.view is None or content.view.hidden is None else words("What the cut hid is not drawn.")
    caption = words(
        "From where the surface was looked at last, in parallel projection; colour: {height}.",
        height=_height(look, content),
    )
    body = [Picture(pictures["view"], limits.picture_scale), look.text(f"{caption} {cut}".strip(), "caption")]
    return [section(look, "view", "The surface as it was left in 3D", body)]


def _frame(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    overlay = content.overlay
    if overlay is None or "frame" not in pictures:
        return []
    crossings = plural_message("report.crossings", "{n:,} crossing", "{n:,} crossings", n=len(overlay.crossings))
    caption = (
        look.words(
            "Frame {name}, brightened, with {crossings} of the hand-moved line and the fan. σ is the standard "
            "uncertainty of the depth of the points on the hand-moved line.",
            name=overlay.name,
            crossings=look.words(crossings),
        )
        if content.has_fan
        else look.words(
            "Frame {name}, brightened. σ is the standard uncertainty of the depth of the points on the hand-moved "
            "line.",
            name=overlay.name,
        )
    )
    body = [Picture(pictures["frame"], limits.picture_scale), look.text(caption, "caption")]
    return [section(look, "frame", "One frame of the scan", body)]


def _profiles(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    profiles = content.profiles
    if profiles is None or "profiles" not in pictures:
        return []
    caption = look.words(
        "Points on the lines of {name}, by their height over the lower face; dashed: the two faces. Beside: what each "
        "picture gives, with ±2u of its own noise and form, and the mean with its U.",
        name=profiles.name,
    )
    body = [Picture(pictures["profiles"], limits.picture_scale), look.text(caption, "caption")]
    return [section(look, "profiles", "Light profiles", body)]


def _sections(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    """Each with its profile, and below it the rows that were measured in it."""
    parts: list[OnOnePage] = []
    for number, name in enumerate(content.sections):
        rows = [one for one in content.characteristics if content.features.get(one.name) == name]
        caption = look.words(
            "{name}: measured points near the plane of the section. Dimensions are those of what was measured.",
            name=name,
        )
        body: list[Flowable] = [
            Picture(pictures[f"section-{number}"], limits.picture_scale),
            look.text(caption, "caption"),
            *([characteristics_table(look, content, rows), Spacer(0, 2 * mm)] if rows else []),
        ]
        parts.append(OnOnePage(body) if number else section(look, "sections", "Cross-sections", body))
    return parts


def _points(look: ReportLook, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    if "points" not in pictures:
        return []
    caption = look.fixed_text(
        "Where in the picture the points lie that each result rests on; grey: other points of the cloud.", "caption"
    )
    body = [Picture(pictures["points"], limits.picture_scale), caption]
    return [section(look, "points", "Points the results rest on", body)]


def _maps(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    if "maps" not in pictures:
        return []
    picture = Picture(pictures["maps"], limits.picture_scale)
    if content.gauge is None:
        caption = look.fixed_text("Mean of the points in each cell of the picture; grey: no point.", "caption")
        return [section(look, "maps", "Depth and its uncertainty over the picture", [picture, caption])]
    caption = look.fixed_text(
        "Distance of the points from the fitted plane, mean per cell, towards the camera positive (orange); grey: no "
        "point. Along: to the right in the picture; across: upwards in the picture. Spread: share of the points per "
        "bin, what lies beyond counted in the last one.",
        "caption",
    )
    body = [*faces_table(look, content.gauge), Spacer(0, 2 * mm), picture, caption]
    return [section(look, "maps", "Residuals of both faces", body)]


def faces_table(look: ReportLook, gauge: GaugeResult) -> list[Flowable]:
    """Make the table of both faces: flatness and points used of each, and the angle between them."""
    words, faces = look.words, {UPPER: face_facts(gauge.upper), LOWER: face_facts(gauge.lower)}
    columns = [fact.column(words) for fact in faces[UPPER]]
    rows: list[list[Flowable]] = [heads(look, "Face", *columns, numbers=(1, 2, 3))]
    for name, facts in faces.items():
        numbers = (look.text(replace(fact, unit="").text(words), "number") for fact in facts)
        rows.append([look.text(capital(words(name)), "small"), *numbers])
    angle = angle_fact(gauge)
    return [
        ruled_table(rows, [TEXT_WIDTH * share for share in (0.25, 0.25, 0.25, 0.25)]),
        look.text(f"{capital(angle.title(words))}: {angle.text(words)}", "small"),
    ]


def _deviations(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[OnOnePage]:
    shown = [(number, one) for number, one in enumerate(content.deviations) if f"deviation-{number}" in pictures]
    parts: list[OnOnePage] = []
    for place, (number, one) in enumerate(shown):
        caption = look.words(
            "{name}: measured − nominal, outwards positive, as the camera sees it. Marks by quarters of the tolerance "
            "of {tolerance} mm: + ++ +++ outwards, − −− −−− inwards, with ! beyond it. Grey: not compared.",
            name=one.name,
            tolerance=look.words.general(one.tolerance_mm),
        )
        body: list[Flowable] = [
            Picture(pictures[f"deviation-{number}"], limits.picture_scale),
            look.text(caption, "caption"),
        ]
        title = label("Deviation from the nominal surface")
        parts.append(OnOnePage(body) if place else section(look, "deviation", title, body))
    return parts


def _budgets(look: ReportLook, content: ReportContent, limits: Limits) -> list[Flowable]:
    """Of every characteristic that has one, each with a heading that the table of results leads to."""
    known = _with_budget(content)
    parts: list[Flowable] = []
    for place, number in enumerate(known[: limits.budgets]):
        one = content.characteristics[number]
        title = look.words("Uncertainty budget of {name}", name=shown_name(one, look.words))
        body: list[Flowable] = [
            Heading(look, budget_key(number), title, *(("small_strong", 1) if len(known) > 1 else ())),
            budget_table(look, one),
            Spacer(0, 2 * mm),
        ]
        first = not place and len(known) > 1
        parts.append(section(look, "budget", "Uncertainty budget", body) if first else OnOnePage(body))
    return [*parts, *more_line(look, len(known) - limits.budgets, "inspection.json")]


def _repeats(look: ReportLook, content: ReportContent, pictures: Pictures, limits: Limits) -> list[Flowable]:
    first = repeats_head(look, content)
    if not first:
        return []
    if "repeats" in pictures:
        caption = look.fixed_text("Thickness with ±U of each scan, in the order of measuring.", "caption")
        first += [Spacer(0, 2 * mm), Picture(pictures["repeats"], limits.picture_scale), caption]
    head_part = section(look, "repeats", "Repeated scans", first)
    return [head_part, Spacer(0, 2 * mm), *repeats_table(look, content, limits.repeats)]


FACTS_PER_ROW = 3
"""Signatures beside each other."""

ROOM = 14 * mm
"""Above a line, for the hand."""


def signatures(look: ReportLook, content: ReportContent) -> list[Flowable]:
    """Make the lines to sign on: those named in the template, or one for the operator."""
    names = content.template.signatures or (content.operator,)
    own = [look.text(content.template.text, "small")] if content.template.text else []
    lines: list[Flowable] = []
    for start in range(0, len(names), FACTS_PER_ROW):
        row = names[start : start + FACTS_PER_ROW]
        cells = [[look.text(name, "small_strong"), look.fixed_text("Date, signature", "label")] for name in row]
        columns: list[list[Flowable]] = []
        for cell in cells:
            columns += [cell, []]
        width, gap = (TEXT_WIDTH - (FACTS_PER_ROW - 1) * 8 * mm) / FACTS_PER_ROW, 8 * mm
        table = plain_table([columns[:-1]], ([width, gap] * len(row))[:-1])
        above = [("LINEABOVE", (2 * place, 0), (2 * place, 0), 0.5, color(MUTED)) for place in range(len(row))]
        table.setStyle(TableStyle(above))
        lines += [Spacer(0, ROOM), table]
    return [section(look, "signatures", "Signatures", [*own, *lines])]
