"""`giraff encoder disk`: the drawing, and what to do with it."""

from pathlib import Path
from typing import Final

import msgspec
import typer

from giraff_core.encoder_disk import Disk, drawing
from giraff_tools.terminal.output import write_fresh
from giraff_tools.terminal.page import print_json

_COMMAND: Final = "giraff encoder disk"


def print_disk(file: Path | None, pairs: int, outer: float, inner: float, hole: float, *, as_json: bool) -> int:
    """Write the drawing; return the exit code. `as_json`: print the disk as one document."""
    try:
        disk = Disk(pairs=pairs, outer=outer, inner=inner, hole=hole)
    except ValueError as error:
        typer.echo(f"{_COMMAND}: {error}", err=True)
        return 2
    try:
        if file is None:
            typer.echo(drawing(disk), nl=False)
            return 0
        write_fresh(file, drawing(disk))
    except FileExistsError:
        typer.echo(f"{_COMMAND}: {file} is there already: name another file, or delete it first", err=True)
        return 2
    except OSError as error:
        typer.echo(f"{_COMMAND}: {file or 'standard output'} cannot be written: {error.strerror}", err=True)
        return 2
    if as_json:
        at_a, at_b = _sensors(disk)
        print_json(
            {
                "file": str(file),
                **msgspec.structs.asdict(disk),
                "sensor_a": at_a,
                "sensor_b": at_b,
                "states_per_turn": disk.states_per_turn,
                "ticks_per_turn": disk.ticks_per_turn,
            }
        )
        return 0
    typer.echo("\n".join((f"{file}: a disk of {disk.outer:g} mm with {disk.pairs} pairs", *_steps(disk))))
    return 0


def _sensors(disk: Disk) -> tuple[float, ...]:
    """Return the distances of sensors A and B from the centre, mm."""
    return tuple((inside + outside) / 2.0 for inside, outside in disk.rings)


def _steps(disk: Disk) -> tuple[str, ...]:
    a, b = (f"{radius:.1f}" for radius in _sensors(disk))
    return (
        "1. Print it at 100 %, not fitted to the page, and measure the ruler: 100 mm.",
        "2. Glue it onto something flat and stiff, cut along both circles, and fix it on the shaft, centred.",
        f"3. Set both sensors on one radius: A {a} mm and B {b} mm from the centre.",
        f"A turn of the disk is {disk.states_per_turn} states. Where it turns G times in a turn of the wheel, write:",
        f"  two wheels: ticks_per_metre = {disk.ticks_per_turn} x G / (3.1416 x wheel's diameter in m), in [robot]",
        f"  balancing:  counts_per_turn = {disk.states_per_turn} x G, in [base.drive]",
    )
