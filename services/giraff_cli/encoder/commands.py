"""The verbs of `giraff encoder`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson

encoder = typer.Typer(no_args_is_help=True, help="Encoders that one makes oneself: a printed disk before two sensors.")


@encoder.command("disk")
def print_disk(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE.svg]", help="Else standard output.", show_default=False)
    ] = None,
    pairs: Annotated[int, typer.Option(metavar="N", help="Black and white sectors of a ring, in pairs.")] = 40,
    outer: Annotated[float, typer.Option(metavar="MM", help="Diameter of the disk.")] = 60.0,
    inner: Annotated[float, typer.Option(metavar="MM", help="Diameter at the inner edge of the inner ring.")] = 30.0,
    hole: Annotated[float, typer.Option(metavar="MM", help="Diameter of the hole for the shaft.")] = 6.0,
    as_json: AsJson = False,
) -> None:
    """Draw an encoder's disk of two black-and-white rings as SVG, to be printed in true size.

    Exit code: 0; 2 no such disk can be made, or the file cannot be written, or is there already, with the reason.
    """
    if as_json and file is None:
        raise typer.BadParameter("--json: name the drawing's file, which is standard output itself without a name")
    from giraff_setup.encoder.disk import print_disk as run  # noqa: PLC0415

    raise typer.Exit(run(file, pairs, outer, inner, hole, as_json=as_json))
