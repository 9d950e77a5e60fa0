"""The options of `giraff why`. What it does is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import Connect, Robot, finite


def why(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Annotated[
        float, typer.Option("--for", metavar="SECONDS", min=0.6, callback=finite, help="How long to listen.")
    ] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="For programs.")] = False,
) -> None:
    """What stops the robot now: the chain from hand to wheel, and its first broken link.

    Exit code: 0 the robot drives, or would if asked to; 1 something stops it; 2 there is no robot to tell of.
    """
    from giraff_cli.why.explain import explain  # noqa: PLC0415
    from giraff_tools.network.command import run_with_robot  # noqa: PLC0415

    raise typer.Exit(run_with_robot(robot, connect or (), lambda met: explain(met, seconds, as_json=as_json)))
