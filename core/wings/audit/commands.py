"""`trisect verify`, `audit` and `people`: is a project what it was, who changed what, who may. Light to import."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from core.cli.bar import bar
from core.cli.language import current_language, text_of, tr
from core.cli.options import EPILOG, ExitCode, Json, Panel, one_of

if TYPE_CHECKING:
    from core.wings.audit.trail import Entry

commands = typer.Typer()


@commands.command(epilog=EPILOG, rich_help_panel=Panel.PROJECTS)
def verify(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A project, or a folder of results.")],
    set_: Annotated[
        Path | None, typer.Option("--set", metavar="SET", help="The recording set that a folder of results is of.")
    ] = None,
    head: Annotated[
        str, typer.Option(metavar="HASH", help="What a report prints of the audit trail: is it one of this project's?")
    ] = "",
    json: Json = False,
) -> None:
    """Is everything still what it was? The audit trail link by link, the results, and all they were made of."""
    from core.cli.measuring import Shown
    from core.cli.output import notes_json
    from core.wings.audit.verify import verify as compare

    with bar() as progress:
        found = compare(folder, set_, head, progress)
    rows = [
        (
            tr("audit trail"),
            tr("{n} entries, head {head}", n=len(found.trail.entries), head=found.trail.head or tr("none")),
        ),
        (tr("results"), tr("{n} compared", n=found.results)),
        (tr("inputs"), tr("{n} compared", n=found.inputs)),
        (tr("differs"), str(len(found.problems))),
        *(("", text_of(problem)) for problem in found.problems),
    ]
    values = {
        "entries": len(found.trail.entries),
        "head": found.trail.head,
        "results": found.results,
        "inputs": found.inputs,
        "problems": notes_json(found.problems),
    }
    Shown(rows, values, found.notes).show(as_json=json)
    raise typer.Exit(ExitCode.NOT_PROVEN if found.problems else ExitCode.DONE)


@commands.command(rich_help_panel=Panel.PROJECTS)
def audit(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write it as a table, too.")] = None,
    remark: Annotated[str, typer.Option(metavar="TEXT", help="Add an entry with this text first.")] = "",
    sign: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Sign the project as it is; the PIN is asked for, --remark says what it means."
        ),
    ] = "",
    json: Json = False,
) -> None:
    """Show a project's audit trail: who did what and when, old and new."""
    from core.cli.measuring import Shown
    from core.files.atomic import write_text
    from core.files.project.folder import read_project
    from core.wings.audit.people import sign as sign_project
    from core.wings.audit.trail import append, read_trail, trail_table

    read_project(project)
    if sign:
        sign_project(project, sign, _pin(sign), remark)
    elif remark:
        append(project, "remark", why=remark)
    trail = read_trail(project)
    rows = []
    for entry in trail.entries:
        rows.append((f"{entry.n}  {current_language().time(entry.at, seconds=True)}", _told(entry)))
        rows += [("", f"{one.field}: {one.old or '–'} → {one.new or '–'}") for one in entry.changes]
        rows += [("", f"{name}: {digest}") for name, digest in entry.files.items()]
        rows += [("", entry.why)] if entry.why else []
    if csv is not None:
        write_text(csv, trail_table(trail))
    entries = [
        {**asdict(entry), "at": entry.at.isoformat(), "changes": [asdict(one) for one in entry.changes]}
        for entry in trail.entries
    ]
    files = {"table": csv} if csv is not None else {}
    Shown(rows, {"entries": entries, "head": trail.head}, trail.problems, files).show(as_json=json)


@commands.command(rich_help_panel=Panel.PROJECTS)
def people(
    project: Annotated[Path, typer.Argument(metavar="PROJECT", help="The folder of a project.")],
    add: Annotated[
        str,
        typer.Option(metavar="NAME", help="Name somebody, or change role and PIN, which is asked for."),
    ] = "",
    role: Annotated[str, typer.Option(metavar="ROLE", help="operator, inspector or administrator.")] = "operator",
    remove: Annotated[str, typer.Option(metavar="NAME", help="Remove somebody.")] = "",
    reasons: Annotated[
        bool | None,
        typer.Option("--reasons/--no-reasons", help="Ask why limits are changed after something was judged."),
    ] = None,
    by: Annotated[str, typer.Option("--by", metavar="NAME", help="The administrator; the PIN is asked for.")] = "",
    reset: Annotated[
        str, typer.Option(metavar="WHY", help="Everybody may do everything again; for lost PINs. The trail keeps why.")
    ] = "",
    json: Json = False,
) -> None:
    """Who may do what in a project, by names with PINs: off until the first administrator is named."""
    from dataclasses import replace

    from core.cli.measuring import Shown
    from core.files.project.folder import read_project
    from core.wings.audit.people import ROLES, Role, person, read_rules, reset_rules, with_pin, write_rules

    read_project(project)
    if reset:
        reset_rules(project, reset)
    rules = read_rules(project)
    administrator = with_pin(rules, by, _pin(by)) if by else None
    changed = rules if reasons is None else replace(rules, reasons=reasons)
    if remove:
        one_of(remove, [one.name for one in rules.people], "--remove")
    left = [one for one in changed.people if one.name not in (add, remove)]
    if add:
        left.append(person(add, cast(Role, one_of(role, ROLES, "--role")), _pin(add)))
    changed = replace(changed, people=tuple(left))
    if changed != rules:
        write_rules(project, changed, administrator)
    rows: list[tuple[str, str]] = [(one.name, text_of(one.role)) for one in changed.people] or [
        (tr("people"), tr("everybody may do everything"))
    ]
    rows.append((tr("reasons"), tr("asked for when limits change" if changed.reasons else "not asked for")))
    values = {"people": [{"name": one.name, "role": one.role} for one in changed.people], "reasons": changed.reasons}
    Shown(rows, values).show(as_json=json)


def _told(entry: Entry) -> str:
    from core.wings.audit.people import ROLE_NAMES
    from core.wings.audit.trail import WHAT_NAMES

    said = tr("{what} by {who} on {host}", what=tr(WHAT_NAMES[entry.what]), who=entry.who, host=entry.host)
    if entry.role not in ROLE_NAMES:
        return said
    return current_language().joined([said, f"{entry.by} ({tr(ROLE_NAMES[entry.role])})"])


def _pin(name: str) -> str:
    """Read a person's PIN: from the terminal without showing it, else as a line of standard input."""
    import getpass
    import sys

    if sys.stdin.isatty():
        return getpass.getpass(tr("PIN of {name}: ", name=name))
    return sys.stdin.readline().rstrip("\n")
