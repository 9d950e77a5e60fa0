"""The verbs of `giraff check`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, require_extra

check = typer.Typer(no_args_is_help=True, help="Checks that a robot must have passed before it drives.")


Port = Annotated[
    str | None, typer.Option(metavar="PATH", help="Of the base board; else the robot file's.", show_default=False)
]


@check.command()
def wheels(port: Port = None, as_json: AsJson = False) -> None:
    """With the wheels lifted: find out how motors and encoders are wired, and write it into the robot file.

    Asks before each step; giraff_base must not run. Exit code: 0 written; 1 in doubt, nothing written; 2 not begun.
    """
    require_extra("check wheels", "serial", "cli,serial")
    from giraff_setup.wheels.check import check_wheels  # noqa: PLC0415

    raise typer.Exit(check_wheels(port, as_json=as_json))


@check.command()
def encoders(
    port: Port = None,
    svg: Annotated[
        Path | None, typer.Option(metavar="FILE.svg", help="Also draw both channels there.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """With the wheels lifted: see both channels of each encoder, what is wrong with them and what to do.

    Asks once, then drives each wheel forward for 4 s; giraff_base must not run. It writes nothing into the robot file.
    Exit code: 0 fine; 1 something to put right; 2 not begun, or the board cannot do it.
    """
    require_extra("check encoders", "serial", "cli,serial")
    from giraff_setup.encoder.check import check_encoders  # noqa: PLC0415

    raise typer.Exit(check_encoders(port, svg, as_json=as_json))
