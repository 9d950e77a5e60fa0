"""The verbs of `giraff check`. What they do is imported when it is asked for."""

from __future__ import annotations

from typing import Annotated

import typer

from giraff_cli.options import AsJson

check = typer.Typer(no_args_is_help=True, help="Checks that a robot must have passed before it drives.")


@check.command()
def wheels(
    port: Annotated[
        str | None, typer.Option(metavar="PATH", help="Of the base board; else the robot file's.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """With the wheels lifted: find out how motors and encoders are wired, and write it into the robot file.

    Asks before each step; giraff_base must not run. Exit code: 0 written; 1 in doubt, nothing written; 2 not begun.
    """
    from giraff_cli.check.wheels import check_wheels  # noqa: PLC0415

    raise typer.Exit(check_wheels(port, as_json=as_json))
