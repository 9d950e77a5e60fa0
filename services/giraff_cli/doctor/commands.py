"""The words and options of `giraff doctor`."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot, finite


def doctor(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Annotated[
        float, typer.Option("--for", metavar="SECONDS", min=1.0, callback=finite, help="How long to listen.")
    ] = 1.5,
    as_json: AsJson = False,
) -> None:
    """What is wrong with robot, network and this machine, each with its way out. To be asked on each machine.

    Exit code: 0 no fault; 1 at least one; 2 it could not look.
    """
    from giraff_cli.doctor.examine import examine  # noqa: PLC0415

    raise typer.Exit(examine(robot, connect or (), seconds, as_json=as_json))
