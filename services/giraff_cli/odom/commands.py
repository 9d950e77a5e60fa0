"""The verbs of `giraff odom`. What they do is imported when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from giraff_cli.options import Connect, Robot, finite
from giraff_schemas.text import printable

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_cli.network.connection import RobotConnection
    from giraff_cli.odom.client import Result

odom = typer.Typer(no_args_is_help=True, help="Tell odometry where the robot is.")

Timeout = Annotated[float, typer.Option(metavar="SECONDS", min=0.1, callback=finite, help="How long to try.")]


@odom.command()
def reset(robot: Robot = None, connect: Connect = None, timeout: Timeout = 3.0) -> None:
    """Begin anew here: pose, path and their uncertainty are 0. It moves nothing, and may be done while driving.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_cli.odom import client as it  # noqa: PLC0415

    _tell(robot, connect, timeout, lambda connection: it.reset(connection, timeout))


# A negative number is no option.
@odom.command("set", context_settings={"ignore_unknown_options": True})
def set_pose(  # noqa: PLR0913, PLR0917  one argument an option
    x: Annotated[float, typer.Argument(metavar="X", callback=finite, help="m.", show_default=False)],
    y: Annotated[float, typer.Argument(metavar="Y", callback=finite, help="m.", show_default=False)],
    yaw: Annotated[float, typer.Argument(metavar="YAW", callback=finite, help="rad, to the left.", show_default=False)],
    degrees: Annotated[bool, typer.Option("--degrees", help="YAW and --yaw-sd are degrees.")] = False,
    position_sd: Annotated[
        float, typer.Option(metavar="METRES", min=0.0, callback=finite, help="How sure X and Y are, each.")
    ] = 0.0,
    yaw_sd: Annotated[float, typer.Option(metavar="RAD", min=0.0, callback=finite, help="How sure YAW is.")] = 0.0,
    robot: Robot = None,
    connect: Connect = None,
    timeout: Timeout = 3.0,
) -> None:
    """Take the robot to be at X, Y with heading YAW, in `odom`; its path goes on. It moves nothing.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_cli.network.command import print_error  # noqa: PLC0415
    from giraff_cli.odom import client as it  # noqa: PLC0415

    place = it.Place(x, y, yaw, position_sd, yaw_sd, degrees)
    if fault := place.fault():
        raise typer.Exit(print_error(fault))
    _tell(robot, connect, timeout, lambda connection: it.set_pose(connection, place, timeout))


def _tell(
    robot: str | None, connect: list[str] | None, timeout: float, act: Callable[[RobotConnection], Result]
) -> None:
    from giraff_cli.network.command import print_error, run_with_robot  # noqa: PLC0415

    def say(connection: RobotConnection) -> int:
        code, text = act(connection)
        if code:
            print_error(text)
        else:
            print(printable(text), flush=True)
        return code

    raise typer.Exit(run_with_robot(robot, connect or (), timeout, say, moves=True))
