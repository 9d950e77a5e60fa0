"""The options of `giraff replay`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, finite, require_extra


def replay(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="That `giraff record` has written.")],
    least: Annotated[
        float, typer.Option(metavar="SHARE", min=0.0, max=1.0, callback=finite, help="That must agree, of each key.")
    ] = 0.98,
    as_json: AsJson = False,
) -> None:
    """A recording through the policies of today's odometry, guard and vision: do they say what was said then?

    Exit code: 0 they do, but for the share that timing leaves open; 1 they do not, or a part of
    it cannot be read; 2 nothing could be compared.
    """
    require_extra("replay", "mcap", "cli,record")
    from giraff_cli.replay.runner import replay as run  # noqa: PLC0415

    raise typer.Exit(run(file, least, as_json=as_json))
