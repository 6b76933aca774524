"""`trisect study`: what each study takes. Light to import; the work is in `core.wings.studies.studying`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from core.cli.options import Panel
from core.cli.usage import Commands
from core.messages import label

EPILOG = label(
    "Exit code: 0 done, and conforming, capable or acceptable if a limit was given; 1 measured, but not so, or not "
    "proven; 2 bad input, 70 a fault of the program, 129 hung up, 130 interrupted, 143 terminated."
)

studies = typer.Typer(
    cls=Commands,
    help="Judge a way of measuring: repeats, type-1 study, gauge R&R, acceptance check; or a series of parts.",
    epilog=EPILOG,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
commands = typer.Typer()
commands.add_typer(studies, name="study", rich_help_panel=Panel.RESULTS)

Files = Annotated[
    list[Path],
    typer.Argument(metavar="FILE", help="One CSV table, or several folders of results (trisect run, inspect)."),
]
Characteristic = Annotated[
    str,
    typer.Option("--characteristic", metavar="NAME", help="Which result of the folders, as inspection.json calls it."),
]
Nominal = Annotated[
    float | None, typer.Option("--nominal", metavar="VALUE", help="Nominal value; else the one the folders agree on.")
]
Tolerance = Annotated[
    float | None,
    typer.Option("--tolerance", metavar="VALUE", help="Largest permitted deviation, to either side: T is twice that."),
]
Out = Annotated[Path | None, typer.Option("--out", "-o", metavar="DIR", help="Write study.json there.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines instead of a table.")]


@studies.command(epilog=EPILOG)
def repeats(
    files: Files,
    characteristic: Characteristic = "thickness",
    nominal: Nominal = None,
    tolerance: Tolerance = None,
    u: Annotated[
        float | None,
        typer.Option("--u", metavar="VALUE", help="Standard uncertainty common to all repeats; else what they state."),
    ] = None,
    guard: Annotated[
        float,
        typer.Option("--guard", metavar="R", help="Guard band as R times U: 1, or 0.83 for 5 % risk, or 0 for none."),
    ] = 1.0,
    out: Out = None,
    json: Json = False,
) -> None:
    """Statistics of repeated scans of one part, U of their mean, and the decision by ISO 14253-1.

    Columns of a table: value, and if you like scan, u_mm (or U_mm and k).
    """
    from core.wings.studies import studying

    study = studying.repeats(files, characteristic, nominal, tolerance, u, guard)
    studying.finish(study, out, as_json=json)


@studies.command(epilog=EPILOG)
def type1(
    files: Files,
    characteristic: Characteristic = "thickness",
    nominal: Nominal = None,
    tolerance: Tolerance = None,
    resolution: Annotated[
        float | None, typer.Option("--resolution", metavar="VALUE", help="Of the gauge: at most 5 % of T.")
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Type-1 gauge study of a reference part: bias, Cg and Cgk (1.33 or more), t-test on the bias.

    --nominal is the calibrated value of the part. Columns of a table: value, and if you like scan.
    """
    from core.wings.studies import studying

    study = studying.type1(files, characteristic, nominal, tolerance, resolution)
    studying.finish(study, out, as_json=json)


@studies.command(epilog=EPILOG)
def series(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE", help="One CSV table, or folders of results or projects, in the order they were measured."
        ),
    ],
    characteristic: Characteristic = "thickness",
    nominal: Nominal = None,
    tolerance: Tolerance = None,
    u: Annotated[
        float | None,
        typer.Option("--u", metavar="VALUE", help="Standard uncertainty common to all parts; else what they state."),
    ] = None,
    subgroup: Annotated[
        int, typer.Option("--subgroup", metavar="N", help="So many parts in a row are a subgroup; 1: single values.")
    ] = 1,
    out: Out = None,
    json: Json = False,
) -> None:
    """Control charts of parts measured one after another, Cp, Cpk, Pp and Ppk with intervals, Western Electric rules.

    Columns of a table: value, and if you like part, u_mm (or U_mm and k).
    """
    from core.wings.studies import studying

    study = studying.series(files, characteristic, nominal, tolerance, u, subgroup)
    studying.finish(study, out, as_json=json)


@studies.command(epilog=EPILOG)
def grr(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A CSV table of part, operator, and value or result.")],
    characteristic: Characteristic = "thickness",
    tolerance: Tolerance = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Gauge R&R by analysis of variance: parts × operators × repeats.

    Columns of the table: part, operator, and value, or result: the folder of results, seen from the table.
    """
    from core.wings.studies import studying

    studying.finish(studying.grr(file, characteristic, tolerance), out, as_json=json)


@studies.command(epilog=EPILOG)
def acceptance(
    files: Files,
    artefact: Annotated[
        str, typer.Option(metavar="KIND", help="In folders: sphere, bar (two spheres) or plane stands there.")
    ] = "sphere",
    nominal: Annotated[
        float | None,
        typer.Option("--nominal", metavar="MM", help="Calibrated diameter of the sphere, or distance of a bar's two."),
    ] = None,
    u: Annotated[float, typer.Option("--u", metavar="MM", help="Standard uncertainty of that.")] = 0.0,
    diameter: Annotated[
        float | None, typer.Option("--diameter", metavar="MM", help="Of a bar's two spheres, by which they are found.")
    ] = None,
    form: Annotated[float | None, typer.Option("--form", metavar="MM", help="Largest permitted form error.")] = None,
    size: Annotated[float | None, typer.Option("--size", metavar="MM", help="Largest permitted size error.")] = None,
    spacing: Annotated[
        float | None, typer.Option("--spacing", metavar="MM", help="Largest permitted spacing error.")
    ] = None,
    flatness: Annotated[
        float | None, typer.Option("--flatness", metavar="MM", help="Largest permitted flatness error.")
    ] = None,
    out: Out = None,
    json: Json = False,
) -> None:
    """Acceptance check after the pattern of VDI/VDE 2634 part 2, in several positions; not a certificate.

    Columns of a table: quantity (form, size, spacing, flatness), position, measured_mm, and if you like calibrated_mm,
    u_mm. Or a folder of results for each position.
    """
    from core.cli.bar import bar
    from core.wings.studies import studying

    limits = {"form": form, "size": size, "spacing": spacing, "flatness": flatness}
    with bar() as progress:
        study = studying.acceptance(files, artefact, nominal, u, diameter, limits, progress)
    studying.finish(study, out, as_json=json)
