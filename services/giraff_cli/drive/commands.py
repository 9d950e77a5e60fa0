"""The options of `giraff drive`. What it does is imported when it is asked for."""

import typer

from giraff_cli.options import Connect, Robot


def drive(robot: Robot = None, connect: Connect = None) -> None:
    """Drive a robot with the keys of this terminal; no robot file is needed.

    It takes the robot from nobody: press an arrow key or c to ask for it, let go of all keys to arm, hold an arrow to
    drive. SPACE is the emergency stop, r then y releases it, Ctrl-C ends. Exit code: 0; 1 a stop was asked for and is
    NOT CONFIRMED: use the battery switch; 2 there is no terminal, or no robot that tells its limits.
    """
    from giraff_cli.drive.operate import drive as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or ()))
