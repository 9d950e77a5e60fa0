"""The verbs of `giraff place`. What they do is imported when it is asked for."""

from typing import TYPE_CHECKING, Annotated

import typer

from giraff_cli.options import NEGATIVE, AsJson, Connect, Robot, typed_pose
from giraff_tools import typed

if TYPE_CHECKING:
    from collections.abc import Callable

    from giraff_schemas.places import PlaceChange

place = typer.Typer(no_args_is_help=True, help="Places by name, and no-go lines, on the robot's floor plan.")

Name = Annotated[str, typer.Argument(metavar="NAME", help="Like kitchen.", show_default=False)]


@place.command(context_settings=NEGATIVE)
def add(
    called: Name,
    pose: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[X,Y,YAW]",
            help="Like 1.5,-2,90deg on the map; YAW to the left. Else where the robot is.",
            show_default=False,
        ),
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Give a place a name. It moves nothing.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_schemas.localization import PlanarPose  # noqa: PLC0415
    from giraff_schemas.places import PlaceAdd, require_place_name  # noqa: PLC0415

    def change() -> PlaceAdd:
        require_place_name(called)
        if not pose:
            return PlaceAdd(name=called)
        x, y, yaw = typed_pose(pose)
        return PlaceAdd(name=called, pose=PlanarPose(x=x, y=y, yaw=yaw))

    _set("add", robot, connect, change, as_json=as_json)


@place.command("list")
def list_places(robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """All places and lines of the plan, and why they do not count now, if so.

    Exit code: 0 done; 2 no robot, or no giraff_places is heard.
    """
    from giraff_cli.place.client import show  # noqa: PLC0415

    raise typer.Exit(show(robot, connect or (), as_json=as_json))


@place.command()
def remove(called: Name, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """Remove a place, or a line.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_schemas.places import PlaceRemove, require_place_name  # noqa: PLC0415

    _set("remove", robot, connect, lambda: PlaceRemove(name=require_place_name(called)), as_json=as_json)


@place.command(context_settings=NEGATIVE)
def forbid(
    begin: Annotated[str, typer.Argument(metavar="X,Y", help="One end, m on the map.", show_default=False)],
    end: Annotated[str, typer.Argument(metavar="X,Y", help="The other end.", show_default=False)],
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Draw a line that no route crosses. The guard does not know it, and a hand drives over it.

    Exit code: 0 done; 1 refused, with the reason; 2 no robot, or nobody has answered.
    """
    from giraff_schemas.places import PlaceForbid  # noqa: PLC0415

    def change() -> PlaceForbid:
        (x, y), (end_x, end_y) = typed.point(begin), typed.point(end)
        return PlaceForbid(x=x, y=y, end_x=end_x, end_y=end_y)

    _set("forbid", robot, connect, change, as_json=as_json)


def _set(
    verb: str, robot: str | None, connect: list[str] | None, change: "Callable[[], PlaceChange]", *, as_json: bool
) -> None:
    from giraff_cli.place.client import set_places  # noqa: PLC0415
    from giraff_tools.network.command import print_error  # noqa: PLC0415

    try:
        wanted = change()
    except ValueError as error:
        raise typer.Exit(print_error(f"place {verb}: {error}")) from None
    raise typer.Exit(set_places(robot, connect or (), wanted, as_json=as_json))
