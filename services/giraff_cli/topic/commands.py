"""The verbs of `giraff topic`. What they do is imported when it is asked for."""

from typing import Annotated

import typer

from giraff_cli.options import AsJson, Connect, Ending, Listen, Robot, finite

topic = typer.Typer(no_args_is_help=True, help="What is said on a robot's network: who says it, how often, how much.")

Key = Annotated[
    str,
    typer.Argument(
        metavar="KEY",
        help="Any key that `topic list` shows, like odom or range/*; giraff/ROBOT/odom names the robot, too.",
    ),
]
AnyKey = Annotated[
    str | None,
    typer.Argument(metavar="[KEY]", help="Like odom, range/rear or range/*; else all.", show_default=False),
]


@topic.command("list")
def list_topics(
    robot: Robot = None,
    connect: Connect = None,
    seconds: Listen = 1.0,
    with_absent: Annotated[
        bool, typer.Option("--all", help="Also the keys of the table that nobody publishes.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """The keys that a robot's network has: type, rate by the table and now, who publishes and who listens.

    Exit code: 0; 2 there is no robot to tell of.
    """
    from giraff_cli.topic import listing  # noqa: PLC0415

    raise typer.Exit(listing.list_topics(robot, connect or (), seconds, with_absent=with_absent, as_json=as_json))


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
    from giraff_cli.topic import listing  # noqa: PLC0415

    raise typer.Exit(listing.info(key, robot, connect or (), seconds, as_json=as_json))


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

    Of a key that is not in Giraff's table it shows what the payload holds: MessagePack, JSON, or its first bytes.

    Exit code: 0; 2 nobody publishes it, or nothing came.
    """
    from giraff_cli.topic.echo import echo as run  # noqa: PLC0415

    raise typer.Exit(run(key, robot, connect or (), count, seconds, field or (), as_json=as_json))


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
    from giraff_cli.topic.rates import hz as run  # noqa: PLC0415

    raise typer.Exit(run(key, robot, connect or (), seconds, as_json=as_json))


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
    from giraff_cli.topic.rates import bw as run  # noqa: PLC0415

    raise typer.Exit(run(key, robot, connect or (), seconds, as_json=as_json))


@topic.command()
def pub(
    key: Key,
    sample: Annotated[str, typer.Argument(metavar="JSON", help="Its fields, like '{\"voltage\": 24.1}'.")],
    robot: Robot = None,
    connect: Connect = None,
    rate: Annotated[
        float | None,
        typer.Option(
            metavar="HZ",
            min=0.01,
            max=1000.0,
            callback=finite,
            help="Again and again; else once.",
            show_default=False,
        ),
    ] = None,
    count: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="End after so many; else with Ctrl-C.", show_default=False)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Publish a sample in the name of a robot; never what a robot that is there says itself, or is driven by.

    On a key that is not in Giraff's table any JSON goes out, as MessagePack; as JSON where JSON is heard there.

    Exit code: 0 published; 1 ended because the robot came; 2 refused.
    """
    from giraff_cli.topic.publish import pub as run  # noqa: PLC0415

    raise typer.Exit(run(key, sample, robot, connect or (), rate, count, as_json=as_json))
