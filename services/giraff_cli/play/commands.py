"""The options of `giraff play`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Topics, finite, require_extra


def play(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="That `giraff record` has written.")],
    robot: Annotated[
        str | None, typer.Option(metavar="NAME", help="Whom it is to be; else replay-NAME.", show_default=False)
    ] = None,
    connect: Connect = None,
    topics: Topics = None,
    rate: Annotated[
        float, typer.Option(metavar="N", min=0.01, max=100.0, callback=finite, help="Times as fast.")
    ] = 1.0,
    loop: Annotated[bool, typer.Option("--loop", help="Again and again, until Ctrl-C.")] = False,
    skip_gaps: Annotated[
        bool, typer.Option("--skip-gaps", help="Wait 2 s at most where nothing was recorded for longer.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Say again what a recording holds: order, rhythm and bytes as they were, under the name of a replay.

    In the name of a robot that is there it refuses whatever that robot's parts decide by. Exit code: 0; 1 a part of
    the file could not be read, or it ended early because such a robot came; 2 nothing was played.
    """
    require_extra("play", "mcap", "cli,record")
    from giraff_cli.play.player import play as run  # noqa: PLC0415

    raise typer.Exit(
        run(file, robot, connect or (), topics or (), rate, loop=loop, skip_gaps=skip_gaps, as_json=as_json)
    )
