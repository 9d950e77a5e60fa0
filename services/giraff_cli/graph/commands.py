"""The options of `giraff graph`. What it does is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Listen, Robot


def graph(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 2.0,
    dot: Annotated[bool, typer.Option("--dot", help="For Graphviz: giraff graph --dot | dot -Tsvg.")] = False,
    as_json: AsJson = False,
) -> None:
    """Which service hears which, on what key.

    Exit code: 0; 2 there is no robot to tell of.
    """
    from giraff_cli.graph.graph import graph as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or (), seconds, as_dot=dot, as_json=as_json))
