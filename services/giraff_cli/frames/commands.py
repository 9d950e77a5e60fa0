"""The options of `giraff frames`. What it does is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot


def frames(
    robot: Robot = None,
    connect: Connect = None,
    source: Annotated[
        str | None, typer.Option("--from", metavar="FRAME", help="Tell the pose of this frame in another, with --to.")
    ] = None,
    target: Annotated[str | None, typer.Option("--to", metavar="FRAME", help="The frame in which it is told.")] = None,
    svg: Annotated[Path | None, typer.Option(metavar="FILE", help="Also draw the tree as SVG.")] = None,
    dot: Annotated[bool, typer.Option("--dot", help="For Graphviz: giraff frames --dot | dot -Tsvg.")] = False,
    as_json: AsJson = False,
) -> None:
    """The tree of the robot's frames, from map, or else odom, to its parts, and where each is in its parent.

    With --from and --to: where the one is in the other, now.

    Exit code: 0; 1 they are no tree, or nothing joins the two; 2 nobody tells where they are, there is no such frame,
    or FILE cannot be written.
    """
    if (source is None) != (target is None):
        given, other = ("--from", "--to") if target is None else ("--to", "--from")
        raise typer.BadParameter(f"{given} needs {other}: the pose of one frame in another")
    if sum((source is not None, svg is not None, dot)) > 1:
        raise typer.BadParameter("give one of --svg, --dot, and --from with --to")
    from giraff_cli.frames.show import Wanted  # noqa: PLC0415
    from giraff_cli.frames.show import frames as run  # noqa: PLC0415

    wanted = Wanted(source=source, target=target, svg=svg, dot=dot, as_json=as_json)
    raise typer.Exit(run(robot, connect or (), wanted))
