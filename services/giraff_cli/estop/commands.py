"""The verbs of `giraff estop`. What they do is imported when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot, finite

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_cli.estop.client import Result
    from giraff_cli.network.connection import RobotConnection


estop = typer.Typer(no_args_is_help=True, help="Stop the robot from any machine, and release it again.")

Timeout = Annotated[float, typer.Option(metavar="SECONDS", min=0.1, callback=finite, help="How long to try.")]


@estop.command()
def engage(
    robot: Robot = None,
    connect: Connect = None,
    timeout: Timeout = 5.0,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="Told to whoever asks why.")] = "stopped by hand",
    page: Annotated[
        str,
        typer.Option(
            metavar="HOST:PORT", help="Ask this page of the robot at once; else the last known.", show_default=False
        ),
    ] = "",
    off: Annotated[bool, typer.Option("--off", help="Also switch off a robot that stands by its motors.")] = False,
    as_json: AsJson = False,
) -> None:
    """Stop the robot now, and keep it stopped, also over restarts. Where none is named: every robot that is heard.

    Where Zenoh does not answer, the robot's page is asked, too.

    Exit code: 0 base confirms it, or on an open network whoever answers as base; 1 stopped, but the disk did not take
    it, or not off; 2 NOT CONFIRMED: use the battery switch.
    """
    from giraff_cli.estop.engage import engage_by_plan  # noqa: PLC0415

    raise typer.Exit(engage_by_plan(robot, connect or (), reason, timeout, page, off=off, as_json=as_json))


@estop.command()
def reset(robot: Robot = None, connect: Connect = None, timeout: Timeout = 5.0, as_json: AsJson = False) -> None:
    """Clear the latch that is engaged now. It permits motion and never causes it: a level hand must arm the robot.

    Exit code: 0 no latch is engaged; 1 still engaged; 2 unknown.
    """
    from giraff_cli.estop import client as it  # noqa: PLC0415
    from giraff_cli.network.user import user_at_host  # noqa: PLC0415

    def act(connection: RobotConnection) -> Result:
        return it.reset(connection, user_at_host(), timeout)

    _tell(robot, connect, timeout, act, moves=True, as_json=as_json)


@estop.command()
def status(robot: Robot = None, connect: Connect = None, timeout: Timeout = 3.0, as_json: AsJson = False) -> None:
    """Whether the robot's emergency stop is engaged, by whom and why.

    Exit code: 0 released; 1 engaged; 2 unknown.
    """
    from giraff_cli.estop import client as it  # noqa: PLC0415

    _tell(robot, connect, timeout, lambda connection: it.status(connection, timeout), as_json=as_json)


def _tell(
    robot: str | None,
    connect: list[str] | None,
    timeout: float,
    act: Callable[[RobotConnection], Result],
    *,
    moves: bool = False,
    as_json: bool,
) -> None:
    from giraff_cli.estop.engage import tell  # noqa: PLC0415
    from giraff_cli.network.command import run_with_robot  # noqa: PLC0415

    def say(connection: RobotConnection) -> int:
        return tell(act(connection), as_json=as_json)

    raise typer.Exit(run_with_robot(robot, connect or (), timeout, say, moves=moves, stands_in=False))
