"""The words and options of `giraff param`. What they do is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot

param = typer.Typer(no_args_is_help=True, help="What the services go by, and what of it may change while they run.")

Name = Annotated[str, typer.Argument(metavar="SERVICE.FIELD", help="Like guard.margin.", show_default=False)]
Table = Annotated[
    str, typer.Argument(metavar="NAME", help="Like guard.margin, or guard for all of it.", show_default=False)
]
Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="NAME", help="Like guard.margin, or guard for all of it.", show_default=False),
]


@param.command("list")
def list_params(names: Names = None, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """Every parameter of every service: its value, and what may be done to it now.

    Exit code: 0; 1 a service did not answer, or two differ in what they should share; 2 no robot, or no such parameter.
    """
    from giraff_cli.param.client import show  # noqa: PLC0415
    from giraff_cli.param.format import listed  # noqa: PLC0415

    raise typer.Exit(show(robot, connect or (), names or (), listed, as_json=as_json))


@param.command()
def get(name: Table, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """The value of one parameter, or all of a service with their names.

    Exit code: 0; 1 the service did not answer; 2 no robot, or no such parameter.
    """
    from giraff_cli.param.client import show  # noqa: PLC0415
    from giraff_cli.param.format import listed, values  # noqa: PLC0415

    raise typer.Exit(show(robot, connect or (), (name,), values if "." in name else listed, as_json=as_json))


@param.command()
def describe(names: Names = None, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """What a parameter is for, its unit and type, what the robot file says, and what may be done to it now.

    Exit code: as of `list`.
    """
    from giraff_cli.param.client import show  # noqa: PLC0415
    from giraff_cli.param.format import described  # noqa: PLC0415

    raise typer.Exit(show(robot, connect or (), names or (), described, as_json=as_json))


@param.command("set", context_settings={"ignore_unknown_options": True})
def set_param(
    name: Name,
    value: Annotated[str, typer.Argument(metavar="VALUE", help="As in the robot file; none for no value.")],
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """Set one parameter at once, until the service ends; `save` keeps it. What bears on safety can only be tightened.

    Exit code: 0 in force; 1 refused, with the reason; 2 no robot, no such parameter or value, or nobody has answered.
    """
    from giraff_cli.param.client import set_one  # noqa: PLC0415

    raise typer.Exit(set_one(robot, connect or (), name, value, as_json=as_json))


@param.command()
def save(names: Names = None, robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """Keep over restarts what is in force now, on the service's own host; nothing more than the robot file allows.

    Exit code: 0 on disk; 1 refused by one at least, with the reason; 2 no robot, no such name, or no answer.
    """
    from giraff_cli.param.client import save_some  # noqa: PLC0415

    raise typer.Exit(save_some(robot, connect or (), names or (), as_json=as_json))
