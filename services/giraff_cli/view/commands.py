"""The words and options of `giraff view`."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import Connect, Robot, require_extra


def view(  # noqa: PLR0913, PLR0917  one argument an option
    recording: Annotated[
        Path | None, typer.Argument(metavar="FILE", help="Of `giraff record`; else the live robot.", show_default=False)
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    save: Annotated[
        Path | None, typer.Option(metavar="FILE", help="No window: write .rrd for `rerun FILE`.", show_default=False)
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="No window: write the last sight as PNG. Live: needs --for.", show_default=False
        ),
    ] = None,
    web: Annotated[
        bool, typer.Option("--web", help="No window: for every browser of the network, without a password.")
    ] = False,
    port: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1024, max=65534, help="Of --web, else 9090; data has the next.", show_default=False
        ),
    ] = None,
    memory: Annotated[
        str, typer.Option(metavar="LIMIT", help="Like 500MB or 25%; beyond it the oldest is forgotten.")
    ] = "1GB",
    seconds: Annotated[
        float | None, typer.Option("--for", metavar="SECONDS", help="Live: end after so long; else with Ctrl-C.")
    ] = None,
    camera: Annotated[bool, typer.Option("--camera", help="Live: ask for what its cameras see, too.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="For programs: one JSON object at the end.")] = False,
) -> None:
    """Floor plan, path, what the sensors see, guard's verdict, speeds and ages, drawn: live, or of a recording.

    Exit code: 0 shown; 1 the viewer or the disk failed, or a part of FILE cannot be read; 2 nothing to show.
    """
    require_extra("view", "rerun", "viewer,cli")
    if recording is not None:
        require_extra("view", "mcap", "viewer,cli,record")
    from giraff_cli.view.live import show  # noqa: PLC0415
    from giraff_cli.view.output import Options  # noqa: PLC0415

    options = Options(
        save=save, picture=picture, web=web, port=port, memory=memory, seconds=seconds, as_json=as_json, camera=camera
    )
    raise typer.Exit(show(recording, robot, connect or (), options))
