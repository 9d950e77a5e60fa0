"""The verbs of `giraff tune`. What they do is imported when it is asked for."""

from pathlib import Path
from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot, WrittenFile, require_extra

tune = typer.Typer(no_args_is_help=True, help="Find gains of a robot: see docs/commissioning.md, and docs/balancer.md.")


@tune.callback()
def verbs() -> None:
    """Find gains of a robot: see docs/commissioning.md, and docs/balancer.md."""


@tune.command()
def balance(
    file: Annotated[
        Path | None,
        typer.Option(metavar="PATH", help="A robot file; else GIRAFF_CONFIG's.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compute k1 to k4 of a robot that balances from the masses and lengths of its robot file, and draw a step of 5 cm.

    It asks no robot and changes none. Exit code: 0; 2 the file is none of a robot that balances, or is not sound.
    """
    require_extra("tune balance", "numpy", "analysis,cli")
    from giraff_setup.balancer.tune import tune_balance  # noqa: PLC0415

    raise typer.Exit(tune_balance(file, as_json=as_json))


@tune.command()
def speed(
    file: WrittenFile = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Find the gains by which the board of a robot on two wheels holds their speeds: it drives 0.5 m ahead and back.

    It asks before anything moves. When you have said yes, the gains found go into the table base.drive.speed_control of
    the robot file, you restart base, and it drives once more: they stay only where that drive is better, with a copy of
    the file as it was beside it. Otherwise the file is put back.

    Exit code: 0 done, or the file drives as well and stays; 1 refused or stopped, the file is as it was; 2 not begun.
    """
    require_extra("tune speed", "numpy", "analysis,cli")
    from giraff_setup.wheels.speed.tune import tune_speed  # noqa: PLC0415

    raise typer.Exit(tune_speed(robot, connect or (), file, as_json=as_json))
