"""The options of `giraff ros2`. What it does is imported when it is asked for."""

from typing import Annotated, Literal

import typer

from giraff_cli.options import Connect, Robot, require_service


def ros2(
    robot: Robot = None,
    connect: Connect = None,
    namespace: Annotated[
        str | None, typer.Option(metavar="NAME", help="Like r1, for /r1/odom; else /odom.", show_default=False)
    ] = None,
    domain: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=0, max=232, help="ROS_DOMAIN_ID of the ROS programs; else 0.", show_default=False
        ),
    ] = None,
    distribution: Annotated[
        Literal["humble", "jazzy", "kilted"] | None,
        typer.Option(help="ROS 2 distribution of the ROS programs; else kilted.", show_default=False),
    ] = None,
    router: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT", help="The ROS programs' Zenoh router; else 127.0.0.1:7447.", show_default=False
        ),
    ] = None,
) -> None:
    """Show a robot to ROS 2 programs as one of their nodes, which they see and drive; no ROS is installed for it.

    It prints the lines that each ROS terminal needs. The ROS programs must use rmw_zenoh_cpp. All that publish /cmd_vel
    are one operator, from which any person takes the robot. What an option leaves out is read from the table [ros2] of
    the robot file, where there is one. Ctrl-C ends it, and the robot stops.

    Exit code: 0; 1 it failed; 2 there is no robot that tells its limits, or no way to ROS.
    """
    from giraff_schemas.services import ROS2  # noqa: PLC0415

    require_service("ros2", ROS2, "cli")
    from giraff_cli.ros2.serve import serve  # noqa: PLC0415

    given = {"namespace": namespace, "domain": domain, "distribution": distribution, "router": router}
    raise typer.Exit(serve(robot, connect or (), {name: each for name, each in given.items() if each is not None}))
