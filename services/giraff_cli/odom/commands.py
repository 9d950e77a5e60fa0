"""The verbs of `giraff odom`. What they do is imported when it is asked for."""

import math
from typing import TYPE_CHECKING, Annotated

import typer

from giraff_cli.options import NEGATIVE, AsJson, Connect, Robot, finite, parsed, typed_pose
from giraff_schemas.text import printable
from giraff_tools import typed

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_cli.odom.client import Result
    from giraff_tools.network.connection import RobotConnection

odom = typer.Typer(no_args_is_help=True, help="Tell odometry where the robot is.")

Timeout = Annotated[float, typer.Option(metavar="SECONDS", min=0.1, callback=finite, help="How long to try.")]


def _deviation(text: str) -> float:
    if not 0.0 <= (rad := typed.angle(text)) <= math.tau:
        raise ValueError(f"{text} is no deviation of an angle: give 0deg to 360deg")
    return rad


@odom.command()
def reset(robot: Robot = None, connect: Connect = None, timeout: Timeout = 3.0, as_json: AsJson = False) -> None:
    """Begin anew here: pose, path and their uncertainty are 0. It moves nothing, and may be done while driving.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_cli.odom import client  # noqa: PLC0415

    _report(robot, connect, timeout, lambda met: client.reset(met, timeout), as_json=as_json)


@odom.command("set", context_settings=NEGATIVE)
def set_pose(
    pose: Annotated[
        list[str], typer.Argument(metavar="X,Y,YAW", help="Like 1.5,-2,90deg; YAW to the left.", show_default=False)
    ],
    position_sd: Annotated[
        float, typer.Option(metavar="METRES", min=0.0, callback=finite, help="How sure X and Y are, each.")
    ] = 0.0,
    yaw_sd: Annotated[
        float, typer.Option(metavar="ANGLE", parser=parsed(_deviation), help="How sure YAW is, like 5deg.")
    ] = 0.0,
    robot: Robot = None,
    connect: Connect = None,
    timeout: Timeout = 3.0,
    as_json: AsJson = False,
) -> None:
    """Take the robot to be at X, Y with heading YAW, in `odom`; its path goes on. It moves nothing.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_cli.odom import client  # noqa: PLC0415
    from giraff_tools.network.command import print_error  # noqa: PLC0415

    try:
        place = typed_pose(pose)
    except ValueError as error:
        raise typer.Exit(print_error(f"odom set: {error}")) from None
    _report(
        robot, connect, timeout, lambda met: client.set_pose(met, place, position_sd, yaw_sd, timeout), as_json=as_json
    )


def _report(
    robot: str | None,
    connect: list[str] | None,
    timeout: float,
    act: "Callable[[RobotConnection], Result]",
    *,
    as_json: bool,
) -> None:
    from giraff_tools.network.command import print_error, run_with_robot  # noqa: PLC0415
    from giraff_tools.terminal.page import print_json  # noqa: PLC0415

    def say(connection: "RobotConnection") -> int:
        result = act(connection)
        if as_json:
            print_json(result._asdict())
        elif result.code:
            print_error(result.text)
        else:
            print(printable(result.text), flush=True)
        return result.code

    raise typer.Exit(run_with_robot(robot, connect or (), say, patience=timeout, moves=True))
