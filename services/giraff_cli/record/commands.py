"""The words and options of `giraff record`, `play` and `replay`. What they do is imported when it is asked for."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Final

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot, finite

_REFUSED: Final = 2
_UNITS: Final = {"k": 1_000, "M": 1_000_000, "G": 1_000_000_000}

Topics = Annotated[
    list[str] | None,
    typer.Option(metavar="KEY", help="Only these: odom, range/*; once for each.", show_default=False),
]


def add_to(app: typer.Typer) -> None:
    """Make them words of `giraff`."""
    app.command()(record)
    app.command()(play)
    app.command()(replay)


def record(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Else ROBOT-DATE-TIME.mcap.")
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    topics: Topics = None,
    seconds: Ending = None,
    max_size: Annotated[
        str | None, typer.Option(metavar="SIZE", help="End before the file is larger, like 500k, 20M or 2G.")
    ] = None,
    repair: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Instead: make a whole one of what a crash has left.", show_default=False),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Record what a robot says into an MCAP file, which Foxglove and other tools open. See docs/recording.md.

    Waits for a robot that is not there yet. Exit code: 0; 1 the disk took no more, what came before is kept; 2 nothing
    was recorded.
    """
    _require_mcap("record")
    if repair is not None:
        from giraff_cli.record.repair import repair as mend  # noqa: PLC0415

        raise typer.Exit(mend(repair, output, as_json=as_json))
    from giraff_cli.record.recorder import Limits  # noqa: PLC0415
    from giraff_cli.record.recorder import record as it  # noqa: PLC0415

    limits = Limits(seconds, None if max_size is None else bytes_of(max_size))
    raise typer.Exit(it(robot, connect or (), output, topics or (), limits, as_json=as_json))


def play(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="That `giraff record` has written.")],
    robot: Annotated[
        str | None, typer.Option(metavar="NAME", help="Whom it is to be; else replay-NAME.", show_default=False)
    ] = None,
    connect: Connect = None,
    topics: Topics = None,
    rate: Annotated[
        float, typer.Option(metavar="N", min=0.01, max=100.0, callback=finite, help="Times as fast.")
    ] = 1.0,
    loop: Annotated[bool, typer.Option("--loop", help="Again and again, until Ctrl-C.")] = False,
    as_json: AsJson = False,
) -> None:
    """Say again what a recording holds: order, rhythm and bytes as they were, under the name of a replay.

    In the name of a robot that is there it refuses whatever that robot's parts decide by. Exit code: 0; 1 it ended
    early, because the file is damaged or such a robot came; 2 nothing was played.
    """
    _require_mcap("play")
    from giraff_cli.play.player import play as it  # noqa: PLC0415

    raise typer.Exit(it(file, robot, connect or (), topics or (), rate, loop=loop, as_json=as_json))


def replay(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="That `giraff record` has written.")],
    least: Annotated[
        float, typer.Option(metavar="SHARE", min=0.0, max=1.0, callback=finite, help="That must agree, of each key.")
    ] = 0.98,
    as_json: AsJson = False,
) -> None:
    """A recording through the policies of today's odometry and guard: do they say what was said then?

    Exit code: 0 they do, but for the share that timing leaves open; 1 they do not; 2 nothing could be compared.
    """
    _require_mcap("replay")
    from giraff_cli.replay.runner import replay as it  # noqa: PLC0415

    raise typer.Exit(it(file, least, as_json=as_json))


def bytes_of(size: str) -> int:
    """Of a size like 20M. Raises typer.BadParameter."""
    try:
        number = int(float(size.rstrip("kMG")) * _UNITS.get(size[-1:], 1))
    except (ValueError, OverflowError):
        number = 0
    if number < 100_000:
        raise typer.BadParameter(f"--max-size {size}: give 100k at least, like 500k, 20M or 2G")
    return number


def _require_mcap(word: str) -> None:
    if find_spec("mcap") is None:
        typer.echo(f"giraff {word}: the library mcap is missing: pip install 'giraff[cli,record]'", err=True)
        raise typer.Exit(_REFUSED)
