"""The options of `giraff top`. What it does is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot


def top(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    once: Annotated[bool, typer.Option("--once", help="Show it once, and end.")] = False,
    as_json: AsJson = False,
) -> None:
    """A live board of a robot: what its services take of processor and memory, rates, losses and ages of its topics.

    In a terminal a live view, else one line a second; with --json an object a second. Exit code: 0; 2 there is no
    robot to tell of.
    """
    from giraff_cli.top.monitor import top as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or (), seconds, once=once, as_json=as_json))
