"""Options that several commands have."""

from __future__ import annotations

from typing import Annotated

import typer

Robot = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Else GIRAFF_ROBOT_NAME, else the robot file's, else the only one on the network.",
        show_default=False,
    ),
]
Connect = Annotated[
    list[str] | None,
    typer.Option(metavar="HOST", help="Like 192.168.1.20, where multicast does not reach.", show_default=False),
]
AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]
