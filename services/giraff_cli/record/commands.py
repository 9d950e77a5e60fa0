"""The options of `giraff record`. What it does is imported when it is asked for."""

import re
from pathlib import Path
from typing import Annotated, Final

import typer

from giraff_cli.options import AsJson, Connect, Ending, Robot, Topics, require_extra

_SIZE: Final = re.compile(r"(.+?) ?([kmg]i?|)b?", re.IGNORECASE)
_UNITS: Final = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "ki": 1 << 10, "mi": 1 << 20, "gi": 1 << 30}


def record(  # noqa: PLR0913, PLR0917  one argument an option
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Else ROBOT-DATE-TIME.mcap.")
    ] = None,
    robot: Robot = None,
    connect: Connect = None,
    topics: Topics = None,
    seconds: Ending = None,
    max_size: Annotated[
        str | None, typer.Option(metavar="SIZE", help="End before the file is larger, like 500k, 20MB or 4GiB.")
    ] = None,
    camera: Annotated[
        bool, typer.Option("--camera", help="Ask for what its cameras see, and keep it: a megabyte a second or less.")
    ] = False,
    repair: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Instead: make a whole one of what a crash or damage left.", show_default=False
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Record what a robot says into an MCAP file, which Foxglove and other tools open. See docs/recording.md.

    Waits for a robot that is not there yet. Hears no sample above 64 KiB; no topic of Giraff has one.

    Exit code: 0; 1 the disk took no more, what came before is kept, or samples could not be read; 2 nothing was
    recorded.
    """
    require_extra("record", "mcap", "cli,record")
    if repair is not None:
        from giraff_cli.record.report import repair as mend  # noqa: PLC0415

        raise typer.Exit(mend(repair, output, as_json=as_json))
    from giraff_cli.record.recorder import Limits  # noqa: PLC0415
    from giraff_cli.record.recorder import record as run  # noqa: PLC0415

    limits = Limits(seconds, None if max_size is None else bytes_of(max_size))
    raise typer.Exit(run(robot, connect or (), output, topics or (), limits, camera=camera, as_json=as_json))


def bytes_of(size: str) -> int:
    """Return the bytes of a size like 20M, 4GB or 4GiB. Raises typer.BadParameter."""
    parts = _SIZE.fullmatch(size)
    try:
        number = int(float(parts[1]) * _UNITS[parts[2].lower()]) if parts else -1
    except (ValueError, OverflowError):
        number = -1
    if number < 0:
        raise typer.BadParameter(f"--max-size {size}: it is no size; give one like 500k, 20MB or 4GiB")
    if number < 100_000:
        raise typer.BadParameter(f"--max-size {size}: give 100k at least")
    return number
