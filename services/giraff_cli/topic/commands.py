"""The words and options of `giraff topic`, `node`, `graph`, `frames` and `top`. What they do is imported on demand."""

from __future__ import annotations

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot, finite

topic = typer.Typer(no_args_is_help=True, help="What is said on a robot's network: who says it, how often, how much.")
node = typer.Typer(no_args_is_help=True, help="The services of a robot: where they run, how they are, what they say.")


Listen = Annotated[
    float, typer.Option("--for", metavar="SECONDS", min=0.1, callback=finite, help="How long to listen.")
]
Key = Annotated[str, typer.Argument(metavar="KEY", help="Below giraff/<robot>/, like odom, range/rear or range/*.")]
AnyKey = Annotated[
    str | None,
    typer.Argument(metavar="[KEY]", help="Like odom, range/rear or range/*; else all.", show_default=False),
]


def add_to(app: typer.Typer) -> None:
    """Make them words of `giraff`."""
    app.add_typer(topic, name="topic")
    app.add_typer(node, name="node")
    app.command()(graph)
    app.command()(frames)
    app.command()(top)


@topic.command("list")
def list_topics(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 2.0,
    as_json: AsJson = False,
) -> None:
    """The keys of a robot: type, rate by the table and now, who publishes and who listens.

    Exit code: 0; 2 there is no robot to tell of.
    """
    from giraff_cli.topic import listing as it  # noqa: PLC0415

    raise typer.Exit(it.list_topics(robot, connect or (), seconds, as_json=as_json))


@topic.command()
def info(
    key: Key,
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 2.0,
    as_json: AsJson = False,
) -> None:
    """What a key carries: fields and units, rate, quality of service, who publishes it and who listens.

    Exit code: 0; 2 nobody publishes it.
    """
    from giraff_cli.topic import listing as it  # noqa: PLC0415

    raise typer.Exit(it.info(key, robot, connect or (), seconds, as_json=as_json))


@topic.command()
def echo(
    key: Key,
    robot: Robot = None,
    connect: Connect = None,
    count: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="End after so many samples.", show_default=False)
    ] = None,
    seconds: Ending = None,
    field: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Only this, like x or board.latch; once for each.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """The samples of a key as they come; with --json an object a line.

    Exit code: 0; 2 nobody publishes it, or nothing came.
    """
    from giraff_cli.topic.echo import echo as it  # noqa: PLC0415

    raise typer.Exit(it(key, robot, connect or (), count, seconds, field or (), as_json=as_json))


@topic.command()
def hz(
    key: AnyKey = None,
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 5.0,
    as_json: AsJson = False,
) -> None:
    """How often a key is published, and what comes of it: counted by its maker's own numbers and stamps.

    Exit code: 0 all that was sent came, once and in order; 1 not; 2 nobody publishes it, or nothing came.
    """
    from giraff_cli.topic.rates import hz as it  # noqa: PLC0415

    raise typer.Exit(it(key, robot, connect or (), seconds, as_json=as_json))


@topic.command()
def bw(
    key: AnyKey = None,
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 5.0,
    as_json: AsJson = False,
) -> None:
    """How many bytes a second the payloads of a key take.

    Exit code: 0; 2 nobody publishes it, or nothing came.
    """
    from giraff_cli.topic.rates import bw as it  # noqa: PLC0415

    raise typer.Exit(it(key, robot, connect or (), seconds, as_json=as_json))


@topic.command()
def pub(
    key: Key,
    sample: Annotated[str, typer.Argument(metavar="JSON", help="Its fields, like '{\"voltage\": 24.1}'.")],
    robot: Robot = None,
    connect: Connect = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", min=0.01, max=1000.0, help="Again and again; else once.", show_default=False),
    ] = None,
    count: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="End after so many; else with Ctrl-C.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Publish a sample in the name of a robot; never what a robot that is there says itself, or is driven by.

    Exit code: 0 published; 1 ended because the robot came; 2 refused.
    """
    from giraff_cli.topic.publish import pub as it  # noqa: PLC0415

    raise typer.Exit(it(key, sample, robot, connect or (), rate, count, as_json=as_json))


@node.command("list")
def list_nodes(robot: Robot = None, connect: Connect = None, as_json: AsJson = False) -> None:
    """The services of a robot that are on the network, with host, pid and health.

    Exit code: 0 all are well; 1 one is not, or does not answer; 2 there is no robot to tell of.
    """
    from giraff_cli.node.report import list_nodes as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), as_json=as_json))


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
    from giraff_cli.node.report import info as it  # noqa: PLC0415

    raise typer.Exit(it(service, robot, connect or (), as_json=as_json))


def graph(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 2.0,
    dot: Annotated[bool, typer.Option("--dot", help="For Graphviz: giraff graph --dot | dot -Tsvg.")] = False,
    as_json: AsJson = False,
) -> None:
    """Which service hears which, on what key.

    Exit code: 0; 2 there is no robot to tell of.
    """
    from giraff_cli.graph.graph import graph as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), seconds, as_dot=dot, as_json=as_json))


def frames(
    robot: Robot = None,
    connect: Connect = None,
    dot: Annotated[bool, typer.Option("--dot", help="For Graphviz: giraff frames --dot | dot -Tsvg.")] = False,
    as_json: AsJson = False,
) -> None:
    """The tree of the robot's frames, from odom to the sensors, and where each is in its parent.

    Exit code: 0; 1 they are no tree; 2 nobody tells where they are.
    """
    from giraff_cli.frames.tree import frames as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), as_dot=dot, as_json=as_json))


def top(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Ending = None,
    once: Annotated[bool, typer.Option("--once", help="Show it once, and end.")] = False,
    as_json: AsJson = False,
) -> None:
    """A live board of a robot: what its services take of processor and memory, rates, losses and ages of its topics.

    In a terminal a live view, else one line a second; with --json an object a second. Exit code: 0; 2 there is no
    robot to tell of.
    """
    from giraff_cli.top.monitor import top as it  # noqa: PLC0415

    raise typer.Exit(it(robot, connect or (), seconds, once=once, as_json=as_json))
