"""The verbs of `giraff map`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, finite

maps = typer.Typer(no_args_is_help=True, help="Floor plans, on which the robot is looked for: see docs/maps.md.")


@maps.command()
def show(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A room (.toml), or a grid of ROS's map_server (.yaml).")
    ],
    svg: Annotated[Path | None, typer.Option(metavar="OUT", help="Also draw it as SVG.")] = None,
    as_json: AsJson = False,
) -> None:
    """Draw a floor plan, with its size: what localization will see in the file.

    Exit code: 0; 2 the file is no map that can be used, or OUT cannot be written.
    """
    from giraff_setup.map.show import show as run  # noqa: PLC0415

    raise typer.Exit(run(file, svg, as_json=as_json))


@maps.command()
def convert(
    room: Annotated[Path, typer.Argument(metavar="ROOM", help="A room (.toml).")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="A new file (.yaml); its image (.pgm) comes beside it.")],
    resolution: Annotated[
        float, typer.Option(metavar="METRES", min=0.001, callback=finite, help="Side of a cell.")
    ] = 0.05,
    as_json: AsJson = False,
) -> None:
    """Write a room as an occupancy grid, for ROS's map_server and nav2, or for an image editor.

    Exit code: 0 written; 2 not.
    """
    from giraff_setup.map.convert import convert as run  # noqa: PLC0415

    raise typer.Exit(run(room, out, resolution, as_json=as_json))
