"""What became of a recording, for people and for programs; and `giraff record --repair`, which makes it whole."""

import sys
from io import StringIO
from pathlib import Path
from typing import Final, Self

import msgspec
from rich.table import Table
from rich.text import Text

from giraff_mcap.raw_sample import Count
from giraff_mcap.unread import Unread
from giraff_mcap.writing import RecordingWriter
from giraff_telemetry.console import CleanConsole
from giraff_tools.network.command import print_error
from giraff_tools.terminal.text import json_page

DONE: Final = 0
INCOMPLETE: Final = 1


class Report(msgspec.Struct, frozen=True, kw_only=True):
    """Of one file."""

    file: str
    bytes: int
    seconds: float
    samples: int
    lost: int
    """Numbers that are missing between the first and the last sample of each maker on each key."""
    overrun: int
    """Of the lost: heard, but the disk was too slow for too long."""
    ended_by: str
    keys: dict[str, Count]
    unread: Unread
    """What was there, and is not in the file."""

    @classmethod
    def of(cls, writer: RecordingWriter, ended_by: str, overrun: int) -> Self:
        totals = writer.totals
        return cls(
            file=str(writer.path),
            bytes=writer.path.stat().st_size,
            seconds=round(writer.seconds, 3),
            samples=sum(count.samples for count in totals.values()),
            lost=sum(count.lost for count in totals.values()),
            overrun=overrun,
            ended_by=ended_by,
            keys=totals,
            unread=writer.unread,
        )


def told(report: Report, *, as_json: bool) -> str:
    """The report as text."""
    if as_json:
        return json_page(report) + "\n"
    table = Table.grid(padding=(0, 2, 0, 0))
    for justify in ("left", "right", "right", "left"):
        table.add_column(justify=justify, no_wrap=True)
    for key, count in report.keys.items():
        rate = f"{count.samples / report.seconds:.1f} Hz" if report.seconds > 0.0 else ""
        table.add_row(Text(key), str(count.samples), rate, f"{count.lost} lost" if count.lost else "")
    text = StringIO()
    console = CleanConsole(file=text, width=120, highlight=False)
    console.print(table)
    for line in report.unread.texts():
        console.print(Text(line), soft_wrap=True)
    slow = f", {report.overrun} of them because the disk was too slow" if report.overrun else ""
    missing = f", {report.unread.samples or 'some'} cannot be read" if report.unread else ""
    console.print(
        Text(
            f"{report.file}: {report.seconds:.1f} s, {report.samples} samples, {report.bytes / 1e6:.2f} MB, "
            f"{report.lost} lost{slow}{missing}; ended by {report.ended_by}"
        ),
        soft_wrap=True,
    )
    return text.getvalue()


def repair(path: Path, output: Path | None, *, as_json: bool) -> int:
    """Make a file that any tool opens of what a crash or damage has left; the exit code, 1 where anything is missing.

    The file itself is left as it is.
    """
    from giraff_mcap.reading import RecordingError  # noqa: PLC0415  what records needs none of these
    from giraff_mcap.repair import repair as repair_into  # noqa: PLC0415
    from giraff_tools.terminal.progress import Progress  # noqa: PLC0415

    into = output or path.with_name(f"{path.stem}-repaired.mcap")
    try:
        with Progress("repairing", shown=not as_json) as progress:
            writer = repair_into(path, into, progress.move)
    except RecordingError as error:
        return print_error(str(error))
    except FileExistsError:
        return print_error(f"{into} is there already: name another with -o; nothing is ever written over")
    except OSError as error:
        return print_error(f"{into}: cannot be written: {error.strerror}")
    sys.stdout.write(told(Report.of(writer, f"the repair of {path}", 0), as_json=as_json))
    return INCOMPLETE if writer.unread else DONE
