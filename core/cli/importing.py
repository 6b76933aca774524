"""`trisect import`: how the given folders were read, and the recording set made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from core.cli import output
from core.cli.bar import bar
from core.cli.language import current_language, text_of, tr
from core.files.recording.import_pictures import IMPORTED, Imported, import_pictures, require_free
from core.files.recording.import_plan import ImportedPicture, ImportPlan, ImportRequest, Order, Where, plan_import
from core.files.recording.recording_set import CHECK
from core.messages import Message, label, plural_message, visible

_COLUMNS = (label("name in the set"), label("picture"), label("fan off"), label("taken at"))


def understood(parts: Mapping[str, str], reference: Path | None, order: str) -> ImportPlan:
    """Plan an import from the text typed for each part of a recording set ("" for none), a reference and an order."""
    asked: dict[str, Any] = {part: Where.typed(text) for part, text in parts.items() if text}
    with bar() as progress:
        return plan_import(ImportRequest(**asked, reference=reference, order=Order(order)), progress)


def show(plan: ImportPlan, target: Path, rig: Path | None, *, dry_run: bool, as_json: bool) -> None:
    """Import the pictures as planned, or, with `dry_run`, only check the target folder; then print the plan."""
    if dry_run:
        require_free(plan, target, rig)
        imported = None
    else:
        with bar() as progress:
            imported = import_pictures(plan, target, rig, progress)
    notes = (*plan.notes, *plan.proposals) if imported is None else imported.all_notes
    if as_json:
        output.print_json(_values(plan, imported, notes))
        return
    if imported is None:
        _print_pictures(plan.pictures)
    rows = [(part, _part_in_words(plan, part)) for part in plan.parts]
    if imported is not None:
        ways = current_language().joined(
            [tr("{n} as {way}", n=n, way=text_of(way)) for way, n in imported.ways.items()]
        )
        rows += [(tr("files"), ways), (tr("written"), f"{target}: {', '.join(plan.parts)}, {IMPORTED}")]
    output.print_rows(rows, notes if imported is not None else (*notes, _NOTHING_WRITTEN))


_NOTHING_WRITTEN = Message("import.dry_run", "Nothing is written; the same without --dry-run writes the set.")


def _print_pictures(pictures: Sequence[ImportedPicture]) -> None:
    columns = [name for name in _COLUMNS if name not in _empty_columns(pictures)]
    table = Table(box=None, padding=(0, 2, 0, 0))
    for name in columns:
        table.add_column(text_of(name), overflow="fold")
    for one in pictures:
        values = dict(zip(_COLUMNS, _row(one), strict=True))
        table.add_row(*(visible(values[name]) for name in columns))
    output.console().print(table)


def _row(one: ImportedPicture) -> tuple[str, str, str, str]:
    on, _ = one.files()[0]
    taken = "" if one.taken_at is None else str(one.taken_at)
    return on, one.shown_name, "" if one.off is None else one.off.name, taken


def _empty_columns(pictures: Sequence[ImportedPicture]) -> set[str]:
    columns = zip(_COLUMNS, zip(*map(_row, pictures), strict=True), strict=True)
    return {name for name, values in columns if not any(values)}


def _part_in_words(plan: ImportPlan, part: str) -> str:
    pictures = plan.parts[part]
    pairs = sum(one.off is not None for one in pictures)
    counted = (
        plural_message("import.pictures", "{n:,} picture", "{n:,} pictures", n=len(pictures))
        if part not in ("planes", CHECK)
        else plural_message(
            "import.poses", "{n:,} pose, {pairs} paired", "{n:,} poses, {pairs} paired", n=len(pictures), pairs=pairs
        )
    )
    folders = dict.fromkeys(str(path.parent) for one in pictures for _, path in one.files())
    joined = current_language().joined(list(folders), "and")
    return tr("{pictures}, {rule}; from {folders}", pictures=counted, rule=plan.rules[part], folders=joined)


def _values(plan: ImportPlan, imported: Imported | None, notes: Sequence[Message]) -> dict[str, object]:
    return {
        "set": None if imported is None else str(imported.folder),
        "files": {} if imported is None else dict(imported.ways),
        "rules": {part: str(rule) for part, rule in plan.rules.items()},
        "pictures": [{"name": name, "from": str(path)} for one in plan.pictures for name, path in one.files()],
        "notes": output.notes_json(notes),
    }
