"""The options of `giraff watch`. What it does is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import Connect, Ending, Robot


def watch(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    as_json: Annotated[bool, typer.Option("--json", help="For programs: one JSON object a second.")] = False,
) -> None:
    """The operator's screen of a robot: path, velocity, ranges, who drives, what guard and base allow and why.

    In a terminal a live view, else one line a second. It only listens, waits for a robot that is not there yet, and
    takes one that comes back up again. Exit code: 0; 1 standard output takes nothing; 2 no robot came within --for,
    or several are there and none is named.
    """
    from giraff_cli.watch.monitor import watch as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or (), seconds, as_json=as_json))
