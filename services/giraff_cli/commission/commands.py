"""The options of `giraff commission`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson


def commission(
    file: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A robot file; else GIRAFF_CONFIG's.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List the steps from a new robot to a driving one, in their order: what is done, and what is left.

    It reads the robot file, asks no robot and changes nothing. A step that leaves nothing in the file is yours to know.

    Exit code: 0 nothing is left; 1 something is; 2 there is no robot file that can be read.
    """
    from giraff_setup.commission.steps import show  # noqa: PLC0415

    raise typer.Exit(show(file, as_json=as_json))
