"""The options of `giraff vision`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, require_extra


def vision(
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="A recording (.mcap) of `giraff record --camera`, or a video.",
            show_default=False,
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Its table in the robot file; else that of the table vision, or the only one.",
            show_default=False,
        ),
    ] = None,
    file: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Robot file; else the recording's, or GIRAFF_CONFIG's.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """How a camera saw the robot move over the floor, of a recording or a video, and a summary of it.

    Live: giraff view --camera draws it, and giraff topic echo visual_odom prints it.

    Exit code: 0; 1 a part of the file cannot be read; 2 no picture, or no camera.
    """
    if source is None:
        typer.echo(
            "giraff vision: name a recording or a video with --from FILE; a live robot is seen with "
            "giraff view --camera, or giraff topic echo visual_odom",
            err=True,
        )
        raise typer.Exit(2)
    for library in ("cv2", "mcap"):
        require_extra("vision", library, "camera,cli,record")
    from giraff_cli.vision.offline import measure_recording  # noqa: PLC0415

    raise typer.Exit(measure_recording(source, camera, file, as_json=as_json))
