"""Options that several commands take, in the same words everywhere."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

EPILOG = "Exit code: 0 done, 1 measured but out of tolerance or not proven, 2 bad input, 130 interrupted."


class Method(str, Enum):  # noqa: UP042  (Typer shows the values of a str Enum)
    """How a scan is solved."""

    network = "network"
    three_crossings = "three-crossings"


class Which(str, Enum):  # noqa: UP042
    """One of a rig's two targets."""

    camera = "camera"
    plane = "plane"


Set = Annotated[Path, typer.Argument(metavar="SET", help="The recording set: a folder with rig.toml and pictures.")]
Out = Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results; made if need be.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object for machines instead of a table.")]
MethodOption = Annotated[
    Method,
    typer.Option(
        help="network: all sweeps adjusted together. three-crossings: each frame from its own crossings with the fan, "
        "the paper's method, for comparison."
    ),
]
SigmaCut = Annotated[
    float, typer.Option("--sigma-cut", metavar="MM", help="Leave out points with a larger standard uncertainty.")
]
NoSkew = Annotated[bool, typer.Option("--no-skew", help="Fix the camera's skew γ to 0.")]
Part = Annotated[str, typer.Option(metavar="NAME", help="Name of the part in the report; else the name of SET.")]
K3 = Annotated[bool, typer.Option("--k3", help="Free the third radial coefficient, for wide lenses.")]


AdjustCamera = Annotated[
    bool,
    typer.Option(
        "--adjust-camera",
        help="Let the poses of the plane target correct the camera, in one adjustment with the fan: for a plane target "
        "of many points, or a camera calibrated from few views.",
    ),
]


StripeWidth = Annotated[
    float,
    typer.Option(
        "--stripe-width", metavar="PX", help="Visible width of the scan's stripes; 0: chosen from the pictures."
    ),
]
Contrast = Annotated[
    float,
    typer.Option("--contrast", metavar="GREY", help="Height of a rather faint stripe above its background; 0: chosen."),
]


Exclude = Annotated[
    list[str] | None,
    typer.Option(
        "--exclude",
        metavar="NAME",
        help="Leave this picture out: camera/view03.png, planes/pose02 or scan/frame0007.png; repeat for more.",
    ),
]


Profile = Annotated[
    bool, typer.Option("--profile", help="Say on standard error what each stage has cost in processor time.")
]
