"""The boards' C compiled for this machine: as it is, and in the variants that tests ask for."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

from giraff_schemas.boards import BoardType
from giraff_sim import board
from giraff_sim.board import BUILD, ROOT, Board, Implementation
from tests.support.tools import finished

FIRMWARE: Final = ROOT / "firmware"
HERE: Final = Path(__file__).resolve().parent


@cache
def compiled(variant: str = "", *settings: str, target: str = "host") -> Path:
    """Compile the boards with make's `settings`, each variant into a directory of its own, which this returns."""
    build = BUILD / "variants" / variant if variant else BUILD
    # One at a time: tests run in several processes, and these may want the same variant.
    command = ["flock", str(FIRMWARE), "make", "--silent", "-C", str(FIRMWARE), target, f"BUILD={build}", *settings]
    finished(command, check=True)
    return build


def open_board(type_: BoardType, build: Path) -> Board:
    return board.open_board(type_, Implementation.HOST, build)


def near_wraps() -> Path:
    """Every counter starts shortly before it wraps."""
    return compiled("near_wraps", f"START_VALUES={HERE / 'near_wraps.c'}")


def wrap_soon() -> Path:
    """The same, with time to drive before, also for the real boards' processors."""
    build = compiled("wrap_soon", f"START_VALUES={HERE / 'wrap_soon.c'}", "all")
    with contextlib.suppress(FileExistsError):
        (build / "lockstep").symlink_to(BUILD / "lockstep")
    return build


def sanitized() -> Path:
    """With address and undefined-behaviour sanitizers, which end the process at the first finding."""
    return compiled("sanitized", "SANITIZE=1")


def with_fault(name: str, *wrapped: str, target: str = "host-base") -> Path:
    """Link a board with faults/`name`.c between the program and the `wrapped` functions."""
    link = " ".join(f"-Wl,--wrap={function}" for function in wrapped)
    sources = f"HOST_EXTRA={HERE / 'faults' / name}.c", f"HOST_OBJECTS={BUILD}"
    return compiled(name, *sources, f"HOST_LINK={link}", target=target)


def robot_with_fault(name: str, *wrapped: str) -> Path:
    """Return a build of all boards of a robot whose base board alone has the fault."""
    build = with_fault(name, *wrapped)
    for sound in ("joystick.so", "ranger.so"):
        with contextlib.suppress(FileExistsError):
            (build / "host" / sound).symlink_to(BUILD / "host" / sound)
    return build


def compiled_for_avr(source: Path, processor: str) -> Path:
    """A program of its own for a board's processor."""
    image = source.with_suffix(".elf")
    finished(["avr-gcc", f"-mmcu={processor}", "-w", "-o", image, source], check=True)
    return image


def built(directory: Path, start_values: Path, *targets: str) -> None:
    """Boards whose counters start at such values."""
    settings = [f"BUILD={directory}", f"START_VALUES={start_values}"]
    finished(["make", "--silent", "-C", FIRMWARE, *settings, *targets], check=True)


def shared_library(library: Path, *sources: Path, includes: Sequence[Path] = ()) -> Path:
    """Parts of the boards' C for this machine."""
    options = ["-std=gnu11", "-O1", "-fPIC", "-shared", "-DPROTOCOL_HASH=0", *(f"-I{path}" for path in includes)]
    finished(["cc", *options, *sources, "-o", library], check=True)
    return library
