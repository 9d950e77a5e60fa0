"""The verbs of `giraff node`. What they do is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Robot

node = typer.Typer(no_args_is_help=True, help="The services of a robot: where they run, how they are, what they say.")


@node.command("list")
def list_nodes(robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """The services of a robot that are on the network, with host, pid and health.

    Exit code: 0 all are well; 1 one is not, or does not answer; 2 there is no robot to tell of.
    """
    from giraff_cli.node.report import list_nodes as run  # noqa: PLC0415

    raise typer.Exit(run(robot, connect or (), as_json=as_json))


@node.command("info")
def node_info(
    service: Annotated[str, typer.Argument(metavar="SERVICE", help="Like guard, or an instance.")],
    robot: Robot = None,
    connect: Connect = None,
    as_json: AsJson = False,
) -> None:
    """What one service tells of itself: host, faults and notices, what it says, listens to and answers, and to whom.

    Exit code: 0 it is well; 1 it is not, or does not answer; 2 it is not there.
    """
    from giraff_cli.node.report import info as run  # noqa: PLC0415

    raise typer.Exit(run(service, robot, connect or (), as_json=as_json))
