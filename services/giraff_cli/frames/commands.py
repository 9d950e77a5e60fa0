"""The options of `giraff frames`. What it does is imported when it is asked for."""

from __future__ import annotations

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot


def frames(
    robot: Robot = None,
    connect: Connect = None,
    dot: Annotated[bool, typer.Option("--dot", help="For Graphviz: giraff frames --dot | dot -Tsvg.")] = False,
    as_json: AsJson = False,
) -> None:
    """The tree of the robot's frames, from odom to the sensors, and where each is in its parent.

    Exit code: 0; 1 they are no tree; 2 nobody tells where they are.
    """
    from giraff_cli.frames.tree import frames as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), as_dot=dot, as_json=as_json))
